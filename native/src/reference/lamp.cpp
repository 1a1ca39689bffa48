// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/lamp.h"

#include <limits>

namespace ajar {

namespace {

/// Uniform point of the unit disk.
Vec2 disk(Pcg& random) {
    const float r = std::sqrt(random.uniform()), angle = 2.0f * kPi * random.uniform();
    return {r * std::cos(angle), r * std::sin(angle)};
}

/// What a spot sends along the unit direction w from it, over its intensity (scene/light.cpp).
float spot(const Light& l, const Vec3& w) {
    const float cosine = glm::dot(w, l.axis);
    if (cosine <= std::max(l.cone_cos, 0.0f)) return 0.0f;
    if (!(l.cone_smooth > 0.0f)) return cosine;
    const float t = std::min(1.0f, (cosine - l.cone_cos) / l.cone_smooth);
    return cosine * t * t * (3.0f - 2.0f * t);
}

/// Radiance of an area lamp at an angle of the given tangent to its axis, over the one it would have without spread.
float spread(const Light& l, float tangent) {
    return l.spread_tan == 0.0f ? 1.0f : std::max(0.0f, (l.spread_tan - tangent) * l.spread_scale);
}

/// Even sample of the disk in the lamp's plane from which a point is lit, height (m) in front of it and from_center
/// from its centre; nothing beside the lamp.
LampPoint narrow(const Light& l, const Vec3& from_center, float height, Pcg& random) {
    const Frame f = frame_from_normal(l.axis);
    const Vec2 d = disk(random) * l.spread_tan;
    const Vec3 beside = height * (d.x * f.x + d.y * f.y), at = from_center - height * l.axis + beside;
    const Vec2 on_lamp{glm::dot(at, l.edge_x) / glm::dot(l.edge_x, l.edge_x),
                       glm::dot(at, l.edge_y) / glm::dot(l.edge_y, l.edge_y)};
    const bool ellipse = l.type == Light::Type::ellipse;
    if (ellipse ? glm::length(on_lamp) > 0.5f : std::max(std::abs(on_lamp.x), std::abs(on_lamp.y)) > 0.5f) return {};
    const Vec3 to = beside - height * l.axis;
    const float distance = glm::length(to), cosine = height / distance;
    // Over the disk's area: the height squared cancels with the distance's.
    const float solid = kPi * l.spread_tan * l.spread_tan * cosine * cosine * cosine;
    return {to / distance, distance, l.intensity * (solid * spread(l, glm::length(d)))};
}

/// Whether the lamp's edges and axis all meet at right angles.
bool is_straight(const Light& l) {
    const float size = std::max(glm::length(l.edge_x), glm::length(l.edge_y));
    return std::abs(glm::dot(l.edge_x, l.edge_y)) < 1e-4f * size * size &&
           std::abs(glm::dot(l.edge_x, l.axis)) + std::abs(glm::dot(l.edge_y, l.axis)) < 1e-4f * size;
}

/// A point lamp is a disk that faces p, of the intensity's flux.
LampPoint ball(const Light& l, const Vec3& p, Pcg& random) {
    const Vec3 center = l.position - p;
    const float height = glm::length(center);
    if (!(height > 0.0f)) return {};
    Vec3 to = center;
    if (l.radius > 0.0f) {
        const Frame f = frame_from_normal(center / height);
        const Vec2 d = disk(random) * l.radius;
        to += d.x * f.x + d.y * f.y;
    }
    const float distance = glm::length(to);
    const float cone = l.type == Light::Type::spot ? spot(l, -to / distance) : 1.0f;
    return {to / distance, distance, l.intensity * (cone * height / (distance * distance * distance))};
}

LampPoint area(const Light& l, const Vec3& p, Pcg& random) {
    const float height = glm::dot(p - l.position, l.axis), lit = height * l.spread_tan;
    if (l.spread_tan != 0.0f && height <= 0.0f) return {};
    if (l.spread_tan != 0.0f && kPi * lit * lit < l.area && is_straight(l))
        return narrow(l, p - l.position, height, random);
    Vec2 d = l.type == Light::Type::ellipse ? 0.5f * disk(random) : Vec2(random.uniform() - 0.5f);
    if (l.type == Light::Type::rectangle) d.y = random.uniform() - 0.5f;
    const Vec3 to = l.position + d.x * l.edge_x + d.y * l.edge_y - p;
    const float distance = glm::length(to);
    if (!(distance > 0.0f)) return {};
    const float cosine = -glm::dot(to, l.axis) / distance;
    if (!(cosine > 0.0f)) return {};
    const float tangent = glm::length(to / distance + cosine * l.axis) / cosine;
    return {to / distance, distance, l.intensity * (l.area * cosine * spread(l, tangent) / (distance * distance))};
}

LampPoint sun(const Light& l, Pcg& random) {
    const Frame f = frame_from_normal(l.axis);
    const Vec2 d = disk(random) * l.radius;
    return {-glm::normalize(l.axis + d.x * f.x + d.y * f.y), std::numeric_limits<float>::infinity(), l.intensity};
}

bool is_area(const Light& l) { return l.type == Light::Type::rectangle || l.type == Light::Type::ellipse; }

} // namespace

LampPoint lamp_point(const Light& l, const Vec3& p, Pcg& random) {
    if (l.type == Light::Type::sun) return sun(l, random);
    return is_area(l) ? area(l, p, random) : ball(l, p, random);
}

float lamp_strength(const Light& l, const Vec3& p, const Vec3& n) {
    const float strength = luminance(l.intensity) * (is_area(l) ? l.area : 1.0f);
    if (l.type == Light::Type::sun) return strength * std::max(0.0f, -glm::dot(l.axis, n) + l.radius);
    const Vec3 to = l.position - p;
    const float extent = is_area(l) ? 0.5f * (glm::length(l.edge_x) + glm::length(l.edge_y)) : l.radius;
    const float square = glm::dot(to, to) + extent * extent, distance = std::sqrt(square);
    return strength * std::max(0.0f, (glm::dot(to, n) + extent) / distance) / square;
}

} // namespace ajar
