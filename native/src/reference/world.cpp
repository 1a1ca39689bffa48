// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/world.h"

#include "base/hash.h"
#include "scene/mesh_patch.h"
#include "scene/uncut_surface.h"

namespace ajar {

bool SceneState::is_there(const Presence& p) const {
    if (p.element == kNoElement) return true;
    if (p.element == own.element) return p.state == own.state;
    const bool on = unit_float(hash_combine(draw, p.element)) < weights[p.element];
    return on == p.state;
}

World::World(const Snapshot& s, const Tracer& t)
    : scene(s), tracer(t), solid_(s.triangles.size()), has_switches_(s.has_switches()) {
    std::vector<uint8_t> closed;
    for (const Mesh& m : s.meshes) closed.push_back(find_patches(m).closed);
    for (size_t i = 0; i < s.triangles.size(); ++i) {
        const Material& material = s.materials[s.triangles[i].material];
        solid_[i] = closed[s.instances[s.triangles[i].instance].mesh] != 0 && !material.transmits;
    }
}

// Paths end by chance anyway: there is no need to cut reflectance where the baker does.
SurfaceSample World::surface(const Hit& hit) const {
    SurfaceSample s = sample_uncut(scene.materials[scene.triangles[hit.triangle].material], scene,
                                   scene.mesh_point(hit.triangle, hit.u, hit.v));
    const Presence p = scene.presence(hit.triangle);
    if (!p.state && !scene.elements[p.element].bounces) s.reflectance = Vec3(0.0f); // a leaf that sends nothing back
    return s;
}

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
