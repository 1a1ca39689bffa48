// SPDX-License-Identifier: GPL-3.0-or-later
#include "receiver/unwrap.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "receiver/chart_grow.h"
#include "receiver/flatten.h"
#include "receiver/kept_charts.h"

namespace ajar {
namespace {

double signed_area(const std::vector<glm::dvec2>& uv, uint32_t start, uint32_t size) {
    double twice = 0.0;
    for (uint32_t i = 0; i < size; ++i) {
        const glm::dvec2 &p = uv[start + i], &q = uv[start + (i + 1) % size];
        twice += p.x * q.y - p.y * q.x;
    }
    return 0.5 * twice;
}

/// Projects a grown chart along its axis, turns it into its best rectangle and scales it to its
/// surface area.
class ChartFlattener {
public:
    ChartFlattener(const UnwrapMesh& mesh, const FaceGraph& graph, Unwrapped& result)
        : mesh_(mesh), graph_(graph), result_(result) {}

    void flatten(const GrownChart& grown) {
        Chart chart;
        chart.polygons = grown.polygons;
        project(grown);
        double flat_area = 0.0;
        for (uint32_t f : grown.polygons) {
            chart.area += graph_.faces()[f].area;
            flat_area += std::abs(signed_area(result_.corner_uv, mesh_.polygon_start[f], mesh_.polygon_size[f]));
        }
        const double scale = flat_area > 0.0 ? std::sqrt(chart.area / flat_area) : 1.0;
        turn(chart, std::clamp(scale, 1.0, 2.0));
        for (uint32_t f : grown.polygons) result_.polygon_chart[f] = uint32_t(result_.charts.size());
        result_.charts.push_back(std::move(chart));
    }

private:
    template <typename Body>
    void each_corner(const std::vector<uint32_t>& polygons, Body&& body) const {
        for (uint32_t f : polygons)
            for (uint32_t i = 0; i < mesh_.polygon_size[f]; ++i) body(mesh_.polygon_start[f] + i);
    }

    void project(const GrownChart& grown) {
        glm::dvec3 u, v;
        chart_frame(grown.axis, u, v);
        points_.clear();
        each_corner(grown.polygons, [&](uint32_t c) {
            const glm::dvec3& p = mesh_.corner(c);
            result_.corner_uv[c] = {glm::dot(p, u), glm::dot(p, v)};
            points_.push_back(result_.corner_uv[c]);
        });
    }

    void turn(Chart& chart, double scale) {
        const glm::dvec2 axis = best_rectangle_axis(points_) * scale, across(-axis.y, axis.x);
        glm::dvec2 low(std::numeric_limits<double>::max()), high(-low);
        each_corner(chart.polygons, [&](uint32_t c) {
            glm::dvec2& uv = result_.corner_uv[c];
            uv = {glm::dot(uv, axis), glm::dot(uv, across)};
            low = glm::min(low, uv);
            high = glm::max(high, uv);
        });
        each_corner(chart.polygons, [&](uint32_t c) { result_.corner_uv[c] -= low; });
        chart.size = high - low;
    }

    const UnwrapMesh& mesh_;
    const FaceGraph& graph_;
    Unwrapped& result_;
    std::vector<glm::dvec2> points_;
};

/// Polygons without area follow a neighbour's chart with all corners in one point.
void place_leftovers(const UnwrapMesh& mesh, const FaceGraph& graph, Unwrapped& result) {
    for (uint32_t f = 0; f < mesh.polygon_count(); ++f) {
        if (result.polygon_chart[f] != Unwrapped::kNoChart) continue;
        ++(graph.faces()[f].finite ? result.degenerate_polygons : result.broken_polygons);
        uint32_t neighbour = Unwrapped::kNoChart;
        for (const FaceLink& link : graph.links(f)) neighbour = std::min(neighbour, result.polygon_chart[link.face]);
        if (neighbour == Unwrapped::kNoChart) {
            if (result.charts.empty()) result.charts.push_back({{f}, glm::dvec2(0.0), 0.0});
            neighbour = 0;
        }
        const uint32_t host = result.charts[neighbour].polygons[0];
        const glm::dvec2 place = result.corner_uv[mesh.polygon_start[host]];
        for (uint32_t i = 0; i < mesh.polygon_size[f]; ++i) result.corner_uv[mesh.polygon_start[f] + i] = place;
        result.polygon_chart[f] = neighbour;
        if (host != f) result.charts[neighbour].polygons.push_back(f);
    }
}

} // namespace

Unwrapped unwrap(const UnwrapMesh& mesh, double chart_angle, double max_extent) {
    Unwrapped result;
    result.corner_uv.assign(mesh.corner_vertex.size(), glm::dvec2(0.0));
    result.polygon_chart.assign(mesh.polygon_count(), Unwrapped::kNoChart);
    const FaceGraph graph(mesh);
    if (!mesh.corner_uv.empty()) keep_islands(mesh, graph, result);
    std::vector<uint8_t> wanted(mesh.polygon_count());
    for (uint32_t f = 0; f < wanted.size(); ++f) wanted[f] = result.polygon_chart[f] == Unwrapped::kNoChart;
    const GrowResult grown = grow_charts(mesh, graph, wanted, chart_angle, max_extent);
    result.overlap_splits = grown.overlap_splits;
    ChartFlattener flattener(mesh, graph, result);
    for (const GrownChart& chart : grown.charts) flattener.flatten(chart);
    place_leftovers(mesh, graph, result);
    return result;
}

} // namespace ajar
