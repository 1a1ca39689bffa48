// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "receiver/lightmap.h"

namespace ajar {

/// Bilinear read of a page: four texels and their weights.
struct BilinearTap {
    std::array<uint32_t, 4> texel{};
    std::array<float, 4> weight{};
};

/// Two places of the lightmap that show the same point of a smooth surface.
struct SeamPoint {
    BilinearTap a, b;
};

/// Bilinear read at p, in texels of the page; clamped at its border.
BilinearTap bilinear_tap(const Page& page, const Vec2& p);

/// Samples every edge that is one in space, smooth across (normals within 10 degrees), but split
/// in the lightmap, inside and between objects (algorithms.md 9.5).
std::vector<SeamPoint> find_seams(const Snapshot& scene);

} // namespace ajar
