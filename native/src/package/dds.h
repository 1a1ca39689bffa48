// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace ajar {

/// The 32 bit formats of packed lightmap pages, and the 64 bit one of light patches; values are DXGI_FORMAT's.
enum class DdsFormat : uint32_t { kR16G16B16A16Float = 10, kR11G11B10Float = 26, kR8G8B8A8Unorm = 28 };

/// 32 bit words of a texel.
constexpr uint32_t words_per_texel(DdsFormat format) { return format == DdsFormat::kR16G16B16A16Float ? 2 : 1; }

/// A single 2D image without mip maps.
struct DdsImage {
    uint32_t width = 0, height = 0;
    DdsFormat format = DdsFormat::kR8G8B8A8Unorm;
    std::vector<uint32_t> texels; ///< bottom row first, as everywhere in the engine
};

/// File bytes with a DX10 header. Texels come bottom row first; the file holds the top row first.
/// scale: what 1 in the texels stands for; kept in words that DDS reserves, unless it is 1.
std::vector<uint8_t> encode_dds(uint32_t width, uint32_t height, DdsFormat format, std::span<const uint32_t> texels,
                                float scale = 1.0f);

/// Reads what encode_dds writes. Throws Error(AJAR_ERROR_IO) naming `name` for anything else.
DdsImage decode_dds(std::span<const uint8_t> bytes, const std::string& name);

} // namespace ajar
