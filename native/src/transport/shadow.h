// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "accel/embree_scene.h"
#include "sampling/emitters.h"

namespace ajar {

/// Where a shadow ray ends: just before the emitter.
inline float shadow_end(const Tracer& tracer, const EmitterSample& s) {
    if (!std::isfinite(s.distance)) return s.distance;
    return std::max(0.0f, s.distance * (1.0f - 1e-5f) - 2.0f * tracer.offset_distance(s.target));
}

} // namespace ajar
