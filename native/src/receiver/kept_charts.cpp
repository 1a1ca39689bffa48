// SPDX-License-Identifier: GPL-3.0-or-later
#include "receiver/kept_charts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/disjoint_set.h"
#include "receiver/bit_rows.h"

namespace ajar {
namespace {

constexpr double kSameUv = 1e-6;
constexpr int kOverlapGrid = 1024; ///< samples per UV unit of the overlap test

glm::dvec2 kept_uv(const UnwrapMesh& mesh, uint32_t corner) {
    return {mesh.corner_uv[2 * size_t(corner)], mesh.corner_uv[2 * size_t(corner) + 1]};
}

double polygon_uv_area(const UnwrapMesh& mesh, uint32_t polygon) {
    const uint32_t start = mesh.polygon_start[polygon], size = mesh.polygon_size[polygon];
    double twice = 0.0;
    for (uint32_t i = 0; i < size; ++i) {
        const glm::dvec2 p = kept_uv(mesh, start + i), q = kept_uv(mesh, start + (i + 1) % size);
        twice += p.x * q.y - p.y * q.x;
    }
    return 0.5 * twice;
}

/// An edge of a polygon in UV space, ends in a fixed order.
struct UvEdge {
    glm::dvec2 a, b;
    uint32_t vertex_a, vertex_b, polygon;

    bool joins(const UvEdge& o) const {
        const auto same = [](const glm::dvec2& p, const glm::dvec2& q) {
            return std::abs(p.x - q.x) <= kSameUv && std::abs(p.y - q.y) <= kSameUv;
        };
        return same(a, o.a) && same(b, o.b);
    }
};

/// Joins polygons whose shared mesh edge is one edge in UV space too.
DisjointSet connect(const UnwrapMesh& mesh, const std::vector<uint8_t>& usable) {
    std::vector<UvEdge> edges;
    for (uint32_t f = 0; f < mesh.polygon_count(); ++f) {
        if (!usable[f]) continue;
        const uint32_t start = mesh.polygon_start[f], size = mesh.polygon_size[f];
        for (uint32_t i = 0; i < size; ++i) {
            const uint32_t c = start + i, d = start + (i + 1) % size;
            UvEdge edge{kept_uv(mesh, c), kept_uv(mesh, d), mesh.corner_vertex[c], mesh.corner_vertex[d], f};
            if (edge.vertex_a > edge.vertex_b) {
                std::swap(edge.a, edge.b);
                std::swap(edge.vertex_a, edge.vertex_b);
            }
            edges.push_back(edge);
        }
    }
    std::stable_sort(edges.begin(), edges.end(), [](const UvEdge& x, const UvEdge& y) {
        return x.vertex_a != y.vertex_a ? x.vertex_a < y.vertex_a : x.vertex_b < y.vertex_b;
    });
    DisjointSet set(mesh.polygon_count());
    for (size_t i = 0; i < edges.size(); ++i)
        for (size_t j = i + 1;
             j < edges.size() && edges[j].vertex_a == edges[i].vertex_a && edges[j].vertex_b == edges[i].vertex_b; ++j)
            if (edges[i].joins(edges[j])) set.join(edges[i].polygon, edges[j].polygon);
    return set;
}

/// Samples covered so far, over all islands; repeated cells beyond [0,1] are not looked at.
bool covers_again(const UnwrapMesh& mesh, const Chart& chart, BitRows& covered) {
    std::vector<glm::dvec2> polygon;
    std::vector<SampleSpan> spans;
    bool again = false;
    for (uint32_t f : chart.polygons) {
        polygon.clear();
        for (uint32_t i = 0; i < mesh.polygon_size[f]; ++i)
            polygon.push_back(kept_uv(mesh, mesh.polygon_start[f] + i) * double(kOverlapGrid));
        polygon_spans(polygon, kOverlapGrid, kOverlapGrid, spans);
        for (const SampleSpan& s : spans) {
            for (int x = s.begin + 1; x + 1 < s.end && !again; ++x) again = covered.get(x, s.y);
            covered.set_span(s.y, s.begin, s.end);
        }
    }
    return again;
}

void scale_island(const UnwrapMesh& mesh, Chart& chart, double uv_area, Unwrapped& result) {
    const double scale = std::sqrt(chart.area / uv_area);
    glm::dvec2 low(std::numeric_limits<double>::max()), high(-low);
    const auto each_corner = [&](auto&& body) {
        for (uint32_t f : chart.polygons)
            for (uint32_t i = 0; i < mesh.polygon_size[f]; ++i) body(mesh.polygon_start[f] + i);
    };
    each_corner([&](uint32_t c) {
        low = glm::min(low, kept_uv(mesh, c));
        high = glm::max(high, kept_uv(mesh, c));
    });
    if (low.x < -1e-4 || low.y < -1e-4 || high.x > 1.0 + 1e-4 || high.y > 1.0 + 1e-4) ++result.kept_outside;
    each_corner([&](uint32_t c) { result.corner_uv[c] = (kept_uv(mesh, c) - low) * scale; });
    chart.size = (high - low) * scale;
}

} // namespace

void keep_islands(const UnwrapMesh& mesh, const FaceGraph& graph, Unwrapped& result) {
    const uint32_t count = mesh.polygon_count();
    std::vector<uint8_t> usable(count, 0);
    std::vector<double> uv_area(count, 0.0);
    for (uint32_t f = 0; f < count; ++f) {
        const UnwrapFace& face = graph.faces()[f];
        uv_area[f] = std::abs(polygon_uv_area(mesh, f));
        usable[f] = face.finite && face.area > 0.0 && uv_area[f] > 1e-14 && std::isfinite(uv_area[f]);
        if (face.thickness > 0.01 && !usable[f]) ++result.kept_collapsed;
    }
    DisjointSet set = connect(mesh, usable);
    std::vector<uint32_t> chart_of_root(count, Unwrapped::kNoChart);
    std::vector<double> island_uv_area;
    for (uint32_t f = 0; f < count; ++f) {
        if (!usable[f]) continue;
        uint32_t& chart = chart_of_root[set.root(f)];
        if (chart == Unwrapped::kNoChart) {
            chart = uint32_t(result.charts.size());
            result.charts.emplace_back();
            island_uv_area.push_back(0.0);
        }
        result.charts[chart].polygons.push_back(f);
        result.charts[chart].area += graph.faces()[f].area;
        island_uv_area[chart] += uv_area[f];
        result.polygon_chart[f] = chart;
    }
    BitRows covered(kOverlapGrid, kOverlapGrid);
    for (size_t c = 0; c < result.charts.size(); ++c) {
        if (covers_again(mesh, result.charts[c], covered)) ++result.kept_overlaps;
        scale_island(mesh, result.charts[c], island_uv_area[c], result);
    }
}

} // namespace ajar
