// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/error.h"
#include "package/dds.h"
#include "package/image_io.h"

namespace ajar {
namespace {

TEST(PackageDds, RoundTripKeepsEveryBit) {
    const std::vector<uint32_t> texels{0x00000000u, 0xffffffffu, 0x01234567u, 0x89abcdefu, 0x80000001u, 0x7fffffffu};
    for (DdsFormat format : {DdsFormat::kR11G11B10Float, DdsFormat::kR8G8B8A8Unorm}) {
        const DdsImage image = decode_dds(encode_dds(3, 2, format, texels), "x.dds");
        EXPECT_EQ(image.width, 3u);
        EXPECT_EQ(image.height, 2u);
        EXPECT_EQ(image.format, format);
        EXPECT_EQ(image.texels, texels);
    }
}

TEST(PackageDds, FileHoldsTopRowFirstAndTheRightHeader) {
    const std::vector<uint32_t> texels{0x11111111u, 0x22222222u}; // bottom, top
    const std::vector<uint8_t> bytes = encode_dds(1, 2, DdsFormat::kR11G11B10Float, texels);
    ASSERT_EQ(bytes.size(), 148u + 8u);
    EXPECT_EQ(std::string(bytes.begin(), bytes.begin() + 4), "DDS ");
    EXPECT_EQ(bytes[4], 124); // header size
    EXPECT_EQ(std::string(bytes.begin() + 84, bytes.begin() + 88), "DX10");
    EXPECT_EQ(bytes[128], 26); // DXGI_FORMAT_R11G11B10_FLOAT
    EXPECT_EQ(bytes[148], 0x22);
    EXPECT_EQ(bytes[152], 0x11);
}

TEST(PackageDds, EveryTruncationIsRefused) {
    const std::vector<uint32_t> texels(4, 7u);
    const std::vector<uint8_t> bytes = encode_dds(2, 2, DdsFormat::kR8G8B8A8Unorm, texels);
    for (size_t size = 0; size < bytes.size(); ++size) {
        const std::vector<uint8_t> cut(bytes.begin(), bytes.begin() + long(size)); // own allocation, for ASan
        EXPECT_THROW(decode_dds(cut, "cut.dds"), Error) << size;
    }
}

TEST(PackageExr, RoundTripKeepsFloatsAndNames) {
    const std::vector<float> data{0.0f, 1.0f, 65504.0f, 1e-30f, 1e30f, -2.5f, 0.1f, 3.0f, 1e6f, 7.0f, 8.0f, 9.0f};
    const FloatImage image = decode_exr(encode_exr(2, 2, {"R", "G", "B"}, data), "x.exr");
    EXPECT_EQ(image.width, 2u);
    EXPECT_EQ(image.height, 2u);
    EXPECT_EQ(image.channels, (std::vector<std::string>{"R", "G", "B"}));
    EXPECT_EQ(image.data, data);
}

TEST(PackageExr, TwentySevenNamedChannelsCanBeFoundByName) {
    std::vector<std::string> names;
    for (int i = 0; i < 9; ++i)
        for (const char* color : {".R", ".G", ".B"}) names.push_back("sh" + std::to_string(i) + color);
    std::vector<float> data(27 * 6);
    for (size_t i = 0; i < data.size(); ++i) data[i] = float(i);
    const FloatImage image = decode_exr(encode_exr(3, 2, names, data), "sh.exr");
    ASSERT_EQ(image.channels.size(), 27u);
    for (size_t c = 0; c < 27; ++c) {
        size_t want = 0;
        while (want < 27 && names[want] != image.channels[c]) ++want;
        ASSERT_LT(want, 27u) << image.channels[c];
        for (size_t t = 0; t < 6; ++t) EXPECT_EQ(image.data[t * 27 + c], data[t * 27 + want]);
    }
}

TEST(PackageExr, BrokenFileIsAnErrorWithItsName) {
    const std::vector<uint8_t> bytes{1, 2, 3, 4};
    try {
        decode_exr(bytes, "broken.exr");
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), AJAR_ERROR_IO);
        EXPECT_EQ(e.culprit(), "broken.exr");
    }
}

TEST(PackagePng, RoundTripKeepsColourUnderZeroAlpha) {
    const std::vector<uint32_t> texels{0x00ff8040u, 0x80ff8040u, 0xff010203u, 0x01ffffffu, 0x00000000u, 0xffffffffu};
    uint32_t width = 0, height = 0;
    EXPECT_EQ(decode_png(encode_png(3, 2, texels), "x.png", width, height), texels);
    EXPECT_EQ(width, 3u);
    EXPECT_EQ(height, 2u);
}

TEST(PackageImages, WrongSizesAreRefused) {
    const std::vector<float> floats(5);
    const std::vector<uint32_t> words(5);
    EXPECT_THROW(encode_exr(2, 2, {"Y"}, floats), Error);
    EXPECT_THROW(encode_png(2, 2, words), Error);
    EXPECT_THROW(encode_dds(2, 2, DdsFormat::kR8G8B8A8Unorm, words), Error);
    EXPECT_THROW(encode_dds(0, 0, DdsFormat::kR8G8B8A8Unorm, {}), Error);
}

} // namespace
} // namespace ajar
