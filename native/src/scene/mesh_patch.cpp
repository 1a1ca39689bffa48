// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/mesh_patch.h"

#include <bit>
#include <unordered_map>

#include "base/disjoint_set.h"
#include "base/hash.h"

namespace ajar {

namespace {

struct PositionHash {
    size_t operator()(const Vec3& p) const {
        return hash_combine(hash_combine(std::bit_cast<uint32_t>(p.x + 0.0f), std::bit_cast<uint32_t>(p.y + 0.0f)),
                            std::bit_cast<uint32_t>(p.z + 0.0f));
    }
};

/// Triangles that use an edge.
struct Edge {
    uint32_t along = 0, against = 0;                   ///< how many, by direction
    uint32_t triangle_along = 0, triangle_against = 0; ///< the last of them
};

std::vector<uint32_t> weld(const Mesh& mesh) {
    std::unordered_map<Vec3, uint32_t, PositionHash> first;
    std::vector<uint32_t> id(mesh.positions.size());
    for (size_t i = 0; i < id.size(); ++i)
        id[i] = first.try_emplace(mesh.positions[i], static_cast<uint32_t>(i)).first->second;
    return id;
}

std::unordered_map<uint64_t, Edge> find_edges(const Mesh& mesh) {
    const std::vector<uint32_t> id = weld(mesh);
    std::unordered_map<uint64_t, Edge> edges;
    for (size_t c = 0; c < mesh.corner_vertex.size(); ++c) {
        const uint32_t a = id[mesh.corner_vertex[c]], b = id[mesh.corner_vertex[c - c % 3 + (c + 1) % 3]];
        if (a == b) continue;
        Edge& e = edges[(uint64_t{std::min(a, b)} << 32) | std::max(a, b)];
        (a < b ? e.along : e.against) += 1;
        (a < b ? e.triangle_along : e.triangle_against) = static_cast<uint32_t>(c / 3);
    }
    return edges;
}

Vec3 normal_of(const Mesh& mesh, uint32_t triangle) {
    const uint32_t* v = &mesh.corner_vertex[size_t{triangle} * 3];
    const Vec3 a = mesh.positions[v[0]];
    return normalize_or(glm::cross(mesh.positions[v[1]] - a, mesh.positions[v[2]] - a), Vec3(0.0f));
}

} // namespace

MeshPatches find_patches(const Mesh& mesh, float least_cosine) {
    DisjointSet patches(mesh.triangle_count());
    MeshPatches out;
    out.closed = mesh.triangle_count() != 0;
    bool any = false;
    for (const auto& [key, e] : find_edges(mesh)) {
        any = true;
        const bool joins = e.along == 1 && e.against == 1;
        out.closed = out.closed && joins;
        if (!joins) continue;
        if (least_cosine > -1.0f &&
            glm::dot(normal_of(mesh, e.triangle_along), normal_of(mesh, e.triangle_against)) < least_cosine)
            continue;
        patches.join(e.triangle_along, e.triangle_against);
    }
    out.closed = out.closed && any;
    // The smallest triangle is the root, whatever the order of edges: numbers are reproducible.
    out.patch.resize(mesh.triangle_count());
    for (uint32_t t = 0; t < out.patch.size(); ++t) {
        const uint32_t r = patches.root(t);
        out.patch[t] = r == t ? out.count++ : out.patch[r];
    }
    return out;
}

} // namespace ajar
