// SPDX-License-Identifier: GPL-3.0-or-later
#include "receiver/push_out.h"

#include <algorithm>
#include <numbers>

namespace ajar {

namespace {

constexpr int kWays = 16;
constexpr int kRounds = 2;          ///< of moving: two things may stand into each other
constexpr float kClearance = 10.0f; ///< ray offsets before the face

/// Way i of kWays into the hemisphere, cosine distributed, on a spiral of golden angles (Vogel 1979).
Vec3 way(int i) {
    const float share = (static_cast<float>(i) + 0.5f) / kWays, r = std::sqrt(share);
    const float angle = 2.39996f * static_cast<float>(i);
    return {r * std::cos(angle), r * std::sin(angle), std::sqrt(1.0f - share)};
}

} // namespace

Vec3 PushOut::out_of_the_dark(Vec3 p, const Frame& frame, float texel, uint64_t& moves) const {
    for (int round = 0; round < kRounds; ++round) {
        Hit nearest;
        nearest.t = texel * std::numbers::sqrt2_v<float>;
        Vec3 direction(0.0f);
        for (const Vec3& w : {frame.x, -frame.x, frame.y, -frame.y}) {
            const Hit hit = tracer_.intersect({p, w, 0.0f, nearest.t}, kMaskGather);
            if (hit.triangle != kMiss && hit.back) nearest = hit, direction = w;
        }
        if (nearest.triangle == kMiss || !(is_in_solid(nearest) || is_dark(p, frame))) break;
        p += direction * nearest.t;
        p += scene_.geometric_normal(nearest.triangle) * (kClearance * tracer_.offset_distance(p));
        ++moves;
    }
    return p;
}

/// Whether a hit shows that the ray starts in a solid, where no light comes, whatever else stands in it.
bool PushOut::is_in_solid(const Hit& hit) const {
    return hit.back && behind_[scene_.triangles[hit.triangle].instance] == Behind::solid;
}

// Where all ways end on backs or in a black sky, nothing sends light there but perhaps a lamp.
bool PushOut::is_dark(const Vec3& p, const Frame& frame) const {
    for (int i = 0; i < kWays; ++i) {
        const Hit hit = tracer_.intersect({p, frame.to_world(way(i))}, kMaskGather);
        if (hit.triangle == kMiss && !scene_.sky.lit()) continue;
        if (hit.triangle == kMiss || !hit.back) return false;
        if (is_in_solid(hit)) return true;
        const Material& material = scene_.materials[scene_.triangles[hit.triangle].material];
        if (material.emits || material.transmits) return false;
    }
    return !is_lit_by_lamp(p, frame.z);
}

bool PushOut::is_lit_by_lamp(const Vec3& p, const Vec3& n) const {
    return std::any_of(scene_.lights.begin(), scene_.lights.end(), [&](const Light& l) {
        if (l.dark() || !(l.importance(p, n) > 0.0f)) return false;
        const LightSample s = l.sample(p, {0.5f, 0.5f});
        return max_component(s.weight) > 0.0f && glm::dot(s.direction, n) > 0.0f &&
               !tracer_.occluded({p, s.direction, 0.0f, s.distance}, kMaskShadowOpaque);
    });
}

} // namespace ajar
