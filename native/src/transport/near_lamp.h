// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "receiver/lightmap.h"
#include "sampling/emitters.h"
#include "sampling/spherical_rectangle.h"
#include "sampling/wide_lamp.h"

namespace ajar {

/// Vector irradiance over the rectangle [x0,x1] x [y0,y1] of a point of intensity 1 at height h over the origin,
/// integrated over the rectangle: sums of (-x, -y, h) / distance^3. Its z is the solid angle (algorithms.md 7.2).
inline Vec3 rectangle_vector_irradiance(float x0, float x1, float y0, float y1, float h) {
    const auto angle = [h](float x, float y) { return std::atan2(x * y, h * std::sqrt(x * x + y * y + h * h)); };
    const auto along = [h](float a, float b) { return std::asinh(b / std::sqrt(a * a + h * h)); };
    return {along(x1, y1) - along(x1, y0) - along(x0, y1) + along(x0, y0),
            along(y1, x1) - along(y1, x0) - along(y0, x1) + along(y0, x0),
            angle(x1, y1) - angle(x0, y1) - angle(x1, y0) + angle(x0, y0)};
}

/// Frame of a position's cell: z along the surface's own normal.
inline Frame cell_frame(const LightmapReceivers& receivers, uint32_t r, uint32_t position) {
    const Frame& f = receivers.frame[r];
    if (!receivers.leans(r)) return f;
    const Vec3& z = receivers.plane(r, position);
    return frame_from_tangent(z, std::abs(glm::dot(f.x, z)) < std::abs(glm::dot(f.y, z)) ? f.x : f.y, 1.0f);
}

/// Irradiance at the origin with unit normal n from a rectangle of unit radiance (Lambert 1760): corners in order,
/// clipped to the horizon, the angles of the edges times the cosines of their planes.
inline float rectangle_irradiance(const Vec3 (&corner)[4], const Vec3& n) {
    Vec3 kept[5];
    int count = 0;
    for (int i = 0; i < 4; ++i) {
        const Vec3 &a = corner[i], &b = corner[(i + 1) % 4];
        const float over_a = glm::dot(a, n), over_b = glm::dot(b, n);
        if (over_a > 0.0f) kept[count++] = a;
        if ((over_a > 0.0f) != (over_b > 0.0f)) kept[count++] = a + (b - a) * (over_a / (over_a - over_b));
        if (count == 5) break;
    }
    float sum = 0.0f;
    for (int i = 0; i < count; ++i) {
        const Vec3 &a = kept[i], &b = kept[(i + 1) % count], across = glm::cross(a, b);
        const float length = glm::length(across);
        if (length > 0.0f) sum += std::atan2(length, glm::dot(a, b)) * glm::dot(across, n) / length;
    }
    return 0.5f * std::abs(sum);
}

constexpr float kNearCells = 3.0f; ///< edges of a position's part of a texel: nearer lamps change much across it
/// Edges: larger area lamps are sampled by solid angle, smaller ones by area. Noise of the flux below a lamp 3 mm over
/// a floor, by solid angle for by area: .071 for .024 at 1 edge, .010 for .169 at 4.
constexpr float kWideCells = 4.0f;
/// Heights of a point lamp: from this radius on samples start by its light. With near_lamp_factor() instead, the flux
/// below it is 1.3 % too much at a radius of half the height, .1 % at .3.
constexpr float kSmallLamp = 0.25f;

/// Edge of the part of a texel that each position stands for, m.
inline float cell_edge(const LightmapReceivers& receivers, uint32_t r) {
    return receivers.texel_size[r] / std::sqrt(static_cast<float>(receivers.positions_per_texel));
}

/// Where a sample to a lamp close to an open texel starts, in the part of it that a position stands for.
struct LampStart {
    Vec3 point{0.0f};
    float weight = 1.0f; ///< of the sample, for how the point was chosen or what it stands for
    bool near = false;   ///< the point was chosen by the lamp
    bool wide = false;   ///< the lamp is_wide_lamp()
};

/// A start by the light of a point lamp, which falls with the cube of the distance: even over the solid angle that the
/// part fills as seen from the lamp, or from its radius above its foot, under which the light changes little.
inline LampStart start_below_point_lamp(const LightmapReceivers& receivers, uint32_t r, uint32_t position,
                                        const Light& lamp, const Vec2& u) {
    constexpr float kSquare = 0.02f; // cosine between edges
    const Vec3* o = receivers.origins(r);
    const Vec3 x = o[1] - o[0], y = o[grid_columns(receivers.positions_per_texel)] - o[0], across = glm::cross(x, y);
    const float area = glm::length(across);
    if (!(area > 0.0f) || std::abs(glm::dot(x, y)) > kSquare * area) return {};
    const Vec3 n = across / area, corner = o[position] - 0.5f * (x + y);
    const float over = glm::dot(lamp.position - corner, n), height = std::max(std::abs(over), lamp.radius);
    if (lamp.radius < kSmallLamp * height) return {};
    const Vec3 from = lamp.position + n * (height - over);
    const SphericalRectangle part(DVec3(corner - from), DVec3(x), DVec3(y));
    if (!(part.solid_angle() > 0.0)) return {};
    const DVec3 offset = part.sample(u);
    const double distance = glm::length(offset);
    const double weight = part.solid_angle() * distance * distance * distance / (double(height) * area);
    return {from + Vec3(offset), static_cast<float>(weight), true, false};
}

/// Whether a lamp's light may change much across the part of the texel about a position p.
inline bool is_close(const LightmapReceivers& receivers, uint32_t r, const Vec3& p, const Light& lamp) {
    const Vec3 to = lamp.position - p;
    const float most = kNearCells * cell_edge(receivers, r) + lamp.extent;
    return glm::dot(to, to) < most * most && lamp.type != Light::Type::sun;
}

/// The start of a sample to a lamp that is_close() to an open texel; p: the position.
inline LampStart lamp_start(const LightmapReceivers& receivers, uint32_t r, uint32_t position, const Vec3& p,
                            const Light& lamp, const Vec2& u) {
    if (lamp.type == Light::Type::point || lamp.type == Light::Type::spot)
        return start_below_point_lamp(receivers, r, position, lamp, u);
    const float cell = cell_edge(receivers, r);
    if (!is_wide_lamp(lamp, p, kWideCells * cell, kNearCells * cell)) return {};
    return {receivers.in_cell(r, position, u), 1.0f, true, true};
}

/// Whether a lamp is so close to a texel that its irradiance varies too steeply for the texel's few positions.
inline bool is_near_lamp(const LightmapReceivers& receivers, uint32_t r, const EmitterSample& s) {
    return (s.point_like || s.lobe != Vec3(0.0f)) && receivers.whole[r] != 0 && receivers.cut[r] == 0 &&
           s.distance < kNearCells * cell_edge(receivers, r) && s.distance > 0.0f;
}

/// The mean of a near lamp's light over the cell of a position p, over the value at the position; 1 for other emitters.
/// For a point lamp it is the lamp's vector irradiance of the cell, along the shading normal, over its area; for a
/// point of an area lamp the cell's irradiance, as light that comes from the cell would bring it there, is the same by
/// reciprocity.
inline float near_lamp_factor(const LightmapReceivers& receivers, uint32_t r, uint32_t position, const Vec3& p,
                              const EmitterSample& s) {
    if (!is_near_lamp(receivers, r, s)) return 1.0f;
    const float cell = cell_edge(receivers, r), half = 0.5f * cell, cube = s.distance * s.distance * s.distance;
    const Frame frame = cell_frame(receivers, r, position);
    const Vec3 l = frame.to_local(s.target - p), n = frame.to_local(receivers.frame[r].z);
    const float along = glm::dot(l, n);
    if (!(l.z > 0.0f) || !(along > 0.0f)) return 1.0f;
    const float x0 = -half - l.x, x1 = half - l.x, y0 = -half - l.y, y1 = half - l.y;
    if (s.point_like) {
        const float mean = glm::dot(rectangle_vector_irradiance(x0, x1, y0, y1, l.z), n) / (cell * cell);
        return mean > 0.0f ? mean * cube / along : 1.0f;
    }
    const Vec3 corners[4] = {{x0, y0, -l.z}, {x1, y0, -l.z}, {x1, y1, -l.z}, {x0, y1, -l.z}};
    const float cosine = std::max(-glm::dot(s.direction, s.lobe), 1e-6f);
    return rectangle_irradiance(corners, frame.to_local(s.lobe)) * cube / (l.z * cell * cell) / cosine;
}

} // namespace ajar
