// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "accel/solids.h"

namespace ajar {

inline constexpr uint32_t kAnyBounces = 0xffffffffu;

/// Weights of all elements, and the doors and toggles that one path meets. Between 0 and 1 a door or
/// toggle is there by chance: light is a polynomial without squares in the weights, so the mean over
/// such draws is the light at the weights themselves.
struct SceneState {
    const std::vector<float>& weights; ///< per element
    uint32_t draw = 0;                 ///< number of this path's draw
    Presence own = {};                 ///< of the surface that the receiver lies on: it is there

    bool is_there(const Presence& p) const;
    float light_set(uint32_t set) const { return set == kNoElement ? 1.0f : weights[set]; }
};

/// The snapshot as one state shows it to rays: what they meet and what they pass.
class World {
public:
    World(const Snapshot& scene, const Tracer& tracer);

    /// First surface that is there; kMiss for none.
    Hit meet(const Ray& ray, const SceneState& state) const { return meet(ray, state, {}); }
    /// The same, of those that the ray has not passed.
    Hit meet(const Ray& ray, const SceneState& state, const Passed& passed) const;
    /// What is left of light along a shadow ray.
    Vec3 transmittance(const Ray& ray, const SceneState& state) const;
    /// What light meets there, of the reflectance that its material says.
    SurfaceSample surface(const Hit& hit) const;
    /// A back that sends nothing. Those of solids do: a lamp inside makes a room of any of them.
    bool is_dead(const Hit& hit) const { return hit.back && has_dead_back(hit.triangle); }
    bool has_dead_back(uint32_t triangle) const {
        return scene.materials[scene.triangles[triangle].material].one_sided;
    }
    /// What may be the inside of a solid: the back of a closed mesh, or one that is not shown.
    bool is_inside(const Hit& hit) const { return is_dead(hit) || (hit.back && solid_[hit.triangle] != 0); }

    const Snapshot& scene;
    const Tracer& tracer;

private:
    std::vector<uint8_t> solid_; ///< per triangle: of a closed mesh that lets no light through
    bool has_switches_;
};

} // namespace ajar
