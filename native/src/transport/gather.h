// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "transport/direct.h"
#include "transport/surface_table.h"

namespace ajar {

/// The scene with everything the gather looks up, shared by all tiles and threads.
struct GatherScene {
    const Snapshot& scene;
    const Tracer& tracer;
    const SurfaceTable& surfaces;
    const EmitterSet& emitters;
    const LightmapReceivers& receivers;
};

/// What one gather collects.
struct GatherOptions {
    uint32_t samples = 64;       ///< rays per receiver, a power of two
    float share = 1.0f;          ///< cosine share of the ray density; 1 for irradiance alone
    const Vec4* radiance = nullptr; ///< [page texels] outgoing radiance of the surfaces; null: none
    bool emission = false;       ///< count what emissive surfaces and the sky send directly
    bool unmapped_direct = false; ///< surfaces without lightmap reflect their direct light too
    uint32_t direct_samples = 0; ///< emitter samples that share the emission by MIS
    const LightChoice* choice = nullptr; ///< needed where direct_samples > 0
    uint32_t first_sample = 0;   ///< of the receiver's sequence, a multiple of samples
    uint32_t seed = 0;
};

/// Shoots options.samples rays from every receiver of a tile, eight receivers at a time and
/// stratum by stratum so that rays of a packet stay together (algorithms.md 5.5), and adds what
/// they meet to sums. Receivers count as lanes of the tile. Returns the rays traced.
uint64_t gather_tile(const GatherScene& scene, const Tile& tile, const GatherOptions& options, TileSums& sums);

} // namespace ajar
