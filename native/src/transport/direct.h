// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "transport/gather.h"

namespace ajar {

/// How gather rays and emitter samples share what both can find: balance heuristic with the
/// number of samples of each (Veach 1995, multi-sample model).
struct MisCounts {
    float gather = 0.0f;            ///< rays per receiver with density hemisphere_pdf
    float share = 1.0f;             ///< cosine share of that density
    const TileAims* aims = nullptr; ///< further rays
};

/// Next-event estimation of a tile with one group of emitters: group.samples emitter samples per
/// receiver of the chosen packets are added to sums, which hold totals over samples. Returns the rays traced.
uint64_t sample_direct(const GatherScene& scene, const DirectGroups::Group& group, const Tile& tile,
                       const MisCounts& mis, uint32_t seed, PacketChoice packets, TileSums& sums);

/// The same for scenes with elements and all groups: sums hold the mean over each group's samples.
/// rows: light of bright texels, null if there are none. thrifty: receivers at which the first samples
/// of a set found nothing go on with its others in one of four cases, which then count four times.
uint64_t sample_direct(const GatherScene& scene, const DirectGroups& groups, const Tile& tile, const MisCounts& mis,
                       uint32_t seed, bool thrifty, const TermRows* rows, const TermLimits& limits, TermSums& sums);

} // namespace ajar
