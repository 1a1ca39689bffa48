// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sampling/direct_groups.h"
#include "transport/lamp_spots.h"
#include "transport/packet_choice.h"
#include "transport/surface_table.h"
#include "transport/term_sums.h"
#include "transport/tile_aims.h"
#include "transport/tile_sums.h"

namespace ajar {

/// The scene with everything the gather looks up, shared by all tiles and threads.
struct GatherScene {
    const Snapshot& scene;
    const Tracer& tracer;
    const SurfaceTable& surfaces;
    const EmitterSet& emitters;
    const LightmapReceivers& receivers;
    const Progress& progress;
    const LampSpots* spots = nullptr; ///< of surfaces without lightmap; null: none are aimed at
};

/// What one gather collects.
struct GatherOptions {
    uint32_t samples = 64;                ///< rays per receiver: a power of two, or a multiple of 256
    float share = 1.0f;                   ///< cosine share of the ray density; 1 for irradiance alone
    bool emission = false;                ///< count what emissive surfaces and the sky send directly
    bool unmapped_direct = false;         ///< surfaces without lightmap reflect their direct light too
    const DirectGroups* direct = nullptr; ///< emitter samples that share the emission by MIS
    const TileAims* aims = nullptr;       ///< boxes that further rays are aimed at, sharing by MIS
    PacketChoice packets = {};            ///< that shoot
    uint32_t first_sample = 0;            ///< of the receiver's sequence, a multiple of samples
    uint32_t seed = 0;
};

/// Page texel to read for a hit at p on a texel that a wall cuts: the nearest one around it whose
/// receiver p can see.
uint32_t texel_on_side(const GatherScene& scene, uint32_t triangle, uint32_t texel, const Vec3& p);

/// Shoots options.samples rays from every receiver of a tile, eight receivers at a time and
/// stratum by stratum so that rays of a packet stay together (algorithms.md 5.5), and adds what
/// they meet to sums. Receivers count as lanes of the tile. Returns the rays traced.
/// radiance: [page texels] outgoing radiance of the surfaces, w = TexelFlag bits; null: none.
uint64_t gather_tile(const GatherScene& scene, const Tile& tile, const GatherOptions& options, const Vec4* radiance,
                     TileSums& sums);

/// Which terms a pass keeps.
struct TermLimits {
    uint32_t order = 3; ///< most elements of a term
};

/// The same for scenes with elements: rows holds each texel's radiance per term (null: none), sums
/// collects per term.
uint64_t gather_tile(const GatherScene& scene, const Tile& tile, const GatherOptions& options, const TermRows* rows,
                     const TermLimits& limits, TermSums& sums);

} // namespace ajar
