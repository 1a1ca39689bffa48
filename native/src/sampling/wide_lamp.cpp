// SPDX-License-Identifier: GPL-3.0-or-later
#include "sampling/wide_lamp.h"

#include "sampling/spherical_rectangle.h"

namespace ajar {

namespace {

constexpr float kSquare = 1e-3f; ///< cosine between edges that count as upright on each other

/// Coordinates of p over the lamp's edges, each -1/2 to 1/2 on the lamp.
Vec2 on_lamp(const Light& l, const Vec3& p) {
    const Vec3 from = p - l.position;
    return {glm::dot(from, l.edge_x) / glm::dot(l.edge_x, l.edge_x),
            glm::dot(from, l.edge_y) / glm::dot(l.edge_y, l.edge_y)};
}

} // namespace

bool is_wide_lamp(const Light& l, const Vec3& p, float size, float reach) {
    const float x = glm::length(l.edge_x), y = glm::length(l.edge_y);
    if (!(l.area > 0.0f) || l.spread_tan != 0.0f || !(x >= size && y >= size)) return false;
    const float shear = std::max({std::abs(glm::dot(l.edge_x, l.edge_y)) / y, std::abs(glm::dot(l.edge_x, l.axis)),
                                  x / y * std::abs(glm::dot(l.edge_y, l.axis))});
    if (shear > kSquare * x) return false;
    const Vec2 nearest = glm::clamp(on_lamp(l, p), Vec2(-0.5f), Vec2(0.5f));
    return glm::distance(p, l.position + nearest.x * l.edge_x + nearest.y * l.edge_y) < reach;
}

LightSample sample_wide_lamp(const Light& l, const Vec3& p, const Vec2& u) {
    if (!(glm::dot(p - l.position, l.axis) > 0.0f)) return {};
    const SphericalRectangle seen(DVec3(l.position - 0.5f * (l.edge_x + l.edge_y) - p), DVec3(l.edge_x),
                                  DVec3(l.edge_y));
    if (!(seen.solid_angle() > 0.0)) return {};
    const Vec3 offset(seen.sample(u));
    if (l.type == Light::Type::ellipse) {
        const Vec2 at = on_lamp(l, p + offset);
        if (glm::dot(at, at) > 0.25f) return {};
    }
    const float distance = glm::length(offset);
    return {offset / distance, distance, l.intensity * static_cast<float>(seen.solid_angle())};
}

} // namespace ajar
