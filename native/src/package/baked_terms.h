// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "package/baked_pages.h"
#include "post/stitch.h"

namespace ajar {

/// The terms of a bake as lists of texels: seams stitched where solver is not null, directions
/// fitted, texels that are not usable left out. usable covers all page texels.
std::vector<BakedTerm> make_terms(const LightmapReceivers& receivers, const TermResult& terms,
                                  const std::vector<uint8_t>& usable, const SeamSolver* solver, ThreadPool& pool,
                                  Progress& progress);

} // namespace ajar
