// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>

#include "base/lanes.h"
#include "base/math.h"
#include "scene/snapshot.h"

namespace ajar {

inline constexpr uint32_t kMiss = 0xffffffffu;

/// Eight rays and their hits, laid out as the tracer wants them. Set origin, direction, tnear,
/// tfar, mask; after intersect, triangle is kMiss or a triangle of the snapshot.
struct alignas(32) RayPacket {
    float ox[kLanes], oy[kLanes], oz[kLanes], tnear[kLanes];
    float dx[kLanes], dy[kLanes], dz[kLanes], time[kLanes];
    float tfar[kLanes];
    uint32_t mask[kLanes], id[kLanes], flags[kLanes];
    float nx[kLanes], ny[kLanes], nz[kLanes]; ///< cross product of the hit triangle's edges
    float u[kLanes], v[kLanes];
    uint32_t triangle[kLanes], group[kLanes], instance[kLanes];

    void set(uint32_t lane, const Vec3& origin, const Vec3& direction, float far_end) {
        ox[lane] = origin.x, oy[lane] = origin.y, oz[lane] = origin.z;
        dx[lane] = direction.x, dy[lane] = direction.y, dz[lane] = direction.z;
        tfar[lane] = far_end;
    }
    Vec3 direction(uint32_t lane) const { return {dx[lane], dy[lane], dz[lane]}; }
    Vec3 normal(uint32_t lane) const { return {nx[lane], ny[lane], nz[lane]}; }
    /// Makes every lane usable with the given mask; unset lanes must be turned off by valid.
    void prepare(uint32_t ray_mask);
};

struct Ray {
    Vec3 origin{0.0f};
    Vec3 direction{0.0f};
    float tnear = 0.0f;
    float tfar = std::numeric_limits<float>::infinity();
};

struct Hit {
    uint32_t triangle = kMiss;
    float u = 0.0f, v = 0.0f, t = 0.0f;
    bool back = false; ///< the ray arrives from behind the surface
};

} // namespace ajar
