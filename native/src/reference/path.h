// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "reference/surface.h"

namespace ajar {

/// Irradiance at a receiver by one random path: a cosine ray from surface to surface, and at each of
/// them a sample of every kind of source.
///
/// Bounces count as the baker counts them: reflections off the lightmapped side of surfaces are
/// limited, those off other surfaces are free but for the first after the source.
///
/// door_bounces: paths that were reflected more often before they came through a door find all doors closed
/// (the approximation of Seyb et al. 2020, section 4; here to measure what it costs).
class PathTracer {
public:
    PathTracer(const World& world, const Lights& lights, uint32_t bounces, uint32_t door_bounces,
               const std::vector<float>& weights);

    /// first: where in the unit square the first ray goes. Primary lamps do not light the receiver
    /// itself.
    Vec3 irradiance(Vertex receiver, const Vec2& first, const SceneState& state, Pcg& random) const;

private:
    struct Walk;
    bool follow(Walk& walk, const Vec3& direction, float cosine) const;
    SceneState state_of(const Walk& walk) const;
    bool leaves_by_door(const Walk& walk, const Ray& ray, const Hit& end) const;
    bool reflect(Walk& walk, const Hit& hit, const Vec3& reflectance) const;
    void add_emission(Walk& walk, const Ray& ray, const Hit& hit, const Vec3& radiance, float cosine) const;

    const World& world_;
    const Lights& lights_;
    uint32_t bounces_;
    uint32_t door_bounces_;
    std::vector<float> closed_; ///< weights with all doors closed
};

/// Direction of density cosine / pi about n for a point of the unit square, and its cosine.
Vec3 cosine_direction(const Vec3& n, const Vec2& u, float& cosine);

} // namespace ajar
