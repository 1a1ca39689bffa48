// SPDX-License-Identifier: GPL-3.0-or-later
#include "receiver/switch_solids.h"

#include <map>

namespace ajar {

namespace {

constexpr float kReach = 3.0f;      ///< texels: bilinear lookups beside a solid touch those just under it
constexpr float kClearance = 10.0f; ///< ray offsets between a face and what is moved before it

} // namespace

SwitchSolids::SwitchSolids(const Snapshot& scene, const Tracer& tracer, const std::vector<Behind>& behind)
    : scene_(scene), tracer_(tracer) {
    if (!scene.has_switches()) return;
    std::map<uint32_t, Box> of_instance;
    for (const Triangle& t : scene.triangles) {
        const Instance& instance = scene.instances[t.instance];
        if (instance.element == kNoElement || behind[t.instance] == Behind::room ||
            (scene.ray_mask(t) & kMaskGatherSwitch) == 0)
            continue;
        const Vec3 first = scene.positions[t.vertex[0]];
        Box& box = of_instance.try_emplace(t.instance, Box{first, first}).first->second;
        for (const uint32_t v : t.vertex)
            box.low = glm::min(box.low, scene.positions[v]), box.high = glm::max(box.high, scene.positions[v]);
    }
    for (const auto& [instance, box] : of_instance) boxes_.push_back(box);
}

bool SwitchSolids::is_near(const Vec3& p) const {
    const float margin = kClearance * tracer_.offset_distance(p);
    for (const Box& b : boxes_)
        if (glm::all(glm::greaterThan(p, b.low - margin)) && glm::all(glm::lessThan(p, b.high + margin))) return true;
    return false;
}

// Three ways that leave to different sides: a leaf or sheet without volume is not behind all of them.
Presence SwitchSolids::solid_around(const Vec3& p, const Frame& frame) const {
    Presence solid;
    for (const Vec3& w : {Vec3(0.1f, 0.2f, 0.97f), Vec3(0.6f, -0.5f, 0.62f), Vec3(-0.7f, 0.3f, 0.65f)}) {
        const Hit hit = tracer_.intersect({p, frame.to_world(glm::normalize(w))}, kMaskGatherSwitch);
        if (hit.triangle == kMiss || !hit.back) return {};
        const Presence seen = scene_.presence(hit.triangle);
        if (solid.element != kNoElement && (seen.element != solid.element || seen.state != solid.state)) return {};
        solid = seen;
    }
    return solid;
}

MovedPosition SwitchSolids::move_out(const Vec3& p, const Frame& frame, float texel) const {
    if (!is_near(p)) return {};
    const Presence solid = solid_around(p, frame);
    if (solid.element == kNoElement) return {};
    MovedPosition out;
    float nearest = kReach * texel;
    for (const Vec3& w : {frame.x, -frame.x, frame.y, -frame.y}) {
        const Hit hit = tracer_.intersect({p, w, 0.0f, nearest}, kMaskGatherAll);
        if (hit.triangle == kMiss || !hit.back || scene_.presence(hit.triangle).element != solid.element) continue;
        const Vec3 before =
            p + w * hit.t + scene_.geometric_normal(hit.triangle) * (kClearance * tracer_.offset_distance(p));
        // A face that lies on a wall leads into the wall.
        const Hit wall = tracer_.intersect({before, w, 0.0f, kReach * texel}, kMaskGather);
        if (wall.triangle != kMiss && wall.back) continue;
        nearest = hit.t;
        out = {before, solid};
    }
    return out;
}

} // namespace ajar
