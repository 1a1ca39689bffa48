// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "receiver/lightmap.h"
#include "sampling/emitters.h"

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

/// Close above a texel a lamp's irradiance varies too steeply for its few positions. The mean over
/// the cell of a position is the lamp's vector irradiance of the cell, along the shading normal, over its area; this
/// is that mean over the value at the position, 1 far away and at chart borders.
inline float near_lamp_factor(const LightmapReceivers& receivers, uint32_t r, uint32_t position, const Vec3& p,
                              const EmitterSample& s) {
    const float cell = receivers.texel_size[r] / std::sqrt(static_cast<float>(receivers.positions_per_texel));
    if (!s.point_like || receivers.whole[r] == 0 || receivers.cut[r] != 0 || !(s.distance < 3.0f * cell)) return 1.0f;
    const Frame frame = cell_frame(receivers, r, position);
    const Vec3 l = frame.to_local(s.target - p), n = frame.to_local(receivers.frame[r].z);
    const float along = glm::dot(l, n);
    if (!(l.z > 0.0f) || !(along > 0.0f)) return 1.0f;
    const float half = 0.5f * cell;
    const Vec3 sum = rectangle_vector_irradiance(-half - l.x, half - l.x, -half - l.y, half - l.y, l.z);
    const float mean = glm::dot(sum, n) / (cell * cell);
    return mean > 0.0f ? mean * s.distance * s.distance * s.distance / along : 1.0f;
}

} // namespace ajar
