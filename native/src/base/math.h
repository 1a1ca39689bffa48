// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// GLM under the names the engine uses, and the few helpers it lacks. Right-handed, Z up, metres.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <numbers>

namespace ajar {

using Vec2 = glm::vec2;
using Vec3 = glm::vec3;
using Vec4 = glm::vec4;
using DVec3 = glm::dvec3;

inline constexpr float kPi = std::numbers::pi_v<float>;
inline constexpr float kInvPi = std::numbers::inv_pi_v<float>;

/// Rec.709 luminance of a scene-linear colour.
inline float luminance(const Vec3& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

inline float max_component(const Vec3& v) { return std::max(v.x, std::max(v.y, v.z)); }

inline bool is_finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// v scaled to length 1, or fallback where v is too short to have a direction.
inline Vec3 normalize_or(const Vec3& v, const Vec3& fallback) {
    const float length2 = glm::dot(v, v);
    return length2 > 1e-30f && std::isfinite(length2) ? v / std::sqrt(length2) : fallback;
}

/// Sine of the angle between two unit vectors; 1 from a right angle on.
inline float sine_between(const Vec3& a, const Vec3& b) {
    return glm::dot(a, b) > 0.0f ? std::min(1.0f, glm::length(glm::cross(a, b))) : 1.0f;
}

/// Orthonormal frame; local z is the shading normal.
struct Frame {
    Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

    Vec3 to_world(const Vec3& v) const { return v.x * x + v.y * y + v.z * z; }
    Vec3 to_local(const Vec3& v) const { return {glm::dot(v, x), glm::dot(v, y), glm::dot(v, z)}; }
};

/// Any tangent pair for a unit normal (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
inline Frame frame_from_normal(const Vec3& n) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    return {{1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}

/// Frame whose x follows the direction tangent, orthogonalised against n; handedness +-1 turns y.
inline Frame frame_from_tangent(const Vec3& n, const Vec3& tangent, float handedness) {
    const Vec3 t = tangent - n * glm::dot(n, tangent);
    const float length2 = glm::dot(t, t);
    if (!(length2 > 1e-20f * glm::dot(tangent, tangent)) || !std::isfinite(length2)) return frame_from_normal(n);
    const Vec3 x = t / std::sqrt(length2);
    return {x, glm::cross(n, x) * handedness, n};
}

/// Row-major 3x4 affine transform in double precision, as the ABI passes it.
struct Affine {
    double m[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

    DVec3 point(const DVec3& p) const {
        return {m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3], m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
                m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]};
    }
    DVec3 column(int i) const { return {m[i], m[4 + i], m[8 + i]}; }
    double determinant() const { return glm::dot(column(0), glm::cross(column(1), column(2))); }
    /// Direction of a normal under the transform: the cofactor matrix, which unlike the inverse
    /// transpose exists for flattened objects too. Sign follows the mirrored winding.
    DVec3 normal(const DVec3& n) const {
        const DVec3 a = column(0), b = column(1), c = column(2);
        return glm::cross(b, c) * n.x + glm::cross(c, a) * n.y + glm::cross(a, b) * n.z;
    }
};

} // namespace ajar
