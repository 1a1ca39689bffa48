// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "accel/embree_scene.h"
#include "receiver/lightmap.h"
#include "sampling/aim_box.h"

namespace ajar {

/// Boxes that the receivers of one tile aim extra gather rays at, because few rays of the hemisphere
/// would meet them (Seyb et al. 2020, section 4.1). For one thread: it remembers what it works out.
class TileAims {
public:
    TileAims(const LightmapReceivers& receivers, const Tile& tile) : receivers_(receivers), tile_(tile) {}

    /// What comes back along a ray that left through a box.
    struct Arrival {
        float light = 0.0f; ///< luminance of all terms
        float worth = 0.0f; ///< radiance over the irradiance that matters, of each term
    };
    using Look = std::function<Arrival(const Ray&, const Hit&)>;
    /// Adds a box if rays of the hemisphere rarely meet it and probing rays through it find light that
    /// brings the tile an irradiance that matters, and at least some. rays: to aim at it, per receiver.
    /// least: irradiance, as luminance. Returns the rays traced to find out.
    uint64_t add(const Tracer& tracer, const AimBox& box, const Look& look, uint32_t rays, float least, uint32_t seed);

    /// Adds a box in any case.
    void add(const AimBox& box, uint32_t rays);

    bool empty() const { return aims_.empty(); }
    uint32_t count() const { return static_cast<uint32_t>(aims_.size()); }
    uint32_t rays(uint32_t aim) const { return aims_[aim].rays; }
    const AimBox& box(uint32_t aim) const { return aims_[aim].box; }
    /// Expected number of aimed rays per steradian around direction w from a position of a receiver.
    float density(uint32_t local, uint32_t position, const Vec3& w) const;
    /// Direction from there into a box for u in [0,1)^2; false if the box has no side towards it.
    bool sample(uint32_t aim, uint32_t local, uint32_t position, const Vec2& u, Vec3& w) const;

private:
    struct Aim {
        AimBox box;
        uint32_t rays;
        mutable std::vector<uint32_t> number; ///< [receivers of the tile][positions] in views, or kNotYet
        mutable std::vector<AimBox::View> views;
    };
    static constexpr uint32_t kNotYet = 0xffffffffu;
    const AimBox::View& view(const Aim& aim, uint32_t local, uint32_t position) const;
    const Vec3& origin(uint32_t local, uint32_t position) const {
        return receivers_.origins(tile_.first + local)[position];
    }
    /// What the probing rays found of a box.
    struct Found {
        bool rarely_met = false; ///< by rays of the hemisphere, from some of where it is seen
        float light = 0.0f;      ///< irradiance through it, luminance, mean over the tile
        float worth = 0.0f;      ///< the same over what matters
        uint64_t rays = 0;
    };
    Found probe(const Tracer& tracer, const AimBox& box, const Look& look, uint32_t seed) const;

    const LightmapReceivers& receivers_;
    Tile tile_;
    std::vector<Aim> aims_;
};

} // namespace ajar
