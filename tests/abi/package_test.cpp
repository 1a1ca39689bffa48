// SPDX-License-Identifier: GPL-3.0-or-later
// Packages through the ABI: valid, whole or not at all, the same bytes for any number of threads.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "room_kit.h"

namespace {

/// Whether file obeys schemas/<name>.schema.json; needs Debian's Python, as ./dev does.
bool validates(const std::string& name, const std::string& file) {
    const std::string root = AJAR_SOURCE_DIR;
    // The sanitizer's preloads are not for Python.
    const std::string command = "env -u LD_PRELOAD /usr/bin/python3 '" + root + "/tests/support/validate.py' '" + root +
                                "/schemas/" + name + ".schema.json' '" + file + "'";
    return std::system(command.c_str()) == 0;
}

void write(const kit::Bake& bake, const std::string& directory, const char* extras = nullptr) {
    kit::check(ajar_job_write_package(bake.handle(), directory.c_str(), extras));
}

std::vector<std::string> expected_files(bool sh) {
    std::vector<std::string> files = {"manifest.json",         "page_0.direction.dds",  "page_0.direction.png",
                                      "page_0.irradiance.dds", "page_0.irradiance.exr", "page_0.quality.exr"};
    if (sh) files.push_back("page_0.sh.exr");
    return files;
}

class PackageAbi : public ::testing::Test {
protected:
    void SetUp() override { kit::fill_room(scene_); }
    kit::Scene scene_{"level one"};
    kit::TempFolder folder_;
};

TEST_F(PackageAbi, ManifestAndReportValidate) {
    ajar_settings s = kit::quick();
    s.keep_sh = 1;
    s.check_points = 16;
    const kit::Bake bake(scene_, s);
    const std::string package = folder_.path("package");
    write(bake, package, R"({"preset": "preview", "deep": {"a": [1, 2]}})");
    EXPECT_TRUE(validates("manifest", package + "/manifest.json"));
    std::ofstream(folder_.path("report.json")) << bake.report();
    EXPECT_TRUE(validates("report", folder_.path("report.json")));
    EXPECT_NE(kit::read_file(package + "/manifest.json").find("level one"), std::string::npos);
    for (const std::string& name : expected_files(true))
        EXPECT_GT(kit::read_file(package + "/" + name).size(), 100u) << name;
}

TEST_F(PackageAbi, TheFileHoldsTheLayer) {
    const kit::Bake bake(scene_, kit::quick());
    write(bake, folder_.path("package"));
    const kit::Layer packed = bake.layer(AJAR_LAYER_AHD);
    const std::string dds = kit::read_file(folder_.path("package/page_0.irradiance.dds"));
    ASSERT_GE(dds.size(), 4u * 48 * 48);
    // The file's last row is the layer's first.
    for (uint32_t x = 0; x < 48; ++x) {
        const float word = packed.at(x, 0, 0);
        EXPECT_EQ(std::memcmp(dds.data() + dds.size() - 4 * (48 - x), &word, 4), 0) << x;
    }
}

TEST_F(PackageAbi, BadArgumentsWriteNothing) {
    const kit::Bake bake(scene_, kit::quick());
    EXPECT_EQ(ajar_job_write_package(bake.handle(), nullptr, nullptr), AJAR_ERROR_ARGUMENT);
    EXPECT_EQ(ajar_job_write_package(bake.handle(), "", nullptr), AJAR_ERROR_ARGUMENT);
    for (const char* extras : {"", "{", "[1]", "7", "{\"a\": }", "\xff"})
        EXPECT_EQ(ajar_job_write_package(bake.handle(), folder_.path("package").c_str(), extras), AJAR_ERROR_ARGUMENT)
            << extras;
    EXPECT_TRUE(folder_.entries().empty());
}

TEST_F(PackageAbi, ThePreviousPackageStaysWhenWritingFails) {
    const kit::Bake bake(scene_, kit::quick());
    const std::string package = folder_.path("package");
    write(bake, package, R"({"take": 1})");
    const std::string manifest = kit::read_file(package + "/manifest.json");
    EXPECT_EQ(ajar_job_write_package(bake.handle(), package.c_str(), "not json"), AJAR_ERROR_ARGUMENT);
    EXPECT_EQ(ajar_job_write_package(bake.handle(), (package + "/page_0.quality.exr/below").c_str(), nullptr),
              AJAR_ERROR_IO);
    EXPECT_NE(std::string(ajar_error_culprit()) + ajar_error_message(), "");
    EXPECT_EQ(kit::read_file(package + "/manifest.json"), manifest);
    EXPECT_EQ(folder_.entries().size(), 1 + expected_files(false).size());
    std::filesystem::create_directory(folder_.path("homework"));
    std::ofstream(folder_.path("homework/essay.txt")) << "mine";
    EXPECT_EQ(ajar_job_write_package(bake.handle(), folder_.path("homework").c_str(), nullptr), AJAR_ERROR_IO);
    EXPECT_EQ(kit::read_file(folder_.path("homework/essay.txt")), "mine");
}

// ---- threads ---------------------------------------------------------------------------------

std::vector<kit::Layer> all_layers(const kit::Bake& bake, uint32_t bounces) {
    std::vector<kit::Layer> out;
    for (uint32_t layer = AJAR_LAYER_IRRADIANCE; layer <= AJAR_LAYER_AHD; ++layer) out.push_back(bake.layer(layer));
    for (uint32_t b = 0; b <= bounces; ++b) out.push_back(bake.layer(AJAR_LAYER_BOUNCE + b));
    return out;
}

bool same_bytes(const kit::Layer& a, const kit::Layer& b) {
    return a.data.size() == b.data.size() &&
           std::memcmp(a.data.data(), b.data.data(), a.data.size() * sizeof(float)) == 0;
}

/// Everything that could depend on the order of work: emissive mesh, sky, glass, seams, pilot.
void fill_rich_scene(kit::Scene& scene) {
    const uint32_t page = scene.page(64, 64), second = scene.page(24, 40);
    const uint32_t grey = scene.diffuse({0.6f, 0.6f, 0.6f});
    ajar_closure glass;
    ajar_closure_init(&glass);
    glass.type = AJAR_CLOSURE_TRANSPARENT;
    glass.color.value[1] = 0.4f;
    kit::MeshData room = kit::box({-2, -2, 0}, {2, 2, 3}, true);
    room.corners.erase(room.corners.begin() + 6, room.corners.begin() + 9); // half of the ceiling is open
    room.uv.erase(room.uv.begin() + 6, room.uv.begin() + 9);
    scene.instance(scene.mesh(room), grey, page, "room");
    scene.instance(scene.mesh(kit::plane(1.5f, 1.0f)), grey, second, "table");
    scene.instance(scene.mesh(kit::plane(1.0f, 2.0f)), scene.material({glass}), AJAR_NONE, "glass");
    scene.instance(scene.mesh(kit::box({1, 1, 0.5f}, {1.2f, 1.2f, 0.7f}, false)), scene.emitter({9, 7, 4}), AJAR_NONE,
                   "lamp");
    scene.point_light({-1, 1, 2.5f}, 30.0f, 0.05f);
    scene.point_light({1, -1, 2.5f}, 30.0f, 0.0f, true);
    scene.sky({0.5f, 0.7f, 1.0f});
    scene.commit();
}

ajar_settings rich_settings(uint32_t threads) {
    ajar_settings s = kit::quick();
    s.noise_target = 0.1f;
    s.samples = 256;
    s.keep_sh = s.keep_bounces = s.stitch_seams = 1;
    s.threads = threads;
    return s;
}

TEST(Threads, LayersAndPackagesAreTheSameBytes) {
    kit::Scene scene;
    fill_rich_scene(scene);
    const kit::TempFolder folder;
    const kit::Bake one(scene, rich_settings(1));
    const std::vector<kit::Layer> reference = all_layers(one, 2);
    write(one, folder.path("1"));
    const kit::TempFolder listing;
    write(one, listing.path("1"));
    const std::vector<std::string> files = listing.entries();
    ASSERT_GT(files.size(), 12u);
    for (uint32_t threads : {2u, 3u}) {
        const kit::Bake bake(scene, rich_settings(threads));
        const std::vector<kit::Layer> layers = all_layers(bake, 2);
        ASSERT_EQ(layers.size(), reference.size());
        for (size_t i = 0; i < layers.size(); ++i)
            EXPECT_TRUE(same_bytes(layers[i], reference[i])) << "layer " << i << ", threads " << threads;
        const std::string number = std::to_string(threads);
        write(bake, folder.path(number));
        for (const std::string& file : files) {
            if (file == "1") continue;
            const std::string name = file.substr(2);
            EXPECT_EQ(kit::read_file(folder.path(number + "/" + name)), kit::read_file(folder.path("1/" + name)))
                << name << ", threads " << threads;
        }
    }
}

TEST(Threads, AnotherSeedGivesOtherBytes) { // or the comparison above would prove nothing
    kit::Scene scene;
    fill_rich_scene(scene);
    ajar_settings s = rich_settings(2);
    const kit::Layer a = kit::Bake(scene, s).layer(AJAR_LAYER_IRRADIANCE);
    s.seed = 1;
    EXPECT_FALSE(same_bytes(kit::Bake(scene, s).layer(AJAR_LAYER_IRRADIANCE), a));
}

} // namespace
