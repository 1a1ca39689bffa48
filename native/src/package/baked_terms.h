// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "package/baked_pages.h"
#include "post/stitch.h"

namespace ajar {

/// The terms of a bake as lists of texels: seams stitched where solver is not null, directions
/// fitted, texels that are not usable left out, texels filled from a neighbour given its light.
/// usable and source cover all page texels; source as nearest_known gives it.
std::vector<BakedTerm> make_terms(const Snapshot& scene, const LightmapReceivers& receivers, const TermResult& terms, const std::vector<uint8_t>& usable,
                                  const std::vector<uint32_t>& source, const SeamSolver* solver, ThreadPool& pool, Progress& progress);

} // namespace ajar
