// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Sample, density and inverse of each warp side by side. Densities are per steradian, local z up.

#include "base/math.h"

namespace ajar {

/// sin and cos of an angle within +-pi/4, error below 1e-7 (Taylor).
inline void small_sincos(float x, float& s, float& c) {
    const float x2 = x * x;
    s = x * (1.0f + x2 * (-1.0f / 6 + x2 * (1.0f / 120 + x2 * (-1.0f / 5040))));
    c = 1.0f + x2 * (-0.5f + x2 * (1.0f / 24 + x2 * (-1.0f / 720 + x2 * (1.0f / 40320))));
}

/// Concentric square-to-disk map without branches (Shirley and Chiu 1997): x, y on the unit
/// circle and the squared radius, which is uniform in [0,1).
inline void concentric(const Vec2& u, float& cosine, float& sine, float& radius2) {
    const float a = 2.0f * u.x - 1.0f, b = 2.0f * u.y - 1.0f;
    const bool wide = std::abs(a) > std::abs(b);
    const float r = wide ? a : b, other = wide ? b : a;
    float s, c;
    small_sincos(0.25f * kPi * (other / (r != 0.0f ? r : 1.0f)), s, c);
    const float sign = std::copysign(1.0f, r);
    cosine = sign * (wide ? c : s);
    sine = sign * (wide ? s : c);
    radius2 = r * r;
}

/// Hemisphere density share * cos / pi + (1 - share) / (2 pi). Share 1 suits irradiance alone;
/// directional bases need some uniform part, or tilted normals get unbounded weights
/// (algorithms.md 1.10).
inline float hemisphere_pdf(float cosine, float share) {
    return cosine > 0.0f ? kInvPi * (share * cosine + 0.5f * (1.0f - share)) : 0.0f;
}

/// Height of the sample whose base disk has squared radius r2: solves share c^2 + (1-share) c = 1 - r2.
inline float hemisphere_cosine(float r2, float share) {
    const float area = 1.0f - r2;
    const float linear = 1.0f - share;
    return 2.0f * area / std::max(linear + std::sqrt(linear * linear + 4.0f * share * area), 1e-20f);
}

inline Vec3 sample_hemisphere(const Vec2& u, float share) {
    float c, s, r2;
    concentric(u, c, s, r2);
    const float z = hemisphere_cosine(r2, share);
    const float r = std::sqrt(std::max(0.0f, 1.0f - z * z));
    return {r * c, r * s, z};
}

/// Barycentric (u, v) of a uniform point on a triangle (Heitz 2019, area preserving fold).
inline Vec2 sample_triangle(Vec2 u) {
    if (u.y > u.x) {
        u.x *= 0.5f;
        u.y -= u.x;
    } else {
        u.y *= 0.5f;
        u.x -= u.y;
    }
    return u;
}

} // namespace ajar
