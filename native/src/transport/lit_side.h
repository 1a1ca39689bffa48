// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/parallel.h"
#include "scene/snapshot.h"

namespace ajar {

/// Finds the surfaces whose lightmap belongs on the side that their normals point away from: a
/// curved wall with turned faces, a room whose normals point out of it. A lightmap holds one side,
/// and artists see such a mistake nowhere but in the bake: renderers light both sides.
///
/// A connected patch of two-sided triangles is turned if its front looks at nothing that a player
/// could see from (into solids, or out of a closed room into nothing) and its back looks at fronts
/// of other surfaces or at lamps. Where both sides make sense the normals decide.
///
/// The same for any number of threads. Throws Cancelled.
SurfaceSides find_lit_sides(const Snapshot& scene, ThreadPool& pool, Progress& progress);

} // namespace ajar
