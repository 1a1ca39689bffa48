// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "base/math.h"

namespace ajar {

/// Image in memory, RGBA, first row at v = 0. Sampled values are scene-linear.
struct Texture {
    enum class Extend { repeat, edge, clip };

    std::string name;
    uint32_t width = 0, height = 0;
    Extend extend = Extend::repeat;
    bool nearest = false;
    bool srgb = false;          ///< bytes holds sRGB encoded colour
    std::vector<uint8_t> bytes; ///< 4 * width * height, or empty
    std::vector<float> floats;  ///< 4 * width * height, or empty

    /// Texel at column x, row y, both in range; linear colour, straight alpha.
    Vec4 texel(uint32_t x, uint32_t y) const;
    /// Bilinear (or nearest) value at uv; texel centres lie at (i + 0.5) / size. sRGB bytes are mixed as they
    /// are stored and decoded then, as Cycles does: between dark and bright texels that is darker.
    Vec4 sample(const Vec2& uv) const;
};

} // namespace ajar
