// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "accel/ray.h"

namespace ajar {

/// Directions of a packet's samples in its receivers' frames, z up, and what each sample's radiance
/// counts: the inverse of its density, sr.
struct alignas(32) PacketDirections {
    float x[kLanes], y[kLanes], z[kLanes], weight[kLanes];

    void set(uint32_t lane, const Vec3& w, float scale) {
        x[lane] = w.x, y[lane] = w.y, z[lane] = w.z, weight[lane] = scale;
    }
    Vec3 at(uint32_t lane) const { return {x[lane], y[lane], z[lane]}; }
};

} // namespace ajar
