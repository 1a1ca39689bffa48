// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The only door to OpenImageIO. Images pass as file bytes in memory, so that writing them to disk,
// with its errors, has one place (file_io). Arrays are bottom row first; files hold the top row first.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace ajar {

struct FloatImage {
    uint32_t width = 0, height = 0;
    std::vector<std::string> channels;
    std::vector<float> data; ///< interleaved, bottom row first
};

/// OpenEXR file, 32 bit float, zip. data holds width * height * channels.size() floats.
/// Channels named R, G, B are scene-linear Rec.709.
std::vector<uint8_t> encode_exr(uint32_t width, uint32_t height, const std::vector<std::string>& channels,
                                std::span<const float> data);
/// All channels of an OpenEXR file as float. Throws Error(AJAR_ERROR_IO) naming `name`.
FloatImage decode_exr(std::span<const uint8_t> bytes, const std::string& name);

/// PNG of RGBA8 words (r in the low byte), stored as they are: no gamma, no premultiplication.
std::vector<uint8_t> encode_png(uint32_t width, uint32_t height, std::span<const uint32_t> texels);
/// Reads what encode_png writes. Throws Error(AJAR_ERROR_IO) naming `name`.
std::vector<uint32_t> decode_png(std::span<const uint8_t> bytes, const std::string& name, uint32_t& width,
                                 uint32_t& height);

} // namespace ajar
