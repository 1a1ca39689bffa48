// SPDX-License-Identifier: GPL-3.0-or-later
// Opening packages: damaged and hostile files, and wrong calls.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "package/file_io.h"
#include "runtime_kit.h"

namespace {

using namespace ajar;

/// All classes and both layouts in as few bytes as they take.
void fill_small(kit::TermScene& scene) {
    scene.add_page(16, 12);
    for (char digit = '0'; digit <= '9'; ++digit) scene.add_element({'e', digit}, digit == '9' ? "door" : "light_set");
    scene.add_term({0}, kit::texel_range(0, 130));
    for (uint32_t e = 1; e < 9; ++e) scene.add_term({e}, kit::texel_range(132 + e, 16), e == 5);
    scene.add_term({0, 9}, kit::texel_range(130, 14), true);
    scene.add_term({9}, kit::texel_range(136, 10));
    for (uint32_t a = 0; a < 3; ++a) // 21 at some of three texels
        for (uint32_t b = a + 1; b < 9; ++b) scene.add_term({a, b}, kit::texel_range(160 + b % 2, 2), a + b == 5);
}

ajar_runtime_result try_open(const std::string& path) {
    ajar_runtime runtime = nullptr;
    const ajar_runtime_result result = ajar_runtime_open(path.c_str(), &runtime);
    if (result != AJAR_RUNTIME_OK) {
        EXPECT_EQ(runtime, nullptr);
        EXPECT_STRNE(ajar_runtime_error_message(), "");
        return result;
    }
    EXPECT_EQ(ajar_runtime_release(&runtime), AJAR_RUNTIME_OK);
    return result;
}

class RuntimeFile : public ::testing::Test {
protected:
    RuntimeFile() {
        fill_small(scene_);
        folder_.emplace(scene_);
    }
    kit::TermScene scene_;
    std::optional<kit::PackageFolder> folder_;
    const std::vector<std::string> files_ = {"terms.bin", "page_0.irradiance.dds", "page_0.direction.dds"};
};

void expect_every_class(const kit::DecodedTerms& terms) {
    bool classes[terms::kClassCount] = {}, words[4] = {};
    for (const terms::Dispatch& d : terms.dispatches) classes[d.kind] = words[d.words] = true;
    for (const bool c : classes) EXPECT_TRUE(c);
    EXPECT_TRUE(words[2] && words[3]);
}

TEST_F(RuntimeFile, TheSmallPackageHoldsEveryClassAndLayout) {
    expect_every_class(kit::decode_terms(folder_->read("terms.bin")));
    EXPECT_EQ(try_open(folder_->path()), AJAR_RUNTIME_OK);
}

TEST_F(RuntimeFile, EveryFlippedByteIsNoticed) {
    for (const std::string& name : files_) {
        std::vector<uint8_t> bytes = folder_->read(name);
        for (size_t i = 0; i < bytes.size(); ++i) {
            bytes[i] ^= static_cast<uint8_t>(1u << (i % 8));
            folder_->write(name, bytes);
            ASSERT_EQ(try_open(folder_->path()), AJAR_RUNTIME_ERROR_DATA) << name << " byte " << i;
            bytes[i] ^= static_cast<uint8_t>(1u << (i % 8));
        }
        folder_->write(name, bytes);
    }
    EXPECT_EQ(try_open(folder_->path()), AJAR_RUNTIME_OK);
}

TEST_F(RuntimeFile, EveryTruncationIsNoticed) {
    for (const std::string& name : files_) {
        const std::vector<uint8_t> bytes = folder_->read(name);
        for (size_t size = 0; size < bytes.size(); ++size) {
            folder_->write(name, {bytes.begin(), bytes.begin() + static_cast<long>(size)});
            ASSERT_EQ(try_open(folder_->path()), AJAR_RUNTIME_ERROR_DATA) << name << " to " << size;
        }
        std::vector<uint8_t> longer = bytes;
        longer.push_back(0);
        folder_->write(name, longer);
        EXPECT_EQ(try_open(folder_->path()), AJAR_RUNTIME_ERROR_DATA) << name;
        folder_->write(name, bytes);
    }
}

void fix_checksum(std::vector<uint8_t>& bytes) {
    const uint64_t sum = terms::terms_checksum(bytes);
    std::memcpy(bytes.data() + offsetof(terms::Header, checksum), &sum, sizeof sum);
}

/// Opens and, if that works, runs everything; what it finds does not matter as long as memory is sane.
bool survives(const std::string& path) {
    ajar_runtime runtime = nullptr;
    if (ajar_runtime_open(path.c_str(), &runtime) != AJAR_RUNTIME_OK) return false;
    uint32_t count = 0;
    ajar_runtime_element_count(runtime, &count);
    for (uint32_t e = 0; e < count; ++e) ajar_runtime_set_weight(runtime, e, 0.5f);
    EXPECT_EQ(ajar_runtime_update(runtime, nullptr), AJAR_RUNTIME_OK);
    EXPECT_EQ(ajar_runtime_release(&runtime), AJAR_RUNTIME_OK);
    return true;
}

TEST_F(RuntimeFile, WrongNumbersBehindARightChecksumDoNoHarm) {
    const std::vector<uint8_t> bytes = folder_->read("terms.bin");
    int opened = 0;
    for (size_t word = 0; word < bytes.size() / 4; ++word)
        for (const uint32_t value : {0u, 1u, 0x7fffffffu, 0xffffffffu, 0x00ff00ffu}) {
            std::vector<uint8_t> broken = bytes;
            std::memcpy(broken.data() + 4 * word, &value, 4);
            fix_checksum(broken);
            folder_->write("terms.bin", broken);
            opened += survives(folder_->path());
        }
    EXPECT_GT(opened, 100); // light is light, whatever the number
}

TEST_F(RuntimeFile, RandomDamageBehindARightChecksumDoesNoHarm) {
    const std::vector<uint8_t> bytes = folder_->read("terms.bin");
    terms::Header header;
    std::memcpy(&header, bytes.data(), sizeof header);
    const size_t data = header.sections[terms::kData].offset;
    for (int round = 0; round < 3000; ++round) {
        std::vector<uint8_t> broken = bytes;
        for (uint32_t n = 1 + scene_.below(3); n > 0; --n) { // mostly in the tables
            const size_t at = scene_.below(static_cast<uint32_t>(scene_.below(4) == 0 ? bytes.size() : data));
            broken[at] =
                static_cast<uint8_t>(scene_.below(4) == 0 ? scene_.below(256) : bytes[at] + scene_.below(5) - 2);
        }
        fix_checksum(broken);
        folder_->write("terms.bin", broken);
        survives(folder_->path());
    }
}

TEST_F(RuntimeFile, ATexelInTwoDispatchesIsRefused) {
    std::vector<uint8_t> bytes = folder_->read("terms.bin");
    const kit::DecodedTerms terms = kit::decode_terms(bytes);
    terms::Header header;
    std::memcpy(&header, bytes.data(), sizeof header);
    uint8_t* const data = bytes.data() + header.sections[terms::kData].offset;
    const terms::Dispatch& d = terms.dispatches.at(0);
    std::memcpy(data + 4 * (d.address + 1), data + 4 * d.address, 4);
    fix_checksum(bytes);
    folder_->write("terms.bin", bytes);
    EXPECT_EQ(try_open(folder_->path()), AJAR_RUNTIME_ERROR_DATA);
}

TEST_F(RuntimeFile, PagesOfAnotherBakeAreRefused) {
    kit::TermScene other(99);
    fill_small(other);
    const kit::PackageFolder folder(other);
    folder_->write("page_0.direction.dds", folder.read("page_0.direction.dds"));
    EXPECT_EQ(try_open(folder_->path()), AJAR_RUNTIME_ERROR_DATA);
    EXPECT_NE(std::string(ajar_runtime_error_message()).find("another bake"), std::string::npos);
}

TEST_F(RuntimeFile, OtherFormatsAreRefusedByName) {
    std::vector<uint8_t> bytes = folder_->read("terms.bin");
    for (const uint8_t version : {terms::kVersion - 1, terms::kVersion + 1}) {
        bytes[offsetof(terms::Header, version)] = version;
        fix_checksum(bytes);
        folder_->write("terms.bin", bytes);
        EXPECT_EQ(try_open(folder_->path()), AJAR_RUNTIME_ERROR_DATA);
        EXPECT_NE(std::string(ajar_runtime_error_message()).find("version"), std::string::npos);
    }
}

TEST_F(RuntimeFile, TheFuzzersSeedHoldsEveryClassToo) {
    const std::filesystem::path seed = AJAR_FUZZ_SEED;
    if (std::getenv("AJAR_WRITE_FUZZ_SEED") != nullptr)
        for (const std::string& name : files_)
            std::filesystem::copy_file(folder_->file(name), seed / name,
                                       std::filesystem::copy_options::overwrite_existing);
    ASSERT_EQ(try_open(seed), AJAR_RUNTIME_OK) << "make it again: AJAR_WRITE_FUZZ_SEED=1 runtime_test";
    expect_every_class(kit::decode_terms(read_file(seed / "terms.bin")));
}

/// Writes a number at word `index` of the first class B dispatch's array that begins at word `first` of the data.
void spoil_block(std::vector<uint8_t>& bytes, uint32_t terms::Dispatch::*first, uint32_t index, uint32_t value) {
    terms::Header header;
    std::memcpy(&header, bytes.data(), sizeof header);
    for (const terms::Dispatch& d : kit::decode_terms(bytes).dispatches) {
        if (d.kind != static_cast<uint32_t>(terms::Class::b)) continue;
        std::memcpy(bytes.data() + header.sections[terms::kData].offset + 4ull * (d.*first + index), &value, 4);
        return fix_checksum(bytes);
    }
    FAIL() << "no dispatch of class B";
}

TEST_F(RuntimeFile, BlocksThatContradictThemselvesAreRefused) {
    const std::vector<uint8_t> bytes = folder_->read("terms.bin");
    const auto refused = [&](uint32_t terms::Dispatch::*array, uint32_t index, uint32_t value) {
        std::vector<uint8_t> broken = bytes;
        spoil_block(broken, array, index, value);
        folder_->write("terms.bin", broken);
        EXPECT_EQ(try_open(folder_->path()), AJAR_RUNTIME_ERROR_DATA) << index << " " << value;
    };
    refused(&terms::Dispatch::starts, 0, 1);          // the first slot is another
    refused(&terms::Dispatch::starts, 1, 1);          // the first entry is another
    refused(&terms::Dispatch::starts, 2, 0x7fffffff); // slots without end
    refused(&terms::Dispatch::starts, 3, 5);          // entries beside the masks
    refused(&terms::Dispatch::index, 0, 1);           // a slot of no receiver
    refused(&terms::Dispatch::index, 0, 0x80000000);  // of one that is not there
    refused(&terms::Dispatch::index, 0, 0x1ffff);     // of a term that is not there
    refused(&terms::Dispatch::index, 1, 0x10000);     // of the term of the slot before
}

TEST_F(RuntimeFile, MissingFilesAreNamed) {
    std::filesystem::remove(folder_->file("page_0.direction.dds"));
    EXPECT_EQ(try_open(folder_->path()), AJAR_RUNTIME_ERROR_IO);
    EXPECT_NE(std::string(ajar_runtime_error_message()).find("page_0.direction.dds"), std::string::npos);
    EXPECT_EQ(try_open("/nowhere/at all"), AJAR_RUNTIME_ERROR_IO);
    EXPECT_NE(std::string(ajar_runtime_error_message()).find("/nowhere/at all"), std::string::npos);
}

TEST_F(RuntimeFile, TheOpenPackageOutlivesItsReplacement) {
    kit::Runtime runtime(folder_->path());
    std::filesystem::remove_all(folder_->path());
    runtime.set_all(1.0f);
    EXPECT_GT(runtime.update().texels, 0u);
}

TEST_F(RuntimeFile, WritesStayInMemory) {
    const std::vector<uint8_t> before = folder_->read("page_0.irradiance.dds");
    kit::Runtime runtime(folder_->path());
    runtime.set_all(1.0f);
    runtime.update();
    EXPECT_EQ(folder_->read("page_0.irradiance.dds"), before);
}

class RuntimeCalls : public RuntimeFile {
protected:
    void refused(ajar_runtime_result expected, ajar_runtime_result result, const char* word = "") const {
        EXPECT_EQ(result, expected);
        EXPECT_NE(std::string(ajar_runtime_error_message()).find(word), std::string::npos)
            << ajar_runtime_error_message();
    }
};

TEST_F(RuntimeCalls, WeightsOutOfRangeChangeNothing) {
    kit::Runtime runtime(folder_->path());
    const float inf = INFINITY;
    for (const float bad : {NAN, inf, -inf, -0.001f}) {
        for (const uint32_t e : {0u, 9u})
            refused(AJAR_RUNTIME_ERROR_ARGUMENT, ajar_runtime_set_weight(runtime.handle(), e, bad), "e");
        const float color[3] = {1.0f, bad, 1.0f};
        refused(AJAR_RUNTIME_ERROR_ARGUMENT, ajar_runtime_set_color(runtime.handle(), 0, color), "colour");
    }
    refused(AJAR_RUNTIME_ERROR_ARGUMENT, ajar_runtime_set_weight(runtime.handle(), 9, 1.001f), "e9");
    EXPECT_EQ(ajar_runtime_set_weight(runtime.handle(), 0, 1.001f), AJAR_RUNTIME_OK);
    const float red[3] = {1, 0, 0};
    refused(AJAR_RUNTIME_ERROR_ARGUMENT, ajar_runtime_set_color(runtime.handle(), 9, red), "no light set");
    refused(AJAR_RUNTIME_ERROR_ARGUMENT, ajar_runtime_set_weight(runtime.handle(), 10, 1.0f), "element 10");
    EXPECT_EQ(runtime.element(9).weight, 1.0f);
    EXPECT_EQ(runtime.element(0).color[1], 1.0f);
}

TEST_F(RuntimeCalls, ElementsAreFoundByName) {
    kit::Runtime runtime(folder_->path());
    uint32_t index = 77;
    EXPECT_EQ(ajar_runtime_find_element(runtime.handle(), "e9", &index), AJAR_RUNTIME_OK);
    EXPECT_EQ(index, 9u);
    refused(AJAR_RUNTIME_ERROR_NOT_FOUND, ajar_runtime_find_element(runtime.handle(), "e10", &index), "e10");
    EXPECT_EQ(index, 9u);
}

TEST_F(RuntimeCalls, NullPointersAreRefused) {
    kit::Runtime runtime(folder_->path());
    ajar_runtime h = runtime.handle(), none = nullptr;
    uint32_t number = 0;
    float floats[4] = {};
    const uint32_t* words = nullptr;
    const auto bad = AJAR_RUNTIME_ERROR_ARGUMENT;
    refused(bad, ajar_runtime_open(nullptr, &none));
    refused(bad, ajar_runtime_open("x", nullptr));
    refused(bad, ajar_runtime_release(nullptr));
    refused(bad, ajar_runtime_element_count(h, nullptr));
    refused(bad, ajar_runtime_get_element(h, 0, nullptr));
    refused(bad, ajar_runtime_find_element(h, nullptr, &number));
    refused(bad, ajar_runtime_find_element(h, "e0", nullptr));
    refused(bad, ajar_runtime_set_color(h, 0, nullptr));
    refused(bad, ajar_runtime_page_count(h, nullptr));
    refused(bad, ajar_runtime_page_size(h, 0, nullptr, &number));
    refused(bad, ajar_runtime_page_size(h, 0, &number, nullptr));
    refused(bad, ajar_runtime_page_size(h, 1, &number, &number), "page 1");
    refused(bad, ajar_runtime_page_dirty(h, 0, nullptr));
    refused(bad, ajar_runtime_page_texels(h, 0, nullptr, &words));
    refused(bad, ajar_runtime_page_texels(h, 0, &words, nullptr));
    refused(bad, ajar_runtime_page_scale(h, 0, nullptr));
    refused(bad, ajar_runtime_page_scale(h, 9, floats), "page 9");
    refused(bad, ajar_runtime_read_irradiance(h, 0, 3, nullptr, 3 * 16 * 12));
    refused(bad, ajar_runtime_read_irradiance(h, 0, 2, floats, 4), "channels");
    refused(AJAR_RUNTIME_ERROR_BUFFER, ajar_runtime_read_irradiance(h, 0, 3, floats, 4), "floats");
    refused(bad, ajar_runtime_get_buffers(h, nullptr));
    refused(bad, ajar_runtime_plan_update(h, nullptr));
    ajar_runtime_element_init(nullptr);
    ajar_runtime_stats_init(nullptr);
    ajar_runtime_buffers_init(nullptr);
    ajar_runtime_work_init(nullptr);
}

TEST_F(RuntimeCalls, HandlesAreChecked) {
    ajar_runtime stale = nullptr;
    ASSERT_EQ(ajar_runtime_open(folder_->path().c_str(), &stale), AJAR_RUNTIME_OK);
    ajar_runtime copy = stale;
    ASSERT_EQ(ajar_runtime_release(&copy), AJAR_RUNTIME_OK);
    EXPECT_EQ(copy, nullptr);
    int local = 0;
    for (ajar_runtime bad : {ajar_runtime(nullptr), stale, reinterpret_cast<ajar_runtime>(&local)}) {
        uint32_t count = 0;
        refused(AJAR_RUNTIME_ERROR_HANDLE, ajar_runtime_update(bad, nullptr));
        refused(AJAR_RUNTIME_ERROR_HANDLE, ajar_runtime_element_count(bad, &count));
        refused(AJAR_RUNTIME_ERROR_HANDLE, ajar_runtime_set_weight(bad, 0, 1.0f));
        ajar_runtime again = bad;
        refused(AJAR_RUNTIME_ERROR_HANDLE, ajar_runtime_release(&again));
    }
}

TEST_F(RuntimeCalls, StructSizesAreChecked) {
    kit::Runtime runtime(folder_->path());
    ajar_runtime_element element{};
    ajar_runtime_stats stats{};
    ajar_runtime_buffers buffers{};
    ajar_runtime_work work{};
    for (const uint32_t size : {0u, 4u, 1000u}) {
        element.struct_size = stats.struct_size = buffers.struct_size = work.struct_size = size;
        refused(AJAR_RUNTIME_ERROR_STRUCT_SIZE, ajar_runtime_get_element(runtime.handle(), 0, &element), "init");
        refused(AJAR_RUNTIME_ERROR_STRUCT_SIZE, ajar_runtime_update(runtime.handle(), &stats), "init");
        refused(AJAR_RUNTIME_ERROR_STRUCT_SIZE, ajar_runtime_get_buffers(runtime.handle(), &buffers), "init");
        refused(AJAR_RUNTIME_ERROR_STRUCT_SIZE, ajar_runtime_plan_update(runtime.handle(), &work), "init");
    }
    EXPECT_GT(runtime.update().texels, 0u); // the refused calls did not count the changes as done
}

TEST_F(RuntimeCalls, ResultsHaveTexts) {
    for (int code = 0; code >= -10; --code)
        if (code != -9) {
            EXPECT_STRNE(ajar_runtime_result_text(code), "unknown result") << code;
        }
    EXPECT_STREQ(ajar_runtime_result_text(-99), "unknown result");
}

} // namespace
