// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "accel/embree_scene.h"
#include "sampling/emitters.h"
#include "transport/surface_table.h"

namespace ajar {

/// Lamps that hang close to surfaces without a lightmap, and places of the bright spots that they make there. Gather
/// rays from afar rarely meet such a spot, and then find it far too bright; a place that is drawn as the lamp sees
/// it, which then sends its light to the receiver, is as likely as it is bright. Both share the light by multiple
/// importance sampling (bidirectional path tracing with one vertex on the lamp's side: Veach 1997, chapter 10).
class LampSpots {
public:
    LampSpots(const Snapshot& scene, const Tracer& tracer, const SurfaceTable& surfaces, const EmitterSet& emitters);

    bool empty() const { return lamps_.empty(); }
    /// A place that is lit by a lamp.
    struct Spot {
        uint32_t emitter = EmitterSet::kNone;
        Hit hit;              ///< as the lamp's ray meets it
        Vec3 position{0.0f};  ///< on the surface
        Vec3 normal{0.0f};    ///< unit, towards the lamp
        float density = 0.0f; ///< per m^2
    };
    /// Draws a place for u in [0,1)^2, of which x goes from lamp to lamp and over each from its axis outwards: false if
    /// there is none. It is the first that a ray from the lamp meets of fixed surfaces which
    /// cast shadows.
    bool sample(Vec2 u, Spot& spot) const;
    /// Density with which sample() draws a place with a unit normal towards the lamp, unless something is between.
    float density(uint32_t emitter, const Vec3& position, const Vec3& normal) const;
    /// Whether nothing is between, for a place off its surface.
    bool reaches(uint32_t emitter, uint32_t triangle, const Vec3& place) const;

private:
    struct Lamp {
        uint32_t emitter;
        const Light* light;
        float chance, running;
        float pdf; ///< of its rays' directions, per steradian
    };
    const Lamp* of(uint32_t emitter) const;
    static Vec3 direction(const Lamp& lamp, const Vec2& u);
    float closeness(const SurfaceTable& surfaces, const Lamp& lamp) const;

    const Snapshot& scene_;
    const Tracer& tracer_;
    std::vector<Lamp> lamps_;
};

} // namespace ajar
