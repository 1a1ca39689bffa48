// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "scene/snapshot.h"

namespace ajar {

/// How the triangles of a mesh hang together, its vertices welded by position.
struct MeshPatches {
    std::vector<uint32_t> patch; ///< per triangle: those joined by edges that both run through in opposite directions
    uint32_t count = 0;
    bool closed = false; ///< every edge joins exactly two triangles of like orientation
};

/// least_cosine: of the angle between the normals of two triangles that hang together; -1: any.
MeshPatches find_patches(const Mesh& mesh, float least_cosine = -1.0f);

} // namespace ajar
