// SPDX-License-Identifier: GPL-3.0-or-later
#include "package/package_writer.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/error.h"
#include "package/dds.h"
#include "package/file_io.h"
#include "package/image_io.h"
#include "terms_kit.h"

namespace ajar {
namespace {

namespace fs = std::filesystem;

void write_text(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }

std::string read_text(const fs::path& path) {
    const std::vector<uint8_t> bytes = read_file(path);
    return {bytes.begin(), bytes.end()};
}

/// Bytes of all dispatches that a manifest states.
double terms_bytes(const nlohmann::json& manifest) {
    double bytes = 0.0;
    for (const nlohmann::json& c : manifest["dispatches"]) bytes += c["bytes"].get<double>();
    return bytes;
}

class PackageWriter : public ::testing::Test {
protected:
    void SetUp() override {
        std::string pattern = (fs::temp_directory_path() / "ajar_package_XXXXXX").string();
        ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
        root_ = pattern;
        irradiance_.resize(3 * kTexels);
        std::iota(irradiance_.begin(), irradiance_.end(), 0.5f);
        plane_.assign(kTexels, 0.25f);
        words_.resize(kTexels);
        std::iota(words_.begin(), words_.end(), 0xff000000u);
        sh_.resize(27 * kTexels);
        std::iota(sh_.begin(), sh_.end(), -5.0f);
        content_.name = "level \"one\"";
        content_.extras = R"({"preset": "preview"})";
        content_.pages.push_back({kWidth, kHeight, irradiance_, plane_, plane_, plane_, {}, words_, words_});
        content_.instances.push_back({"Cube", 0, {0.5f, 0.25f}, {0.125f, 0.0f}, "AjarLightmap"});
        content_.lights.push_back({"Sun", "static"});
    }
    void TearDown() override { fs::remove_all(root_); }

    nlohmann::json manifest(const fs::path& package) const {
        return nlohmann::json::parse(read_text(package / "manifest.json"));
    }
    std::vector<std::string> entries(const fs::path& folder) const {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
        std::sort(names.begin(), names.end());
        return names;
    }
    Error failure(const fs::path& target) const {
        try {
            write_package(content_, target);
        } catch (const Error& e) {
            return e;
        }
        ADD_FAILURE() << "no error";
        return Error(AJAR_OK, "");
    }

    static constexpr uint32_t kWidth = 4, kHeight = 3, kTexels = 12;
    fs::path root_;
    std::vector<float> irradiance_, plane_, sh_;
    std::vector<uint32_t> words_;
    PackageContent content_;
};

TEST_F(PackageWriter, WritesEveryFileThatTheManifestNames) {
    content_.pages[0].sh = sh_;
    write_package(content_, root_ / "package");
    const nlohmann::json json = manifest(root_ / "package");
    EXPECT_EQ(json["version"], 1);
    EXPECT_EQ(json["name"], "level \"one\"");
    EXPECT_EQ(json["extras"]["preset"], "preview");
    EXPECT_EQ(json["instances"][0]["uv_scale"][1], 0.25);
    EXPECT_EQ(json["lights"][0]["role"], "static");
    const nlohmann::json& page = json["pages"][0];
    for (const char* key : {"irradiance", "quality", "sh"})
        EXPECT_TRUE(fs::exists(root_ / "package" / page[key].get<std::string>())) << key;
    for (const char* key : {"irradiance", "direction", "direction_png"})
        EXPECT_TRUE(fs::exists(root_ / "package" / page["packed"][key].get<std::string>())) << key;
    EXPECT_EQ(entries(root_), std::vector<std::string>{"package"});
}

TEST_F(PackageWriter, ImagesComeBackBottomRowFirst) {
    write_package(content_, root_ / "package");
    const FloatImage image = decode_exr(read_file(root_ / "package/page_0.irradiance.exr"), "irradiance");
    EXPECT_EQ(image.data, irradiance_);
    const FloatImage quality = decode_exr(read_file(root_ / "package/page_0.quality.exr"), "quality");
    EXPECT_EQ(quality.channels.size(), 3u);
    EXPECT_EQ(decode_dds(read_file(root_ / "package/page_0.direction.dds"), "dds").texels, words_);
    uint32_t width = 0, height = 0;
    EXPECT_EQ(decode_png(read_file(root_ / "package/page_0.direction.png"), "png", width, height), words_);
}

TEST_F(PackageWriter, NoShMeansNoFileAndNull) {
    write_package(content_, root_ / "package");
    EXPECT_TRUE(manifest(root_ / "package")["pages"][0]["sh"].is_null());
    EXPECT_FALSE(fs::exists(root_ / "package/page_0.sh.exr"));
}

TEST_F(PackageWriter, ReplacesAnOlderPackageWhole) {
    content_.pages.push_back(content_.pages[0]);
    write_package(content_, root_ / "package");
    EXPECT_TRUE(fs::exists(root_ / "package/page_1.irradiance.exr"));
    content_.pages.pop_back();
    content_.name = "second";
    write_package(content_, root_ / "package/"); // trailing slash is the same folder
    EXPECT_EQ(manifest(root_ / "package")["name"], "second");
    EXPECT_FALSE(fs::exists(root_ / "package/page_1.irradiance.exr"));
    EXPECT_EQ(entries(root_), std::vector<std::string>{"package"});
}

TEST_F(PackageWriter, ForeignFilesBesideAPackageStay) {
    write_package(content_, root_ / "package");
    write_text(root_ / "package/page_0.irradiance.exr.meta", "guid: 1");
    fs::create_directories(root_ / "package/notes/deep");
    write_text(root_ / "package/notes/deep/a.txt", "hello");
    write_package(content_, root_ / "package");
    EXPECT_EQ(read_text(root_ / "package/page_0.irradiance.exr.meta"), "guid: 1");
    EXPECT_EQ(read_text(root_ / "package/notes/deep/a.txt"), "hello");
}

TEST_F(PackageWriter, FillsAnEmptyFolderAndMakesMissingParents) {
    fs::create_directories(root_ / "empty");
    write_package(content_, root_ / "empty");
    write_package(content_, root_ / "a/b/package");
    EXPECT_TRUE(fs::exists(root_ / "empty/manifest.json"));
    EXPECT_TRUE(fs::exists(root_ / "a/b/package/manifest.json"));
}

TEST_F(PackageWriter, ALinkToAPackageStaysALink) {
    write_package(content_, root_ / "real");
    fs::create_directory_symlink("real", root_ / "link");
    content_.name = "through the link";
    write_package(content_, root_ / "link");
    EXPECT_TRUE(fs::is_symlink(root_ / "link"));
    EXPECT_EQ(manifest(root_ / "real")["name"], "through the link");
}

TEST_F(PackageWriter, RefusesForeignFolders) {
    fs::create_directories(root_ / "homework");
    write_text(root_ / "homework/essay.txt", "mine");
    const Error no_manifest = failure(root_ / "homework");
    EXPECT_EQ(no_manifest.code(), AJAR_ERROR_IO);
    EXPECT_NE(std::string(no_manifest.what()).find("homework"), std::string::npos);
    write_text(root_ / "homework/manifest.json", R"({"name": "a web page"})");
    failure(root_ / "homework");
    EXPECT_EQ(read_text(root_ / "homework/essay.txt"), "mine");
    write_text(root_ / "file", "x");
    failure(root_ / "file");
    EXPECT_EQ(entries(root_), (std::vector<std::string>{"file", "homework"}));
}

TEST_F(PackageWriter, UnwritablePlacesAreNamedWithARemedy) {
    const Error error = failure("/proc/ajar/package");
    EXPECT_EQ(error.code(), AJAR_ERROR_IO);
    EXPECT_NE(std::string(error.what()).find("/proc"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("output folder"), std::string::npos);
    write_text(root_ / "file", "x");
    EXPECT_EQ(failure(root_ / "file/package").code(), AJAR_ERROR_IO);
}

TEST_F(PackageWriter, BadContentIsRefusedBeforeAnythingIsWritten) {
    PackageContent broken = content_;
    broken.extras = "[1]";
    EXPECT_THROW(write_package(broken, root_ / "package"), Error);
    broken = content_;
    broken.pages[0].width = 5;
    EXPECT_THROW(write_package(broken, root_ / "package"), Error);
    EXPECT_TRUE(entries(root_).empty());
}

TEST_F(PackageWriter, AFullDiskAtAnyFileLeavesTheOldPackage) {
    content_.name = "old";
    write_package(content_, root_ / "package");
    content_.name = "new";
    ::signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    ::getrlimit(RLIMIT_FSIZE, &before);
    for (rlim_t limit : {0, 100, 200, 300, 500}) { // bytes per file; each stops at another file
        rlimit tight = before;
        tight.rlim_cur = limit;
        ::setrlimit(RLIMIT_FSIZE, &tight);
        std::string message;
        try {
            write_package(content_, root_ / "package");
        } catch (const Error& e) {
            message = e.what();
        }
        ::setrlimit(RLIMIT_FSIZE, &before);
        EXPECT_NE(message.find("Free some disk space"), std::string::npos) << limit << message;
        EXPECT_EQ(manifest(root_ / "package")["name"], "old") << limit;
        EXPECT_EQ(entries(root_), std::vector<std::string>{"package"}) << limit;
    }
}

TEST_F(PackageWriter, LeftoversOfADeadProcessAreRemovedAndThoseOfOthersStay) {
    const pid_t child = ::fork();
    if (child == 0) ::_exit(0);
    ::waitpid(child, nullptr, 0);
    const fs::path dead = root_ / ("package.tmp-" + std::to_string(child) + "-0");
    const fs::path alive = root_ / ("package.tmp-" + std::to_string(::getppid()) + "-0");
    const fs::path other = root_ / "package.tmp-mine";
    for (const fs::path& p : {dead, alive, other}) fs::create_directories(p / "x");
    write_package(content_, root_ / "package");
    EXPECT_FALSE(fs::exists(dead));
    EXPECT_TRUE(fs::exists(alive));
    EXPECT_TRUE(fs::exists(other));
}

TEST_F(PackageWriter, KillingTheWriterAtAnyTimeLeavesAWholePackage) {
    write_package(content_, root_ / "package");
    for (int round = 0; round < 20; ++round) {
        const pid_t child = ::fork();
        if (child == 0) {
            for (;;) {
                try {
                    write_package(content_, root_ / "package");
                } catch (...) {
                    ::_exit(1);
                }
            }
        }
        ::usleep(1500 * unsigned(round + 1));
        ::kill(child, SIGKILL);
        ::waitpid(child, nullptr, 0);
        const nlohmann::json json = manifest(root_ / "package");
        EXPECT_EQ(
            decode_exr(read_file(root_ / "package" / json["pages"][0]["irradiance"].get<std::string>()), "x").data,
            irradiance_);
    }
    write_package(content_, root_ / "package");
    EXPECT_EQ(entries(root_), std::vector<std::string>{"package"});
}

TEST_F(PackageWriter, HashFollowsContentOnly) {
    const std::string hash = content_hash(content_);
    EXPECT_EQ(hash.size(), 23u);
    EXPECT_EQ(content_hash(content_), hash);
    irradiance_[7] += 1.0f;
    EXPECT_NE(content_hash(content_), hash);
    irradiance_[7] -= 1.0f;
    content_.name = "renamed";
    EXPECT_EQ(content_hash(content_), hash);
    content_.instances[0].uv_offset[0] = 0.5f;
    EXPECT_NE(content_hash(content_), hash);
}

TEST_F(PackageWriter, WithoutElementsThereAreNoTerms) {
    write_package(content_, root_ / "package");
    const nlohmann::json json = manifest(root_ / "package");
    EXPECT_FALSE(fs::exists(root_ / "package/terms.bin"));
    EXPECT_EQ(json["elements"], nlohmann::json::array());
    EXPECT_EQ(json["dispatches"], nlohmann::json::array());
    EXPECT_EQ(json["terms"], nlohmann::json::parse(R"([{"elements": [], "name": "base"}])"));
    EXPECT_FALSE(json.contains("terms_file"));
    EXPECT_EQ(json["lights"], nlohmann::json::parse(R"([{"name": "Sun", "role": "static"}])"));
}

TEST_F(PackageWriter, ElementsAndTermsAreListed) {
    kit::TermScene scene;
    scene.add_page(8, 8);
    scene.add_element("lamps", "light_set", 2.0f);
    scene.add_element("door", "door", 0.0f);
    scene.add_term({0}, kit::texel_range(0, 40));
    scene.add_term({0, 1}, kit::texel_range(10, 5), true);
    scene.content.terms[1].relative_error = NAN; // not known
    scene.content.lights = {{"Bulb", "static", "lamps"}, {"Sun", "primary", ""}, {"Tube", "primary", "lamps"}};
    write_package(scene.content, root_ / "package");
    const std::string check = "/usr/bin/python3 '" AJAR_SOURCE_DIR "/tests/support/validate.py' '" AJAR_SOURCE_DIR
                              "/schemas/manifest.schema.json' '" +
                              (root_ / "package/manifest.json").string() + "'";
    EXPECT_EQ(std::system(("env -u LD_PRELOAD " + check).c_str()), 0);
    const nlohmann::json json = manifest(root_ / "package");
    EXPECT_EQ(json["elements"][0]["lights"], (nlohmann::json{"Bulb", "Tube"}));
    EXPECT_EQ(json["elements"][0]["weight"], 2.0);
    EXPECT_EQ(json["elements"][1]["texels"], 5);
    EXPECT_EQ(json["lights"][0]["light_set"], "lamps");
    EXPECT_FALSE(json["lights"][1].contains("light_set"));
    ASSERT_EQ(json["terms"].size(), 3u);
    EXPECT_EQ(json["terms"][1]["layout"], "unsigned-r11g11b10f-rgba8");
    EXPECT_EQ(json["terms"][2]["layout"], "signed-rgb16f-rgba8");
    EXPECT_EQ(json["terms"][2]["elements"], (nlohmann::json{"lamps", "door"}));
    EXPECT_EQ(json["terms"][2]["name"], "lamps * door");
    EXPECT_EQ(json["terms"][2]["texels"], 5);
    EXPECT_TRUE(json["terms"][2]["relative_error"].is_null());
    EXPECT_EQ(json["terms_file"]["bytes"], fs::file_size(root_ / "package" / "terms.bin"));
}

TEST_F(PackageWriter, TermsOfAnOlderPackageDoNotStay) {
    kit::TermScene scene;
    scene.add_page(8, 8);
    scene.add_element("lamps", "light_set");
    write_package(scene.content, root_ / "package");
    EXPECT_TRUE(fs::exists(root_ / "package/terms.bin")); // no term, but an element that a game may ask for
    write_package(content_, root_ / "package");
    EXPECT_FALSE(fs::exists(root_ / "package/terms.bin"));
}

TEST_F(PackageWriter, OverlapPicturesShowTermsAndBytesOfEachTexel) {
    kit::TermScene scene;
    scene.add_page(8, 4);
    for (uint32_t t = 0; t < 64; ++t) {
        const uint32_t set = scene.add_element("set", "light_set");
        scene.add_term({set}, t == 0 ? std::vector<uint32_t>{3, 20} : std::vector<uint32_t>{20});
    }
    scene.content.overlap_pictures = true;
    write_package(scene.content, root_ / "package");
    const nlohmann::json page = manifest(root_ / "package")["pages"][0],
                         terms = manifest(root_ / "package")["terms_file"];
    EXPECT_EQ(terms["overlap"]["max"], 64);
    EXPECT_EQ(terms["overlap"]["histogram"][0]["texels"], 1);
    EXPECT_EQ(terms["overlap"]["histogram"][6]["texels"], 1);
    EXPECT_EQ(terms["bytes_per_texel"]["mean"].get<double>() * 2, terms_bytes(manifest(root_ / "package")));
    const auto picture = [&](const char* what) {
        uint32_t width = 0, height = 0;
        const std::string name = page[what];
        const auto texels = decode_png(read_file(root_ / "package" / name), name, width, height);
        EXPECT_EQ(width, 8u);
        return texels;
    };
    const std::vector<uint32_t> overlap = picture("overlap"), bytes = picture("bytes");
    EXPECT_EQ(overlap[0], 0xff000000u);
    EXPECT_EQ(overlap[3], 0xff590000u);  // dark blue: one
    EXPECT_EQ(overlap[20], 0xff1acc1au); // green: 4^3
    EXPECT_NE(bytes[3], bytes[20]);
    EXPECT_EQ(bytes[4], 0xff000000u);
    scene.content.overlap_pictures = false;
    write_package(scene.content, root_ / "package");
    EXPECT_FALSE(fs::exists(root_ / "package" / "page_0.overlap.png"));
    EXPECT_FALSE(fs::exists(root_ / "package" / "page_0.bytes.png"));
}

TEST_F(PackageWriter, HashFollowsTerms) {
    kit::TermScene scene;
    scene.add_page(8, 8);
    const std::string bare = content_hash(scene.content);
    scene.add_element("lamps", "light_set");
    const std::string element = content_hash(scene.content);
    EXPECT_NE(element, bare);
    scene.add_term({0}, {1, 2});
    const std::string term = content_hash(scene.content);
    EXPECT_NE(term, element);
    scene.content.terms[0].irradiance = scene.content.pages[0].irradiance.first(6);
    EXPECT_NE(content_hash(scene.content), term);
}

TEST_F(PackageWriter, NamesThatAreNotUtf8DoNotBreakTheManifest) {
    content_.instances[0].name = "bad \xff name";
    write_package(content_, root_ / "package");
    EXPECT_TRUE(manifest(root_ / "package")["instances"][0]["name"].is_string());
}

} // namespace
} // namespace ajar
