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

/// Part of a lamp's plane in units of its edges, the whole lamp being -1/2 to 1/2.
struct Part {
    Vec2 low{-0.5f}, high{0.5f};
};

/// The part of an area lamp that a limited spread lets p see: a disk about p's foot on the lamp's plane, in its box.
Part lit_part(const Light& l, const Vec3& p) {
    Part out;
    if (l.spread_tan == 0.0f) return out;
    const float height = glm::dot(p - l.position, l.axis), reach = height * l.spread_tan;
    const Vec3 foot = p - l.axis * height - l.position, across = glm::cross(l.edge_x, l.edge_y);
    const float size = glm::length(across);
    if (!(size > 0.0f)) return out;
    const Vec3 n = across / size;
    const Vec2 at(glm::dot(glm::cross(foot, l.edge_y), n) / size, glm::dot(glm::cross(l.edge_x, foot), n) / size);
    const Vec2 half = Vec2(glm::length(l.edge_y), glm::length(l.edge_x)) * (reach / size);
    return {glm::max(out.low, at - half), glm::min(out.high, at + half)};
}

LampPoint area(const Light& l, const Vec3& p, Pcg& random) {
    const Part part = lit_part(l, p);
    const Vec2 size = part.high - part.low;
    const Vec2 d = part.low + size * Vec2(random.uniform(), random.uniform());
    if (!(size.x > 0.0f && size.y > 0.0f)) return {};
    if (l.type == Light::Type::ellipse && glm::dot(d, d) > 0.25f) return {};
    const Vec3 to = l.position + d.x * l.edge_x + d.y * l.edge_y - p;
    const float distance = glm::length(to);
    if (!(distance > 0.0f)) return {};
    const float cosine = -glm::dot(to, l.axis) / distance;
    if (!(cosine > 0.0f)) return {};
    const float lit = size.x * size.y * glm::length(glm::cross(l.edge_x, l.edge_y));
    const float tangent = glm::length(to / distance + cosine * l.axis) / cosine;
    return {to / distance, distance, l.intensity * (lit * cosine * spread(l, tangent) / (distance * distance))};
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

} // namespace ajar
