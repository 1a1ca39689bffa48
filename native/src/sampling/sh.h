// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/math.h"

namespace ajar {

inline constexpr int kShCount = 9;
inline constexpr float kSh0 = 0.28209479f, kSh1 = 0.48860251f, kSh2 = 1.09254843f, kSh3 = 0.31539157f,
                       kSh4 = 0.54627422f;

/// Real spherical harmonics up to l = 2 in Sloan's order and signs (algorithms.md, conventions).
/// T: a number, or Lanes of them.
template <class T>
void sh_basis(const T& x, const T& y, const T& z, T* out) {
    out[0] = T{} + kSh0;
    out[1] = -kSh1 * y;
    out[2] = kSh1 * z;
    out[3] = -kSh1 * x;
    out[4] = kSh2 * x * y;
    out[5] = -kSh2 * y * z;
    out[6] = kSh3 * (3.0f * z * z - 1.0f);
    out[7] = -kSh2 * x * z;
    out[8] = kSh4 * (x * x - y * y);
}

/// Irradiance on unit normal n of radiance coefficients c (Ramamoorthi and Hanrahan 2001).
inline float sh_irradiance(const float* c, const Vec3& n) {
    float y[kShCount];
    sh_basis(n.x, n.y, n.z, y);
    const float band1 = c[1] * y[1] + c[2] * y[2] + c[3] * y[3];
    const float band2 = c[4] * y[4] + c[5] * y[5] + c[6] * y[6] + c[7] * y[7] + c[8] * y[8];
    return kPi * c[0] * y[0] + (2.0f * kPi / 3.0f) * band1 + 0.25f * kPi * band2;
}

} // namespace ajar
