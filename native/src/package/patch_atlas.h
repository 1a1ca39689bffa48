// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace ajar {

/// Width and height of a rectangle of texels.
struct PatchSize {
    uint32_t width = 0, height = 0;
};

/// Where a patch lies: atlas, colour channel (0 to 3) and the corner nearest to texel (0, 0).
struct PatchPlace {
    uint32_t atlas = 0, channel = 0, x = 0, y = 0;
};

struct AtlasPlan {
    std::vector<PatchSize> atlases;
    std::vector<PatchPlace> places; ///< of each patch
};

inline constexpr uint32_t kLargestAtlas = 8192; ///< texels along an edge; what today's hardware takes

/// Packs patches into the four channels of as few atlases as it can (semi-dynamic light maps,
/// section 3.2.6): larger patches first; an atlas starts at the size of the largest patch left and
/// doubles while twice its room is less than what waits. The same patches give the same plan. No
/// patch may be empty or larger than kLargestAtlas along an edge.
AtlasPlan plan_atlases(std::span<const PatchSize> patches);

} // namespace ajar
