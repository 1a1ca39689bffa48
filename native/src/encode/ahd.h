// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "base/math.h"

namespace ajar {

/// Ambient + highlight direction light of one texel (algorithms.md 1): irradiance on normal n is
/// irradiance_z * (ratio + (1 - ratio) * max(0, n.d) / d.z), exact along z by construction.
struct Ahd {
    Vec3 irradiance{0.0f};   ///< along z, W/m^2
    float ratio = 1.0f;      ///< share of it that is ambient, 0..1
    Vec3 direction{0, 0, 1}; ///< unit, tangent frame, d.z >= kAhdMinHeight
};
/// Above the 0.1 that decoders divide by at least, also after rounding to 8 bits. On levels 0.2, which is enough
/// for synthetic light (algorithms.md 1.4), has 4 to 6 % more error: a fifth of their texels is lit that low.
inline constexpr float kAhdMinHeight = 0.105f;

/// Fits ratio and direction to 9 luminance coefficients of the incident radiance (tangent frame),
/// keeping irradiance as it is.
Ahd fit_ahd(const Vec3& irradiance, const float* sh);

/// Irradiance on unit normal n.
Vec3 decode_ahd(const Ahd& ahd, const Vec3& n);

/// Rounds to nearest; negative and NaN become 0, too large the largest (algorithms.md 2.5).
uint32_t pack_r11g11b10f(const Vec3& v);
Vec3 unpack_r11g11b10f(uint32_t packed);

/// IEEE half float in the low 16 bits; rounds to nearest, too large becomes the largest finite, NaN 0.
uint32_t pack_half(float v);
float unpack_half(uint32_t packed);

/// R, G, B = direction * 0.5 + 0.5, A = ratio, each UNORM8, R in the lowest byte.
uint32_t pack_direction(const Ahd& ahd);
/// ratio and direction of packed; the direction keeps the length that rounding left.
Ahd unpack_direction(uint32_t packed, const Vec3& irradiance);

} // namespace ajar
