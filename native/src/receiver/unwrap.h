// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "receiver/unwrap_graph.h"

namespace ajar {

/// One piece of surface, flat in the lightmap.
struct Chart {
    std::vector<uint32_t> polygons;
    glm::dvec2 size{0.0}; ///< texels; corner UVs of the chart lie in [0, size]
    double area = 0.0;    ///< surface area, square texels
};

struct Unwrapped {
    std::vector<Chart> charts;
    std::vector<glm::dvec2> corner_uv;   ///< per corner, texels inside its chart
    std::vector<uint32_t> polygon_chart; ///< per polygon; kNoChart for polygons without area
    uint32_t degenerate_polygons = 0;    ///< no area, no chart of their own
    uint32_t broken_polygons = 0;        ///< NaN or infinite positions
    uint32_t overlap_splits = 0;         ///< charts cut because they covered themselves
    uint32_t kept_overlaps = 0;          ///< kept islands that covered others or themselves
    uint32_t kept_outside = 0;           ///< kept islands that left [0,1]
    uint32_t kept_collapsed = 0;         ///< polygons whose kept UVs have no area; unwrapped anew

    static constexpr uint32_t kNoChart = 0xffffffffu;
};

/// Cuts the mesh into charts and flattens them, or takes them from mesh.corner_uv and rescales
/// every island to one texel per texel of surface on average.
/// chart_angle in radians; max_extent in texels.
Unwrapped unwrap(const UnwrapMesh& mesh, double chart_angle, double max_extent);

} // namespace ajar
