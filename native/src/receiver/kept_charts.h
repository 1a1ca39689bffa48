// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "receiver/unwrap.h"

namespace ajar {

/// Takes the islands of mesh.corner_uv as charts, scaled to the surface's size in texels, and counts
/// overlaps and islands outside [0,1]. Polygons that the UVs collapse keep kNoChart.
void keep_islands(const UnwrapMesh& mesh, const FaceGraph& graph, Unwrapped& result);

} // namespace ajar
