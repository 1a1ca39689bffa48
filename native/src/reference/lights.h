// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "reference/lamp_table.h"
#include "reference/random.h"
#include "reference/world.h"

namespace ajar {

/// Point and normal that light falls on.
struct Vertex {
    Vec3 position{0.0f}; ///< off the surface
    Vec3 normal{0.0f};   ///< of the cosine
    Vec3 side{0.0f};     ///< light from behind this plane does not count
    bool receiver = false;
};

/// Every source of a state, and ways to aim at them: each lamp by its unshadowed strength, emissive
/// triangles by power, an image sky by the brightness of its texels.
class Lights {
public:
    Lights(const World& world, const std::vector<float>& weights);

    /// Irradiance at a vertex by one sample of each kind of source, by multiple importance sampling
    /// with a ray of density cosine / pi where such a ray finds the source too.
    Vec3 direct(const Vertex& at, const SceneState& state, Pcg& random) const;
    /// Share of a cosine ray in light that it found on a triangle or in the sky.
    float ray_share_of_triangle(uint32_t triangle, float cosine, float distance, float facing) const;
    float ray_share_of_sky(const Vec3& direction, float cosine) const;

private:
    struct Sample {
        Vec3 direction{0.0f};
        float distance = 0.0f;
        Vec3 light{0.0f}; ///< radiance over density, W/m^2 facing it; 0: none
        float density = 0.0f;
        bool casts_shadow = true;
    };
    Vec3 arriving(const Vertex& at, const Sample& sample, const SceneState& state) const;
    Sample sample_lamp(const Vertex& at, Pcg& random) const;
    Sample sample_triangle(const Vertex& at, const SceneState& state, Pcg& random) const;
    Sample sample_sky(Pcg& random) const;
    float sky_density(uint32_t x, uint32_t y) const;
    float triangle_density(uint32_t triangle, float distance, float facing) const;

    const World& world_;
    LampTable lamps_, static_lamps_; ///< all, and those that lightmaps hold
    std::vector<uint32_t> triangles_;
    std::vector<double> triangle_running_; ///< running sums of power
    std::vector<float> chance_per_area_;   ///< per triangle of the scene; empty: none shines
    std::vector<double> sky_running_;      ///< per texel of the sky's image; empty: no image
};

} // namespace ajar
