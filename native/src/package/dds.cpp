// SPDX-License-Identifier: GPL-3.0-or-later
// Layout: Microsoft, "Programming Guide for DDS" (DDS_HEADER and DDS_HEADER_DXT10).
#include "package/dds.h"

#include <algorithm>
#include <bit>
#include <cstddef>

#include "base/error.h"

namespace ajar {
namespace {

constexpr uint32_t kMagic = 0x20534444u;      // "DDS "
constexpr uint32_t kFourCcDx10 = 0x30315844u; // "DX10"
constexpr uint32_t kScaleTag = 0x52414a41u;   // "AJAR": a float that texels are multiplied by follows
constexpr uint32_t kHeaderFlags = 0x100fu;    // caps, height, width, pitch, pixel format
constexpr uint32_t kPixelFlagFourCc = 0x4u;
constexpr uint32_t kCapsTexture = 0x1000u;
constexpr uint32_t kDimension2d = 3u;
constexpr uint32_t kLargestEdge = 65536u;

/// Magic, DDS_HEADER (31 words) and DDS_HEADER_DXT10 (5 words), all little endian.
enum Word {
    kWordMagic = 0,
    kWordSize = 1,
    kWordFlags = 2,
    kWordHeight = 3,
    kWordWidth = 4,
    kWordPitch = 5,
    kWordDepth = 6,
    kWordMips = 7,
    kWordTag = 8, ///< first of 11 reserved words
    kWordScale = 9,
    kWordPixelSize = 19,
    kWordPixelFlags = 20,
    kWordFourCc = 21,
    kWordCaps = 27,
    kWordFormat = 32,
    kWordDimension = 33,
    kWordArraySize = 35,
    kWordCount = 37
};

void put_word(std::vector<uint8_t>& bytes, size_t word, uint32_t value) {
    for (size_t i = 0; i < 4; ++i) bytes[4 * word + i] = static_cast<uint8_t>(value >> (8 * i));
}

uint32_t get_word(std::span<const uint8_t> bytes, size_t word) {
    uint32_t value = 0;
    for (size_t i = 0; i < 4; ++i) value |= uint32_t(bytes[4 * word + i]) << (8 * i);
    return value;
}

} // namespace

std::vector<uint8_t> encode_dds(uint32_t width, uint32_t height, DdsFormat format, std::span<const uint32_t> texels,
                                float scale) {
    const size_t row = size_t(width) * words_per_texel(format);
    if (width == 0 || height == 0 || texels.size() != row * height)
        throw Error(AJAR_ERROR_ARGUMENT, "DDS image size and texel count differ");
    std::vector<uint8_t> bytes((kWordCount + texels.size()) * 4, 0);
    put_word(bytes, kWordMagic, kMagic);
    put_word(bytes, kWordSize, 124);
    put_word(bytes, kWordFlags, kHeaderFlags);
    put_word(bytes, kWordHeight, height);
    put_word(bytes, kWordWidth, width);
    put_word(bytes, kWordPitch, static_cast<uint32_t>(row) * 4);
    put_word(bytes, kWordDepth, 1);
    put_word(bytes, kWordMips, 1);
    if (scale != 1.0f)
        put_word(bytes, kWordTag, kScaleTag), put_word(bytes, kWordScale, std::bit_cast<uint32_t>(scale));
    put_word(bytes, kWordPixelSize, 32);
    put_word(bytes, kWordPixelFlags, kPixelFlagFourCc);
    put_word(bytes, kWordFourCc, kFourCcDx10);
    put_word(bytes, kWordCaps, kCapsTexture);
    put_word(bytes, kWordFormat, static_cast<uint32_t>(format));
    put_word(bytes, kWordDimension, kDimension2d);
    put_word(bytes, kWordArraySize, 1);
    for (size_t y = 0; y < height; ++y)
        for (size_t x = 0; x < row; ++x) put_word(bytes, kWordCount + (height - 1 - y) * row + x, texels[y * row + x]);
    return bytes;
}

DdsImage decode_dds(std::span<const uint8_t> bytes, const std::string& name) {
    const auto refuse = [&](const char* why) {
        throw Error(AJAR_ERROR_IO, "\"" + name + "\" is not a DDS image of Ajar: " + why, name);
    };
    if (bytes.size() < kWordCount * 4) refuse("it is too short");
    if (get_word(bytes, kWordMagic) != kMagic || get_word(bytes, kWordSize) != 124) refuse("wrong header");
    if (get_word(bytes, kWordFourCc) != kFourCcDx10) refuse("no DX10 header");
    DdsImage image;
    image.width = get_word(bytes, kWordWidth);
    image.height = get_word(bytes, kWordHeight);
    image.format = static_cast<DdsFormat>(get_word(bytes, kWordFormat));
    if (image.format != DdsFormat::kR16G16B16A16Float && image.format != DdsFormat::kR11G11B10Float &&
        image.format != DdsFormat::kR8G8B8A8Unorm)
        refuse("other format");
    if (image.width == 0 || image.height == 0 || std::max(image.width, image.height) > kLargestEdge) refuse("bad size");
    const size_t row = size_t(image.width) * words_per_texel(image.format), count = row * image.height;
    if (bytes.size() != (kWordCount + count) * 4) refuse("its length does not match its size");
    image.texels.resize(count);
    for (size_t y = 0; y < image.height; ++y)
        for (size_t x = 0; x < row; ++x)
            image.texels[y * row + x] = get_word(bytes, kWordCount + (image.height - 1 - y) * row + x);
    return image;
}

} // namespace ajar
