// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/world.h"

#include "base/hash.h"

namespace ajar {

bool SceneState::is_there(const Presence& p) const {
    if (p.element == kNoElement) return true;
    if (p.element == own.element) return p.state == own.state;
    const bool on = unit_float(hash_combine(draw, p.element)) < weights[p.element];
    return on == p.state;
}

World::World(const Snapshot& s, const Tracer& t)
    : scene(s), tracer(t), behind_(find_solids(s, t)), has_switches_(s.has_switches()) {}

Hit World::meet(const Ray& ray, const SceneState& state, const Passed& passed) const {
    const Hit fixed = passed.empty() ? tracer.intersect(ray, kMaskGather) : tracer.next(ray, kMaskGather, passed);
    if (!has_switches_) return fixed;
    thread_local std::vector<Hit> switches;
    Ray before = ray;
    before.tnear = std::max(ray.tnear, passed.start());
    if (fixed.triangle != kMiss) before.tfar = fixed.t;
    tracer.all_switches(before, kMaskGatherSwitch, switches);
    for (const Hit& h : switches)
        if (!passed.has({h.triangle, h.u, h.v}, scene) && state.is_there(scene.presence(h.triangle))) return h;
    return fixed;
}

Vec3 World::transmittance(const Ray& ray, const SceneState& state) const {
    Vec3 left = tracer.transmittance(ray);
    if (!has_switches_ || !(max_component(left) > 0.0f)) return left;
    thread_local std::vector<Hit> switches;
    tracer.all_switches(ray, kMaskShadowSwitch, switches);
    for (const Hit& h : switches)
        if (state.is_there(scene.presence(h.triangle))) left *= scene.surface(h.triangle, h.u, h.v).transmittance;
    return left;
}

} // namespace ajar
