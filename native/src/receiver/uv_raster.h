// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "base/math.h"
#include "base/parallel.h"
#include "scene/snapshot.h"

namespace ajar {

/// Convex polygon in texel space; a triangle cut by a square has at most 7 corners.
struct TexelPolygon {
    std::array<Vec2, 10> corner;
    int count = 0;
    float area() const;
    /// Uniform point for two numbers in [0,1).
    Vec2 sample(Vec2 u) const;
};

/// The part of a triangle inside the axis-aligned box.
TexelPolygon clip_to_box(const std::array<Vec2, 3>& triangle, const Vec2& low, const Vec2& high);

/// A triangle's share of one texel.
struct Fragment {
    uint32_t texel;    ///< index over all pages, row-major from the bottom
    uint32_t triangle; ///< of the snapshot
    float area;        ///< clipped area in texels
    bool ring;         ///< does not touch the texel's square, only the tent that bilinear lookups read
};

/// Lightmap triangle in texels of its page.
std::array<Vec2, 3> texel_triangle(const Snapshot& scene, uint32_t triangle);

/// All fragments of lightmapped triangles, sorted by texel then triangle (algorithms.md 9.1):
/// every texel whose square meets a triangle, then those whose 2x2 tent does. Triangles without
/// area in UV space are skipped and counted by instance.
struct Coverage {
    std::vector<Fragment> fragments;
    std::vector<uint32_t> flat_uv_triangles; ///< per instance
    std::vector<uint32_t> outside_triangles; ///< per instance: leaves its page
};
Coverage rasterize(const Snapshot& scene, ThreadPool& pool, Progress& progress);

} // namespace ajar
