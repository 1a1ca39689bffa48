// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "accel/solids.h"
#include "base/parallel.h"

namespace ajar {

/// What a gather ray needs to know of the triangle it met: half a cache line each.
class SurfaceTable {
public:
    struct Entry {
        Vec2 uv, du, dv;      ///< lightmap position in texels of corner 0 and the two edges
        uint32_t first_texel; ///< of the page
        uint16_t width, height;
    };
    enum Flag : uint8_t {
        kPlain = 0,
        kEmits = 1,
        kTransmits = 2,
        kUnmapped = 4, ///< no lightmap: its light is estimated at the hit
        kOneSided = 8,
        kMirrored = 16, ///< the normal is minus the cross product
        kSolid = 32     ///< of a solid (find_solids): its backs are black
    };
    /// behind: of find_solids().
    SurfaceTable(const Snapshot& scene, const std::vector<Behind>& behind);

    uint8_t flags(uint32_t triangle) const { return flags_[triangle]; }
    const Entry& entry(uint32_t triangle) const { return entries_[triangle]; }
    /// Page texel under a hit. The nearest texel, not a bilinear mix: the texel stores the mean
    /// over its square, so this keeps the energy exactly and touches one cache line.
    uint32_t texel(uint32_t triangle, float u, float v) const {
        const Entry& e = entries_[triangle];
        const Vec2 p = e.uv + e.du * u + e.dv * v;
        const auto x = std::min(static_cast<uint32_t>(std::max(p.x, 0.0f)), uint32_t{e.width} - 1u);
        const auto y = std::min(static_cast<uint32_t>(std::max(p.y, 0.0f)), uint32_t{e.height} - 1u);
        return e.first_texel + y * e.width + x;
    }
    bool back(uint32_t triangle, const Vec3& direction, const Vec3& cross) const {
        return (glm::dot(direction, cross) > 0.0f) != ((flags_[triangle] & kMirrored) != 0);
    }

private:
    std::vector<Entry> entries_;
    std::vector<uint8_t> flags_;
};

} // namespace ajar
