// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/surface.h"

namespace ajar {

namespace {

Vec3 smooth_position(const Snapshot& s, uint32_t triangle, float u, float v) {
    const Triangle& t = s.triangles[triangle];
    const Vec3 flat = s.position(triangle, u, v), n = s.geometric_normal(triangle);
    if (s.is_flat(triangle)) return flat;
    const float weight[3] = {1.0f - u - v, u, v};
    float outward = 0.0f;
    for (int k = 0; k < 3; ++k) {
        const Vec3 corner = s.corner_normal(triangle, k);
        outward -= weight[k] * glm::dot(flat - s.positions[t.vertex[k]], corner) * glm::dot(corner, n);
    }
    return flat + n * std::max(outward, 0.0f);
}

} // namespace

Vertex front_vertex(const World& world, uint32_t triangle, float u, float v) {
    const Vec3 position = smooth_position(world.scene, triangle, u, v);
    const Vec3 n = world.scene.shading_normal(triangle, u, v);
    const Vec3 side = world.scene.geometric_normal(triangle);
    return {world.tracer.offset(position, side), n, side, false};
}

Vertex unmapped_vertex(const World& world, const Hit& hit) {
    const float turn = hit.back ? -1.0f : 1.0f;
    const Vec3 side = world.scene.geometric_normal(hit.triangle) * turn;
    const Vec3 n = world.scene.shading_normal(hit.triangle, hit.u, hit.v) * turn;
    return {world.tracer.offset(world.scene.position(hit.triangle, hit.u, hit.v), side), n, side, false};
}

} // namespace ajar
