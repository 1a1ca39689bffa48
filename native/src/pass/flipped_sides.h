// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "accel/solids.h"
#include "base/parallel.h"

namespace ajar {

/// Objects whose normals look flipped, as one warning each (many: one for the rest), the largest areas first.
///
/// Measured is what the hemisphere of a surface ends on, weighted by the cosine, on its front and on its back;
/// never how bright that is. Blind is the share that ends inside a solid, on an opaque surface within reach (a
/// quarter of the surface's width, half a metre at most), or that leaves the scene downwards: nobody can
/// stand there. A connected part of a mesh looks flipped if its front is blind for two fifths or more and its back sees
/// into the open: a picture whose front is a finger's breadth from the wall, a floor that faces the ground under it, a
/// room in the void whose normals point out of it.
///
/// No light is needed; an unlit sky is nothing to look at. The same for any number of threads. Throws Cancelled.
/// behind: of find_solids().
std::vector<Warning> find_flipped_sides(const Snapshot& scene, const Tracer& tracer, const std::vector<Behind>& behind,
                                        ThreadPool& pool, Progress& progress);

} // namespace ajar
