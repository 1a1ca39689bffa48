// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ajar/ajar.h"
#include "base/error.h"
#include "base/math.h"
#include "receiver/chart_pack.h"
#include "receiver/unwrap.h"

namespace ajar {

/// Checked copy of an ajar_layout_mesh_desc.
struct LayoutMesh {
    struct User {
        Affine transform;
        double texel_scale = 1.0;
    };
    std::string name;
    std::vector<float> positions; ///< [vertices][3], local space, metres
    std::vector<uint32_t> corner_vertex, polygon_start, polygon_size;
    std::vector<uint8_t> corner_edge_sharp;
    std::vector<float> corner_uv;
    std::vector<User> users;
};

/// Copies desc or throws Error naming what is wrong with it.
LayoutMesh copy_layout_mesh(const ajar_layout_mesh_desc& desc);

/// A mesh cut into charts at the density its most demanding user wants.
struct UnwrappedMesh {
    Unwrapped charts;
    std::vector<double> user_factor; ///< texels of a user per texel of `charts`, linear
};

/// Unwraps in the world space of the user that covers the most texels.
UnwrappedMesh unwrap_mesh(const LayoutMesh& mesh, double texels_per_meter, double chart_angle, double max_extent);
/// Appends what unwrapping had to work around.
void report_unwrap(const LayoutMesh& mesh, const Unwrapped& result, std::vector<Warning>& warnings);

/// How a piece with real-valued size sits in whole texels: texel = uv * scale + offset. Centred, at
/// least half a texel wide, so that bilinear filtering reads mostly the piece's own texels.
struct TexelFit {
    int width = 1, height = 1; ///< texels
    glm::dvec2 scale{1.0}, offset{0.0};

    TexelFit() = default;
    TexelFit(const glm::dvec2& size, double density_factor);
    glm::dvec2 apply(const glm::dvec2& uv) const { return uv * scale + offset; }
};

/// Position of a point of an item's own texel rectangle (width x height) on the page, in texels.
glm::dvec2 on_page(const Placement& at, int height, const glm::dvec2& point);

} // namespace ajar
