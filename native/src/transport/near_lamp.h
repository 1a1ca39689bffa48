// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "receiver/lightmap.h"
#include "sampling/emitters.h"

namespace ajar {

/// Solid angle of the rectangle [x0,x1] x [y0,y1] at distance h (algorithms.md 7.2).
inline float rectangle_solid_angle(float x0, float x1, float y0, float y1, float h) {
    const auto f = [h](float x, float y) { return std::atan2(x * y, h * std::sqrt(x * x + y * y + h * h)); };
    return f(x1, y1) - f(x0, y1) - f(x1, y0) + f(x0, y0);
}

/// Close above a texel a lamp's irradiance varies too steeply for its few positions. The mean over
/// the cell of a position is the lamp's intensity times the cell's solid angle over its area; this
/// is that mean over the value at the position, 1 far away and at chart borders.
inline float near_lamp_factor(const LightmapReceivers& receivers, uint32_t r, const Vec3& p, const EmitterSample& s) {
    const float cell = receivers.texel_size[r] / std::sqrt(static_cast<float>(receivers.positions_per_texel));
    if (!s.point_like || receivers.whole[r] == 0 || receivers.cut[r] != 0 || !(s.distance < 3.0f * cell)) return 1.0f;
    const Vec3 l = receivers.frame[r].to_local(s.target - p);
    if (!(l.z > 0.0f) || !(s.distance > 0.0f)) return 1.0f;
    const float half = 0.5f * cell;
    const float mean = rectangle_solid_angle(-half - l.x, half - l.x, -half - l.y, half - l.y, l.z) / (cell * cell);
    return mean * s.distance * s.distance * s.distance / l.z;
}

} // namespace ajar
