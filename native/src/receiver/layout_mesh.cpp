// SPDX-License-Identifier: GPL-3.0-or-later
#include "receiver/layout_mesh.h"

#include <algorithm>
#include <cmath>

namespace ajar {
namespace {

constexpr double kRounding = 0.01;   ///< texels a piece may exceed a whole number and be squeezed
constexpr double kLeastTexels = 0.5; ///< smallest width of a chart, texels

[[noreturn]] void refuse(ajar_result code, const LayoutMesh& mesh, const std::string& what) {
    throw Error(code, "Lightmap layout of mesh \"" + mesh.name + "\": " + what, mesh.name);
}

void check_pointers(const ajar_layout_mesh_desc& desc, const LayoutMesh& mesh) {
    const bool corners = desc.corner_count == 0 || desc.corner_vertex;
    const bool polygons = desc.polygon_count == 0 || (desc.polygon_start && desc.polygon_size);
    if ((desc.vertex_count && !desc.positions) || !corners || !polygons)
        refuse(AJAR_ERROR_ARGUMENT, mesh, "a required array is NULL");
    if (desc.user_count == 0 || !desc.user_transforms)
        refuse(AJAR_ERROR_ARGUMENT, mesh, "it needs at least one user with a transform");
}

void check_indices(const LayoutMesh& mesh) {
    const size_t vertices = mesh.positions.size() / 3, corners = mesh.corner_vertex.size();
    for (uint32_t v : mesh.corner_vertex)
        if (v >= vertices)
            refuse(AJAR_ERROR_INPUT, mesh, "a corner names vertex " + std::to_string(v) + ", which does not exist");
    for (size_t p = 0; p < mesh.polygon_start.size(); ++p) {
        const uint64_t end = uint64_t(mesh.polygon_start[p]) + mesh.polygon_size[p];
        if (mesh.polygon_size[p] < 3 || end > corners)
            refuse(AJAR_ERROR_INPUT, mesh, "polygon " + std::to_string(p) + " has a bad corner range");
    }
}

void copy_users(const ajar_layout_mesh_desc& desc, LayoutMesh& mesh) {
    for (uint32_t u = 0; u < desc.user_count; ++u) {
        LayoutMesh::User user;
        std::copy_n(desc.user_transforms + size_t(u) * 12, 12, user.transform.m);
        for (double value : user.transform.m)
            if (!std::isfinite(value)) refuse(AJAR_ERROR_INPUT, mesh, "a user's transform is not finite");
        if (desc.user_texel_scale) user.texel_scale = desc.user_texel_scale[u];
        if (!(user.texel_scale > 0.0) || !std::isfinite(user.texel_scale))
            refuse(AJAR_ERROR_ARGUMENT, mesh, "a user's texel scale is not a positive number");
        mesh.users.push_back(user);
    }
}

DVec3 linear(const Affine& a, const DVec3& p) { return a.column(0) * p.x + a.column(1) * p.y + a.column(2) * p.z; }

DVec3 position(const LayoutMesh& mesh, uint32_t vertex) {
    const float* p = mesh.positions.data() + 3 * size_t(vertex);
    return {p[0], p[1], p[2]};
}

/// Surface in world space, square metres; polygons with broken positions count nothing.
double world_area(const LayoutMesh& mesh, const Affine& transform) {
    double sum = 0.0;
    for (size_t p = 0; p < mesh.polygon_start.size(); ++p) {
        const uint32_t* corner = mesh.corner_vertex.data() + mesh.polygon_start[p];
        const DVec3 origin = linear(transform, position(mesh, corner[0]));
        DVec3 normal(0.0), last(0.0);
        for (uint32_t i = 1; i < mesh.polygon_size[p]; ++i) {
            const DVec3 edge = linear(transform, position(mesh, corner[i])) - origin;
            normal += glm::cross(last, edge);
            last = edge;
        }
        const double area = 0.5 * glm::length(normal);
        if (std::isfinite(area)) sum += area;
    }
    return sum;
}

/// True if both transforms stretch a mesh alike (they may turn and move it differently).
bool same_stretch(const Affine& a, const Affine& b) {
    for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j) {
            const double x = glm::dot(a.column(i), a.column(j)), y = glm::dot(b.column(i), b.column(j));
            const double size = glm::length(a.column(i)) * glm::length(a.column(j));
            if (std::abs(x - y) > 1e-6 * size) return false;
        }
    return true;
}

std::vector<double> user_areas(const LayoutMesh& mesh) {
    std::vector<double> areas;
    for (size_t u = 0; u < mesh.users.size(); ++u) {
        const bool known = u > 0 && same_stretch(mesh.users[u].transform, mesh.users[u - 1].transform);
        areas.push_back(known ? areas.back() : world_area(mesh, mesh.users[u].transform));
    }
    return areas;
}

} // namespace

LayoutMesh copy_layout_mesh(const ajar_layout_mesh_desc& desc) {
    LayoutMesh mesh;
    mesh.name = desc.name ? desc.name : "";
    check_pointers(desc, mesh);
    mesh.positions.assign(desc.positions, desc.positions + size_t(desc.vertex_count) * 3);
    mesh.corner_vertex.assign(desc.corner_vertex, desc.corner_vertex + desc.corner_count);
    mesh.polygon_start.assign(desc.polygon_start, desc.polygon_start + desc.polygon_count);
    mesh.polygon_size.assign(desc.polygon_size, desc.polygon_size + desc.polygon_count);
    if (desc.corner_edge_sharp)
        mesh.corner_edge_sharp.assign(desc.corner_edge_sharp, desc.corner_edge_sharp + desc.corner_count);
    if (desc.corner_uv) mesh.corner_uv.assign(desc.corner_uv, desc.corner_uv + size_t(desc.corner_count) * 2);
    check_indices(mesh);
    copy_users(desc, mesh);
    return mesh;
}

UnwrappedMesh unwrap_mesh(const LayoutMesh& mesh, double texels_per_meter, double chart_angle, double max_extent) {
    const std::vector<double> areas = user_areas(mesh);
    std::vector<double> texels;
    for (size_t u = 0; u < areas.size(); ++u) texels.push_back(std::sqrt(areas[u]) * mesh.users[u].texel_scale);
    const size_t lead = size_t(std::max_element(texels.begin(), texels.end()) - texels.begin());

    UnwrapMesh input;
    const double density = texels_per_meter * mesh.users[lead].texel_scale;
    for (uint32_t v = 0; v < mesh.positions.size() / 3; ++v)
        input.positions.push_back(linear(mesh.users[lead].transform, position(mesh, v)) * density);
    input.corner_vertex = mesh.corner_vertex;
    input.polygon_start = mesh.polygon_start;
    input.polygon_size = mesh.polygon_size;
    input.corner_edge_sharp = mesh.corner_edge_sharp;
    input.corner_uv = mesh.corner_uv;

    UnwrappedMesh result{unwrap(input, chart_angle, max_extent), {}};
    for (double own : texels)
        result.user_factor.push_back(texels[lead] > 0.0 ? std::max(own / texels[lead], 1e-3) : 1.0);
    return result;
}

void report_unwrap(const LayoutMesh& mesh, const Unwrapped& result, std::vector<Warning>& warnings) {
    const auto tell = [&](uint32_t count, const char* text) {
        if (count > 0) warnings.push_back({mesh.name, std::to_string(count) + text});
    };
    tell(result.broken_polygons, " polygon(s) have NaN or infinite vertices and get no lightmap texels of their own");
    tell(result.degenerate_polygons, " polygon(s) without area get no lightmap texels of their own");
    tell(result.kept_overlaps,
         " kept lightmap UV island(s) overlap; islands were packed apart, but an island that "
         "covers itself still shares texels");
    tell(result.kept_outside, " kept lightmap UV island(s) left the 0-1 square and were packed into it");
    tell(result.kept_collapsed, " polygon(s) have no area in the kept lightmap UVs and were unwrapped anew");
}

TexelFit::TexelFit(const glm::dvec2& size, double density_factor) {
    int cells[2];
    for (int axis = 0; axis < 2; ++axis) {
        const double wanted = size[axis] * density_factor;
        cells[axis] = std::max(1, int(std::ceil(wanted - kRounding)));
        const double used = std::clamp(wanted, kLeastTexels, double(cells[axis]));
        scale[axis] = size[axis] > 1e-9 ? used / size[axis] : 0.0;
        offset[axis] = 0.5 * (cells[axis] - size[axis] * scale[axis]);
    }
    width = cells[0];
    height = cells[1];
}

glm::dvec2 on_page(const Placement& at, int height, const glm::dvec2& point) {
    const glm::dvec2 corner(at.x, at.y);
    return corner + (at.turned ? glm::dvec2(height - point.y, point.x) : point);
}

} // namespace ajar
