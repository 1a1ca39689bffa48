// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace ajar {

/// Polygons of one mesh, positions in texels (world metres times texels per metre) so that every
/// tolerance below is a fraction of a texel. Spans stay owned by the caller.
struct UnwrapMesh {
    std::vector<glm::dvec3> positions;
    std::span<const uint32_t> corner_vertex;
    std::span<const uint32_t> polygon_start;
    std::span<const uint32_t> polygon_size;
    std::span<const uint8_t> corner_edge_sharp; ///< empty: no sharp edges
    std::span<const float> corner_uv;           ///< [2 * corners] charts to keep, empty: unwrap

    uint32_t polygon_count() const { return uint32_t(polygon_start.size()); }
    const glm::dvec3& corner(uint32_t index) const { return positions[corner_vertex[index]]; }
};

/// What chart growing needs to know of a polygon. Areas in square texels.
struct UnwrapFace {
    glm::dvec3 normal{0.0}; ///< unit, Newell; 0 if the polygon has no area
    double area = 0.0;
    double thickness = 0.0; ///< area / longest edge, texels
    bool finite = false;    ///< all corners are finite
};

/// A neighbour across a shared edge or a shared part of an edge (T-junction).
struct FaceLink {
    uint32_t face;
    double length; ///< texels
    bool sharp;
};

/// Faces and their neighbours: vertices are welded by position, so unshared edges join too.
class FaceGraph {
public:
    explicit FaceGraph(const UnwrapMesh& mesh);

    const std::vector<UnwrapFace>& faces() const { return faces_; }
    std::span<const FaceLink> links(uint32_t face) const {
        return {links_.data() + link_start_[face], links_.data() + link_start_[face + 1]};
    }

private:
    std::vector<UnwrapFace> faces_;
    std::vector<uint32_t> link_start_;
    std::vector<FaceLink> links_;
};

} // namespace ajar
