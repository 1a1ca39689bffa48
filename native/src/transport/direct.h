// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sampling/light_choice.h"
#include "transport/tile_sums.h"

namespace ajar {

/// How gather rays and emitter samples share what both can find: balance heuristic with the
/// number of samples of each (Veach 1995, multi-sample model).
struct MisCounts {
    float gather = 0.0f; ///< rays per receiver with density hemisphere_pdf
    float share = 1.0f;  ///< cosine share of that density
    float direct = 0.0f; ///< emitter samples per receiver
};

/// Next-event estimation of a tile: samples emitters through choice and adds to sums, which
/// afterwards hold the total over samples (divide by samples). Returns the rays traced.
uint64_t sample_direct(const Snapshot& scene, const Tracer& tracer, const EmitterSet& emitters, const LightChoice& choice,
                       const LightmapReceivers& receivers, const Tile& tile, uint32_t samples, const MisCounts& mis, uint32_t seed, TileSums& sums);

/// Direct irradiance at any point by one emitter sample, for surfaces without receivers.
Vec3 direct_irradiance(const Tracer& tracer, const EmitterSet& emitters, const Vec3& p, const Vec3& n, uint32_t seed);

} // namespace ajar
