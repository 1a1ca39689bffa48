// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "receiver/unwrap_graph.h"

namespace ajar {

/// Polygons that are projected together along one axis without covering each other.
struct GrownChart {
    glm::dvec3 axis{0.0, 0.0, 1.0}; ///< unit projection axis
    std::vector<uint32_t> polygons;
};

struct GrowResult {
    std::vector<GrownChart> charts;
    uint32_t overlap_splits = 0; ///< charts cut because their projection covered itself
};

/// Grows charts over the polygons marked in `wanted`, largest first, while normals stay within
/// chart_angle (radians) of the chart's area-weighted axis. Sharp edges are crossed only between
/// coplanar polygons. A chart's extent stays below max_extent texels unless one polygon exceeds it.
/// Polygons too thin to have a reliable normal join a neighbour at the end.
GrowResult grow_charts(const UnwrapMesh& mesh, const FaceGraph& graph, const std::vector<uint8_t>& wanted,
                       double chart_angle, double max_extent);

/// Orthonormal u, v with u x v = axis.
void chart_frame(const glm::dvec3& axis, glm::dvec3& u, glm::dvec3& v);

} // namespace ajar
