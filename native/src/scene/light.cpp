// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/light.h"

#include <limits>

#include "scene/area_lamp.h"

namespace ajar {

namespace {

/// Cycles 3.4 takes narrower spreads for 1 degree (measured). It also makes beams below 3 degrees up to 1.26 times as
/// bright as the lamp, a cancellation in single precision that is not repeated here: the flux stays the lamp's.
constexpr float kLeastHalfSpread = 0.5f * kPi / 180.0f;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

float smoothstep(float x) {
    const float t = std::clamp(x, 0.0f, 1.0f);
    return t * t * (3.0f - 2.0f * t);
}

/// Share of the intensity that a spot sends along the unit direction from light. The cosine in
/// front is Cycles' (measured): its spots fade towards the rim even without blend.
float spot_factor(const Light& l, const Vec3& from_light) {
    const float cosine = glm::dot(from_light, l.axis);
    if (cosine <= std::max(l.cone_cos, 0.0f)) return 0.0f;
    return cosine * (l.cone_smooth > 0.0f ? smoothstep((cosine - l.cone_cos) / l.cone_smooth) : 1.0f);
}

LightSample sample_sun(const Light& l, const Vec2& u) {
    const Vec2 d = square_to_disk(u) * l.radius;
    const Frame frame = frame_from_normal(l.axis);
    return {-glm::normalize(l.axis + d.x * frame.x + d.y * frame.y), kInfinity, l.intensity};
}

// Cycles shows a point lamp as a disk that faces each receiver; so does this. The disk is sampled by solid angle: next
// to a lamp most of its light comes from the little part that is nearest.
LightSample sample_ball(const Light& l, const Vec3& p, const Vec2& u) {
    const Vec3 to_center = l.position - p;
    const float distance2 = glm::dot(to_center, to_center);
    if (!(distance2 > 0.0f)) return {};
    const float center_distance = std::sqrt(distance2), square = l.radius * l.radius;
    const Vec2 d = l.radius > 0.0f ? square_to_disk(u) : Vec2(0.0f);
    // ratio = (1 - cosine to the disk's rim) / radius^2. The disk's solid angle is 2 pi radius^2 ratio, its radiance
    // intensity / (pi radius^2); the product has a limit at radius 0.
    const float rim = std::sqrt(distance2 + square), ratio = 1.0f / (rim * (rim + center_distance));
    const float versine = glm::dot(d, d) * square * ratio;             // 1 - cosine to the point
    const float sine = l.radius * std::sqrt(ratio * (2.0f - versine)); // over |d|
    const Frame frame = frame_from_normal(to_center / center_distance);
    const Vec3 w = (1.0f - versine) * frame.z + sine * (d.x * frame.x + d.y * frame.y);
    const float cone = l.type == Light::Type::spot ? spot_factor(l, -w) : 1.0f;
    return {w, center_distance / (1.0f - versine), l.intensity * (2.0f * cone * ratio)};
}

void set_spot(Light& l, const ajar_light_desc& d) {
    l.cone_cos = std::cos(0.5f * std::clamp(d.spot_angle, 0.0f, kPi));
    l.cone_smooth = (1.0f - l.cone_cos) * std::clamp(d.spot_blend, 0.0f, 1.0f);
}

void set_area(Light& l, const ajar_light_desc& d, const Affine& m) {
    l.edge_x = Vec3(m.column(0)) * std::abs(d.size_x);
    l.edge_y = Vec3(m.column(1)) * std::abs(d.size_y);
    l.extent = 0.5f * (glm::length(l.edge_x) + glm::length(l.edge_y));
    l.area = glm::length(glm::cross(l.edge_x, l.edge_y)) * (l.type == Light::Type::ellipse ? 0.25f * kPi : 1.0f);
    l.intensity = l.area > 0.0f ? l.intensity / (4.0f * l.area) : Vec3(0.0f);
    const float half = 0.5f * d.spread;
    if (half >= 0.5f * kPi - 1e-5f) return;
    const float limited = std::max(half, kLeastHalfSpread);
    l.spread_tan = std::tan(limited);
    // In double: tan x - x cancels for narrow beams.
    l.spread_scale = static_cast<float>(1.0 / (std::tan(double(limited)) - double(limited)));
}

} // namespace

Vec2 square_to_disk(const Vec2& u) {
    const float a = 2.0f * u.x - 1.0f, b = 2.0f * u.y - 1.0f;
    if (a == 0.0f && b == 0.0f) return Vec2(0.0f);
    const bool wide = std::abs(a) > std::abs(b);
    const float r = wide ? a : b;
    const float phi = wide ? 0.25f * kPi * (b / a) : 0.5f * kPi - 0.25f * kPi * (a / b);
    return {r * std::cos(phi), r * std::sin(phi)};
}

LightSample Light::sample(const Vec3& p, const Vec2& u) const {
    switch (type) {
        case Type::sun:
            return sample_sun(*this, u);
        case Type::point:
        case Type::spot:
            return sample_ball(*this, p, u);
        default:
            return sample_area_lamp(*this, p, u);
    }
}

float Light::importance(const Vec3& p, const Vec3& n, float reach) const {
    if (type == Type::rectangle || type == Type::ellipse) return area_lamp_importance(*this, p, n, reach);
    const float strength = luminance(intensity);
    if (type == Type::sun) return strength * std::max(0.0f, -glm::dot(axis, n) + radius);
    const Vec3 to_light = position - p;
    const float distance2 = glm::dot(to_light, to_light), distance = std::sqrt(distance2);
    // The lamp's nearest part may stand higher over the horizon than its centre does.
    const float cosine = std::min(1.0f, (glm::dot(to_light, n) + radius) / std::max(distance, 1e-6f));
    if (cosine <= 0.0f) return 0.0f;
    const float falloff = 1.0f / std::max(distance2 + 0.25f * radius * radius, 1e-12f);
    if (type == Type::spot && distance > 2.0f * radius && spot_factor(*this, -to_light / distance) == 0.0f &&
        radius == 0.0f)
        return 0.0f;
    return strength * cosine * falloff;
}

void Light::move(const DVec3& offset) {
    exact_position += offset;
    position = Vec3(exact_position);
}

Light make_light(const ajar_light_desc& d, const std::string& name, const Affine& m) {
    static constexpr Light::Type kTypes[] = {Light::Type::point, Light::Type::spot, Light::Type::sun,
                                             Light::Type::rectangle, Light::Type::ellipse};
    Light l;
    l.name = name;
    l.type = kTypes[d.type];
    l.primary = d.role == AJAR_ROLE_PRIMARY;
    l.casts_shadow = d.casts_shadow != 0;
    l.exact_position = m.column(3);
    l.position = Vec3(l.exact_position);
    l.axis = -normalize_or(Vec3(m.column(2)), {0, 0, 1});
    // Negative lights are a renderer's trick; a package stores no negative irradiance.
    l.intensity = glm::max(Vec3(d.color[0], d.color[1], d.color[2]) * d.energy, Vec3(0.0f));
    switch (l.type) {
        case Light::Type::spot:
            set_spot(l, d);
            [[fallthrough]];
        case Light::Type::point:
            l.radius = l.extent = std::max(d.radius, 0.0f);
            l.intensity *= 0.25f * kInvPi;
            break;
        case Light::Type::sun:
            l.radius = std::tan(0.5f * std::clamp(d.sun_angle, 0.0f, 0.9999f * kPi));
            break;
        default:
            set_area(l, d, m);
            break;
    }
    return l;
}

} // namespace ajar
