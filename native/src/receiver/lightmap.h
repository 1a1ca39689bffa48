// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "accel/solids.h"
#include "base/parallel.h"
#include "receiver/switch_solids.h"
#include "receiver/uv_raster.h"

namespace ajar {

/// Receivers of a 16x16 block of one page: those on charts, then those of the ring around them, of which those come
/// last that take coarse light of others; each kind in Morton order.
struct Tile {
    uint32_t first = 0, count = 0; ///< count <= kTileReceivers
};
inline constexpr uint32_t kNoReceiver = 0xffffffffu;
/// Texel edges above the surface at which positions of a texel must see each other.
inline constexpr float kSideHeight = 0.25f;
inline constexpr uint32_t kTileEdge = 16, kTileReceivers = kTileEdge * kTileEdge;

/// Columns of the nearly square grid of count cells; count is 1..16.
constexpr uint32_t grid_columns(uint32_t count) {
    uint32_t columns = 1;
    while (columns * columns < count) ++columns;
    while (count % columns != 0) ++columns;
    return columns;
}

/// Every lightmap texel that wants light, structure of arrays. World space.
struct LightmapReceivers {
    uint32_t positions_per_texel = 1;
    std::vector<Tile> tiles;
    std::vector<uint32_t> texel;    ///< index over all pages
    std::vector<uint32_t> triangle; ///< the one that covers most of the texel
    std::vector<Frame> frame;       ///< z shading normal, x along the lightmap's u
    std::vector<Vec3> positions;    ///< [count][positions_per_texel] ray origins, off the surface
    std::vector<Vec3> albedo;       ///< mean reflectance over the texel
    std::vector<float> texel_size;  ///< m
    std::vector<uint8_t> full;      ///< one triangle covers the whole texel
    std::vector<uint8_t> whole;     ///< the chart covers the whole texel
    std::vector<uint8_t> cut;       ///< a wall runs through the texel; its positions lie on one side of it
    std::vector<uint8_t> open;      ///< a flat texel that nothing parts or covers: rays may start all over it
    std::vector<uint8_t>
        shares; ///< texels of its 2x2 block with like normals see each other: coarse light may be shared
    std::vector<uint32_t> of_texel; ///< [page texels] receiver, or kNoReceiver
    std::vector<uint8_t> ring;      ///< outside its chart; only bilinear lookups touch it
    /// [count] receiver that gathers the light to be reflected: itself, or for those of the ring in whose 2x2 block
    /// there are no others one on a chart next to it. Rays read such texels only where a wall cuts one beside them.
    std::vector<uint32_t> coarse_from;
    std::vector<uint32_t> moved_row;  ///< [count] row of moved or kNoReceiver; empty: nothing is moved
    std::vector<MovedPosition> moved; ///< [rows][positions_per_texel]
    std::vector<uint32_t> plane_row;  ///< [count] row of planes or kNoReceiver; empty: no shading normal leans
    std::vector<Vec3> planes;         ///< [rows][positions_per_texel] geometric normals where shading normals lean
    uint64_t clamped_albedo = 0;      ///< receivers whose reflectance reached kMaxReflectance
    uint64_t pushed_positions = 0;

    uint32_t count() const { return static_cast<uint32_t>(texel.size()); }
    bool has_moved(uint32_t receiver) const { return !moved_row.empty() && moved_row[receiver] != kNoReceiver; }
    /// What stands for a position while a switchable solid covers it.
    MovedPosition moved_from(uint32_t receiver, uint32_t position) const {
        if (!has_moved(receiver)) return {};
        return moved[size_t{moved_row[receiver]} * positions_per_texel + position];
    }
    /// Whether the shading normal leans from the geometric normal of some position.
    bool leans(uint32_t receiver) const { return !plane_row.empty() && plane_row[receiver] != kNoReceiver; }
    /// Unit normal of the surface itself under a position of a receiver that leans.
    const Vec3& plane(uint32_t receiver, uint32_t position) const {
        return planes[size_t{plane_row[receiver]} * positions_per_texel + position];
    }
    /// Whether direction w leaves the surface. What comes from below it brings no light, whatever the shading normal
    /// says: there the surface would light itself (the rule of Cycles).
    bool is_above(uint32_t receiver, uint32_t position, const Vec3& w) const {
        return !leans(receiver) || glm::dot(plane(receiver, position), w) > 0.0f;
    }
    /// Where the first position is while all switchable things are there.
    Vec3 shown_origin(uint32_t receiver) const {
        const MovedPosition m = moved_from(receiver, 0);
        return m.exists() ? m.origin : *origins(receiver);
    }
    /// The point at u in [0,1)^2 of the part of an open texel that a position is the middle of.
    Vec3 in_cell(uint32_t receiver, uint32_t position, const Vec2& u) const {
        const Vec3* o = origins(receiver);
        const Vec3 x = o[1] - o[0], y = o[grid_columns(positions_per_texel)] - o[0];
        return o[position] + (u.x - 0.5f) * x + (u.y - 0.5f) * y;
    }
    const Vec3* origins(uint32_t receiver) const { return &positions[size_t{receiver} * positions_per_texel]; }
};

/// The receivers of a 2x2 block of texels.
struct Block {
    std::array<uint32_t, 4> members;
    uint32_t count = 0;

    const uint32_t* begin() const { return members.data(); }
    const uint32_t* end() const { return members.data() + count; }
};

/// Those of the block that r belongs to; all lie in its tile.
Block block_of(const Snapshot& scene, const LightmapReceivers& receivers, uint32_t r);

/// A tile as two, own and ring: whole packets (kLanes) that have receivers on charts, and the rest, all ring.
struct TileParts {
    Tile own, ring;
    Tile coarse;        ///< receivers that gather light to be reflected, the first of the tile
    uint32_t on_charts; ///< receivers of own before the first of the ring

    /// Those whose light and noise speak for the tile.
    Tile typical() const { return {own.first, on_charts > 0 ? on_charts : ring.count}; }
};
TileParts split(const LightmapReceivers& receivers, const Tile& tile);

/// Turns coverage into receivers: positions by clipped area, terminator fix, push-out of solids
/// (algorithms.md 9.1, 9.2, 9.4), of switchable ones while these are there. They do not depend on the seed of the bake:
/// what side of a wall a texel shows stays. behind: of find_solids(). Adds warnings about UVs to warnings.
LightmapReceivers make_receivers(const Snapshot& scene, const Tracer& tracer, const Coverage& coverage,
                                 const std::vector<Behind>& behind, uint32_t positions_per_texel, ThreadPool& pool,
                                 Progress& progress, std::vector<Warning>& warnings);

} // namespace ajar
