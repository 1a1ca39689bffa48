// SPDX-License-Identifier: GPL-3.0-or-later
// Area lamps. A spread lets each point of the lamp shine into a cone about the axis only, so a point is lit by the
// part of the lamp inside the same cone upwards from it: a disk in the lamp's plane, small where the spread is. Only
// that part is sampled; a narrow beam would else be met by no sample at all, or by one that counts for thousands.
#include "scene/area_lamp.h"

namespace ajar {

namespace {

/// A disk that the lamp covers at least to this share is sampled itself, by its light; of others the part that
/// lies within the lamp. Below it the samples beside the lamp would cost more noise than the uneven light inside.
constexpr float kCovered = 0.5f;

/// The part of a lamp's plane from which a point is lit, in units of the lamp's edges about its centre.
struct Cone {
    Vec3 dual_x{0.0f}, dual_y{0.0f}; ///< 1/m; products with them are coordinates, whatever angle the edges meet at
    Vec2 foot{0.0f};                 ///< nearest point of the plane
    float height = 0.0f;             ///< m, of the point in front of the plane
    Vec2 low{-0.5f}, high{0.5f};     ///< bounds of the part inside the lamp
    float covered = 1.0f;            ///< share of the disk's bounds that lies inside the lamp's
    bool whole = true;               ///< the bounds are the lamp's

    Vec2 at(const Vec3& from_center) const { return {glm::dot(from_center, dual_x), glm::dot(from_center, dual_y)}; }
    bool empty() const { return !(low.x < high.x && low.y < high.y); }
    Vec2 size() const { return glm::max(high - low, Vec2(0.0f)); }
};

/// What reaches within reach (m) of p.
Cone cone_above(const Light& l, const Vec3& p, float reach) {
    Cone c;
    const Vec3 from = p - l.position;
    c.height = glm::dot(from, l.axis);
    if (l.spread_tan == 0.0f) return c;
    // A sheared lamp shines at an angle to its plane; it is sampled whole.
    const float tilt = std::abs(glm::dot(l.edge_x, l.axis)) + std::abs(glm::dot(l.edge_y, l.axis));
    if (!(l.area > 0.0f) || tilt > 1e-4f * (glm::length(l.edge_x) + glm::length(l.edge_y))) return c;
    const Vec3 across_x = glm::cross(l.edge_y, l.axis), across_y = glm::cross(l.edge_x, l.axis);
    c.dual_x = across_x / glm::dot(across_x, l.edge_x);
    c.dual_y = across_y / glm::dot(across_y, l.edge_y);
    c.foot = c.at(from);
    const float radius = std::max(c.height + reach, 0.0f) * l.spread_tan + reach;
    const Vec2 extent = radius * Vec2(glm::length(c.dual_x), glm::length(c.dual_y));
    c.low = glm::max(c.foot - extent, Vec2(-0.5f));
    c.high = glm::min(c.foot + extent, Vec2(0.5f));
    c.whole = c.low == Vec2(-0.5f) && c.high == Vec2(0.5f);
    c.covered = c.size().x * c.size().y / std::max(4.0f * extent.x * extent.y, 1e-37f);
    return c;
}

bool inside(const Light& l, const Vec2& at) {
    if (l.type == Light::Type::ellipse) return glm::dot(at, at) <= 0.25f;
    return std::abs(at.x) <= 0.5f && std::abs(at.y) <= 0.5f;
}

/// Samples the disk by its light: (1 - r) over the relative radius r, but for the cosines. The area within r holds
/// 3 r^2 - 2 r^3 of it, the inverse of which is a sine.
LightSample sample_disk(const Light& l, const Cone& c, const Vec2& u) {
    const Vec2 d = square_to_disk(u);
    const float square = glm::dot(d, d);
    const float r = 0.5f - std::sin(std::asin(std::clamp(1.0f - 2.0f * square, -1.0f, 1.0f)) / 3.0f);
    const Vec2 on_disk = square > 0.0f ? d * (r * c.height * l.spread_tan / std::sqrt(square)) : Vec2(0.0f);
    const Vec3 x = glm::normalize(l.edge_x), y = glm::cross(l.axis, x);
    const Vec3 beside = on_disk.x * x + on_disk.y * y;
    if (!inside(l, c.foot + c.at(beside))) return {};
    const Vec3 offset = beside - c.height * l.axis;
    const float length = glm::length(offset), cosine = c.height / length;
    const float flux = kPi / 3.0f * l.spread_scale * l.spread_tan * l.spread_tan * l.spread_tan;
    return {offset / length, length, l.intensity * (flux * cosine * cosine * cosine)};
}

/// Share of the lamp's radiance that leaves it along -w, at a cosine to its axis.
float spread_factor(const Light& l, const Vec3& w, float cosine) {
    if (l.spread_tan == 0.0f) return 1.0f;
    // From the part of w in the plane: 1 - cosine^2 has no digits left in narrow beams.
    const float tangent = glm::length(w + cosine * l.axis) / cosine;
    return std::max(0.0f, (l.spread_tan - tangent) * l.spread_scale);
}

/// Samples the bounds of the lit part evenly.
LightSample sample_bounds(const Light& l, const Cone& c, const Vec3& p, const Vec2& u) {
    const bool ellipse = l.type == Light::Type::ellipse;
    const Vec2 at = c.whole ? (ellipse ? 0.5f * square_to_disk(u) : u - 0.5f) : glm::mix(c.low, c.high, u);
    if (!c.whole && !inside(l, at)) return {};
    const Vec3 offset = l.position + at.x * l.edge_x + at.y * l.edge_y - p;
    const float length2 = glm::dot(offset, offset);
    if (!(length2 > 0.0f)) return {};
    const float length = std::sqrt(length2);
    const Vec3 w = offset / length;
    const float cosine = -glm::dot(w, l.axis);
    if (cosine <= 0.0f) return {};
    const float area = c.whole ? l.area : c.size().x * c.size().y * glm::length(glm::cross(l.edge_x, l.edge_y));
    return {w, length, l.intensity * (area * cosine * spread_factor(l, w, cosine) / length2)};
}

/// Largest share of the lamp's radiance that arrives within reach of the point, roughly halved for its mean.
float spread_near(const Light& l, const Cone& c, float reach) {
    if (l.spread_tan == 0.0f) return 1.0f;
    const Vec2 beside = glm::max(glm::max(c.low - c.foot, c.foot - c.high), Vec2(0.0f));
    const float distance = std::max(glm::length(beside.x * l.edge_x + beside.y * l.edge_y) - reach, 0.0f);
    const float tangent = distance / std::max(c.height + reach, 1e-6f);
    return 0.5f * l.spread_scale * std::max(l.spread_tan - tangent, 0.01f * l.spread_tan);
}

} // namespace

LightSample sample_area_lamp(const Light& lamp, const Vec3& p, const Vec2& u) {
    const Cone cone = cone_above(lamp, p, 0.0f);
    if (cone.empty()) return {};
    return !cone.whole && cone.covered >= kCovered ? sample_disk(lamp, cone, u) : sample_bounds(lamp, cone, p, u);
}

float area_lamp_importance(const Light& l, const Vec3& p, const Vec3& n, float reach) {
    const Cone c = cone_above(l, p, reach);
    if (c.empty()) return 0.0f;
    const Vec2 middle = 0.5f * (c.low + c.high), size = c.size();
    const Vec3 to_light = l.position + middle.x * l.edge_x + middle.y * l.edge_y - p;
    const float extent =
        reach + (c.whole ? l.extent : 0.5f * (size.x * glm::length(l.edge_x) + size.y * glm::length(l.edge_y)));
    const float distance2 = glm::dot(to_light, to_light), distance = std::max(std::sqrt(distance2), 1e-6f);
    const float cosine = std::min(1.0f, (glm::dot(to_light, n) + extent) / distance);
    const float emitter_cosine = std::min(1.0f, (-glm::dot(to_light, l.axis) + extent) / distance);
    if (cosine <= 0.0f || emitter_cosine <= 0.0f) return 0.0f;
    const float falloff = 1.0f / std::max(distance2 + 0.25f * extent * extent, 1e-12f);
    return luminance(l.intensity) * l.area * size.x * size.y * spread_near(l, c, reach) * cosine * emitter_cosine *
           falloff;
}

} // namespace ajar
