// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/path.h"

namespace ajar {

namespace {

constexpr uint32_t kSureBounces = 2;  ///< reflections before paths end by chance
constexpr float kMostSurvive = 0.98f; ///< chance of going on, or paths between white surfaces would never end

} // namespace

/// A path in hand.
struct PathTracer::Walk {
    Vertex at;
    const SceneState& state;
    Pcg& random;
    Vec3 through{1.0f}; ///< what the receiver gets of the irradiance at the vertex
    Vec3 sum{0.0f};
    uint32_t mapped = 0; ///< reflections off lightmaps so far
    uint32_t length = 0; ///< all reflections
    bool behind_door = false;
};

PathTracer::PathTracer(const World& world, const Lights& lights, uint32_t bounces, uint32_t door_bounces,
                       const std::vector<float>& weights)
    : world_(world), lights_(lights), bounces_(bounces), door_bounces_(door_bounces), closed_(weights) {
    for (size_t e = 0; e < closed_.size(); ++e)
        if (world.scene.elements[e].kind == ElementKind::door) closed_[e] = 0.0f;
}

/// What the path meets next.
SceneState PathTracer::state_of(const Walk& walk) const {
    if (walk.length <= door_bounces_ || walk.behind_door) return walk.state;
    return {closed_, walk.state.draw, walk.state.own};
}

/// Whether the way to a hit, or to the sky, leads where the leaf of a door is when it is closed.
bool PathTracer::leaves_by_door(const Walk& walk, const Ray& ray, const Hit& end) const {
    Ray way = ray;
    if (end.triangle != kMiss) way.tfar = end.t * (1.0f - 1e-4f);
    std::vector<Hit> switches;
    world_.tracer.all_switches(way, kMaskGatherSwitch, switches);
    const SceneState closed{closed_, walk.state.draw, walk.state.own};
    return std::any_of(switches.begin(), switches.end(), [&](const Hit& h) {
        const Presence p = world_.scene.presence(h.triangle);
        return closed.is_there(p) && !walk.state.is_there(p);
    });
}

Vec3 cosine_direction(const Vec3& n, const Vec2& u, float& cosine) {
    const float r = std::sqrt(u.x), angle = 2.0f * kPi * u.y;
    cosine = std::sqrt(std::max(0.0f, 1.0f - u.x));
    return frame_from_normal(n).to_world({r * std::cos(angle), r * std::sin(angle), cosine});
}

Vec3 PathTracer::irradiance(Vertex receiver, const Vec2& first, const SceneState& state, Pcg& random) const {
    receiver.receiver = true;
    Walk walk{receiver, state, random};
    Vec2 u = first;
    while (true) {
        walk.sum += walk.through * lights_.direct(walk.at, state_of(walk), random);
        float cosine;
        const Vec3 w = cosine_direction(walk.at.normal, u, cosine);
        if (!(glm::dot(w, walk.at.side) > 0.0f) || !follow(walk, w, cosine)) return walk.sum;
        u.x = random.uniform();
        u.y = random.uniform();
    }
}

/// Goes along a ray to the next surface that reflects; false if the path ends.
bool PathTracer::follow(Walk& walk, const Vec3& direction, float cosine) const {
    const Sky& sky = world_.scene.sky;
    const SceneState state = state_of(walk);
    const Ray ray{walk.at.position, direction};
    Passed passed;
    while (true) {
        const Hit hit = world_.meet(ray, state, passed);
        if (door_bounces_ != kAnyBounces && walk.length <= door_bounces_)
            walk.behind_door = walk.behind_door || leaves_by_door(walk, ray, hit);
        if (hit.triangle == kMiss) {
            if (sky.lit())
                walk.sum +=
                    walk.through * sky.radiance(direction) * (kPi * lights_.ray_share_of_sky(direction, cosine));
            return false;
        }
        if (world_.is_dead(hit)) return false;
        const SurfaceSample s = world_.surface(hit);
        if (max_component(s.emission) > 0.0f) add_emission(walk, ray, hit, s.emission, cosine);
        const float back = luminance(s.reflectance), on = luminance(s.transmittance);
        if (!(back + on > 0.0f)) return false;
        const float goes_on = on / (back + on);
        if (walk.random.uniform() >= goes_on) {
            walk.through /= 1.0f - goes_on;
            return reflect(walk, hit, s.reflectance);
        }
        walk.through *= s.transmittance / goes_on;
        world_.tracer.pass(hit, passed);
    }
}

void PathTracer::add_emission(Walk& walk, const Ray& ray, const Hit& hit, const Vec3& radiance, float cosine) const {
    const float facing = std::abs(glm::dot(ray.direction, world_.scene.geometric_normal(hit.triangle)));
    const float part = lights_.ray_share_of_triangle(hit.triangle, cosine, hit.t, facing);
    walk.sum +=
        walk.through * radiance * (kPi * part * walk.state.light_set(world_.scene.instance_of(hit.triangle).light_set));
}

bool PathTracer::reflect(Walk& walk, const Hit& hit, const Vec3& reflectance) const {
    const bool mapped = !hit.back && world_.scene.instance_of(hit.triangle).lightmapped;
    walk.mapped += mapped;
    if (walk.mapped + (mapped ? 0 : 1) > bounces_) return false;
    walk.through *= reflectance;
    if (++walk.length > kSureBounces) {
        const float survives = std::min(kMostSurvive, max_component(reflectance));
        if (walk.random.uniform() >= survives) return false;
        walk.through /= survives;
    }
    walk.at = mapped ? front_vertex(world_, hit.triangle, hit.u, hit.v) : unmapped_vertex(world_, hit);
    return true;
}

} // namespace ajar
