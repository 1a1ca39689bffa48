// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "reference/lights.h"

namespace ajar {

/// Where light leaves the lightmapped side of a triangle: on the smooth surface that its normals
/// describe (Hanika 2021), off the surface far enough for rays to start there.
Vertex front_vertex(const World& world, uint32_t triangle, float u, float v);

/// The same at a hit of the back or of a surface without lightmap: on the triangle itself, with the normals of the side
/// that the ray met.
Vertex unmapped_vertex(const World& world, const Hit& hit);

} // namespace ajar
