// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "base/progress.h"
#include "reference/surface.h"

namespace ajar {

/// A place on a lightmapped surface.
struct Place {
    uint32_t triangle = 0;
    float u = 0.0f, v = 0.0f;
};

/// A receiver that the reference judges: a place and the texel it lies in.
struct ReferencePoint {
    Place place;
    uint32_t page = 0, x = 0, y = 0;
    std::vector<uint32_t> neighbours; ///< triangles that share the texel, if its mean is wanted
    bool in_lit_solid = false;        ///< all around is the inside of something, yet light is there
};

/// Draws places of lightmaps at random. Those that nobody sees, dark inside solids or close under something, are
/// drawn again; with whole texels also those whose texel a wall parts, for it has no one answer.
class PointChooser {
public:
    /// by_texel: all texels alike, else all surface alike. state: what is there when in doubt. is_lit: whether any
    /// light reaches a place.
    PointChooser(const World& world, bool by_texel, bool whole_texels, const SceneState& state,
                 std::function<bool(const Place&)> is_lit);
    /// Fewer than count where hardly any place is in the open, none where nothing is. Throws Cancelled.
    std::vector<ReferencePoint> choose(uint32_t count, uint64_t seed, const Progress& progress) const;
    /// Another place of the same texel, uniform over what its triangles cover.
    Place place_in_texel(const ReferencePoint& point, Pcg& random) const;
    bool is_buried(const Place& place) const;
    /// Whether half of the light that it could get comes from insides of solids, or backs close by.
    bool is_enclosed(const Place& place) const;
    /// Whether something hangs over a place, lower than an eighth of its texels' edge.
    bool is_covered(const Place& place) const;

private:
    /// What can be seen from a place.
    struct View {
        Frame frame;
        Vec3 origin;
        SceneState state;
        /// The ray in a direction about the surface's normal.
        Ray along(const Vec3& w) const { return {origin, frame.to_world(w)}; }
    };
    View view_from(const Place& place) const;
    bool draw(ReferencePoint& point, Pcg& random) const;
    bool is_parted(const ReferencePoint& point, uint32_t draw) const;
    void find_neighbours(std::vector<ReferencePoint>& points, const std::vector<uint32_t>& numbers) const;

    const World& world_;
    SceneState state_;
    bool whole_texels_;
    std::function<bool(const Place&)> is_lit_;
    std::vector<uint32_t> triangles_;
    std::vector<double> running_; ///< running sums of area
};

} // namespace ajar
