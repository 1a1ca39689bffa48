// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace ajar {

/// RGBA8 words of a picture of numbers in false colours: black for 0, then dark blue at unit, and a colour on for each
/// factor of 4: blue, cyan, green, yellow, red, white (4096 units and more). In between by the logarithm.
std::vector<uint32_t> overlap_picture(std::span<const uint32_t> values, uint32_t unit);

inline constexpr uint32_t kTermsUnit = 1;
inline constexpr uint32_t kBytesUnit = 16; ///< about what a texel with one term takes

} // namespace ajar
