// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/parallel.h"
#include "reference/points.h"

namespace ajar {

inline constexpr uint32_t kBatchPaths = 64; ///< paths of a batch: one per cell of an 8 x 8 grid of first rays

struct ReferenceSettings {
    uint32_t points = 1000;
    uint32_t bounces = 6;
    uint32_t batches = 64;   ///< most of them
    float time_limit = 0.0f; ///< s; no batch starts after it but the first kLeastBatches; 0: none
    uint64_t seed = 0, point_seed = 0;
    bool by_texel = false;               ///< choose among texels, not by area
    bool whole_texels = false;           ///< mean over the texel, not the light at the place
    Vec3 normal{0, 0, 1};                ///< of the receiver, in the texel's tangent frame
    std::vector<float> weights;          ///< per element
    uint32_t door_bounces = kAnyBounces; ///< as of PathTracer
};

/// Irradiance at a chosen place with the spread of its batches.
struct ReferenceValue {
    ReferencePoint point;
    Vec3 irradiance{0.0f};       ///< W/m^2
    float standard_error = 0.0f; ///< of its luminance
};

struct ReferenceResult {
    std::vector<ReferenceValue> values;
    uint32_t batches = 0;
};

inline constexpr uint32_t kLeastBatches = 4; ///< fewer say too little of their spread

/// Brute force: an irradiance at random places from independent paths, with nothing stored between
/// them. Fewer places than asked for, or none, where hardly any surface is in the open. The same for any
/// number of threads unless the time limit ends it. Throws Cancelled.
ReferenceResult trace_reference(const Snapshot& scene, const Tracer& tracer, const ReferenceSettings& settings,
                                ThreadPool& pool, Progress& progress);

} // namespace ajar
