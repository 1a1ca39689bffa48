// SPDX-License-Identifier: GPL-3.0-or-later
#include "receiver/unwrap_graph.h"

#include <algorithm>
#include <limits>

#include "receiver/point_grid.h"

namespace ajar {
namespace {

constexpr double kTouchShare = 0.05;     ///< the same as a share of the mean open edge, if that is less
constexpr double kMostSteps = 65536.0;   ///< along one edge; edges still longer than that are not split
constexpr double kTouchTolerance = 0.02; ///< texels a vertex may stand off an edge it splits

/// One side of a (part of an) edge: welded end points, smaller index first.
struct HalfEdge {
    uint32_t a, b, face;
    double length;
    bool sharp;

    bool same_edge(const HalfEdge& o) const { return a == o.a && b == o.b; }
    bool operator<(const HalfEdge& o) const {
        if (a != o.a) return a < o.a;
        if (b != o.b) return b < o.b;
        return face < o.face;
    }
};

bool is_finite(const glm::dvec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

UnwrapFace measure_face(const UnwrapMesh& mesh, uint32_t polygon) {
    UnwrapFace face;
    const uint32_t start = mesh.polygon_start[polygon], size = mesh.polygon_size[polygon];
    const glm::dvec3 origin = mesh.corner(start);
    glm::dvec3 sum(0.0);
    double longest = 0.0;
    face.finite = is_finite(origin);
    for (uint32_t i = 0; i < size && face.finite; ++i) {
        const glm::dvec3 p = mesh.corner(start + i), q = mesh.corner(start + (i + 1) % size);
        face.finite = is_finite(p);
        sum += glm::cross(p - origin, q - origin);
        longest = std::max(longest, glm::length(q - p));
    }
    if (!face.finite) return face;
    face.area = 0.5 * glm::length(sum);
    if (longest <= 0.0 || face.area <= 1e-12 * longest * longest) return face;
    face.normal = sum / (2.0 * face.area);
    face.thickness = face.area / longest;
    return face;
}

/// Largest difference that counts as the same point: 1e-6 of the extent, or float rounding.
double weld_tolerance(const std::vector<glm::dvec3>& points) {
    glm::dvec3 low(std::numeric_limits<double>::max()), high(-low);
    for (const glm::dvec3& p : points) {
        if (!is_finite(p)) continue;
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    if (low.x > high.x) return 1e-6;
    const glm::dvec3 reach = glm::max(glm::abs(low), glm::abs(high));
    const double rounding = std::max({reach.x, reach.y, reach.z}) * 4.0 * 1.2e-7;
    return std::min(std::max({1e-6 * glm::length(high - low), rounding, 1e-12}), kTouchTolerance);
}

/// Index of the first vertex at (about) the same place, for every vertex.
std::vector<uint32_t> weld(const std::vector<glm::dvec3>& points, double tolerance) {
    std::vector<uint32_t> target(points.size());
    PointGrid grid(4.0 * tolerance, points.size());
    for (uint32_t i = 0; i < points.size(); ++i) {
        target[i] = i;
        if (!is_finite(points[i])) continue;
        uint32_t found = i;
        grid.near(points[i], tolerance, [&](uint32_t id, const glm::dvec3&) { found = std::min(found, id); });
        target[i] = found;
        if (found == i) grid.insert(points[i], i);
    }
    return target;
}

HalfEdge make_edge(const std::vector<glm::dvec3>& points, uint32_t a, uint32_t b, uint32_t face, bool sharp) {
    return {std::min(a, b), std::max(a, b), face, glm::length(points[a] - points[b]), sharp};
}

std::vector<HalfEdge> collect_edges(const UnwrapMesh& mesh, const std::vector<UnwrapFace>& faces,
                                    const std::vector<uint32_t>& welded) {
    std::vector<HalfEdge> edges;
    edges.reserve(mesh.corner_vertex.size());
    for (uint32_t f = 0; f < faces.size(); ++f) {
        if (!faces[f].finite) continue;
        const uint32_t start = mesh.polygon_start[f], size = mesh.polygon_size[f];
        for (uint32_t i = 0; i < size; ++i) {
            const uint32_t a = welded[mesh.corner_vertex[start + i]];
            const uint32_t b = welded[mesh.corner_vertex[start + (i + 1) % size]];
            const bool sharp = !mesh.corner_edge_sharp.empty() && mesh.corner_edge_sharp[start + i] != 0;
            if (a != b) edges.push_back(make_edge(mesh.positions, a, b, f, sharp));
        }
    }
    std::sort(edges.begin(), edges.end());
    return edges;
}

/// Splits edges that have a face on one side only at the vertices that lie on them.
class EdgeSplitter {
public:
    EdgeSplitter(const std::vector<glm::dvec3>& points, const std::vector<HalfEdge>& open, double tolerance)
        : points_(points),
          cell_(cell_size(open)),
          tolerance_(std::min(tolerance, kTouchShare * cell_)),
          grid_(2.0 * cell_, open.size()) {
        std::vector<uint32_t> ends;
        for (const HalfEdge& e : open) ends.insert(ends.end(), {e.a, e.b});
        std::sort(ends.begin(), ends.end());
        ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
        for (uint32_t v : ends) grid_.insert(points[v], v);
    }

    void split(const HalfEdge& edge, std::vector<HalfEdge>& out) {
        find_points(edge);
        uint32_t from = edge.a;
        for (const auto& [t, v] : on_edge_) {
            if (v == from) continue;
            out.push_back(make_edge(points_, from, v, edge.face, edge.sharp));
            from = v;
        }
        out.push_back(make_edge(points_, from, edge.b, edge.face, edge.sharp));
    }

private:
    static double cell_size(const std::vector<HalfEdge>& open) {
        double sum = 1e-9;
        for (const HalfEdge& e : open) sum += e.length;
        return sum / double(std::max<size_t>(open.size(), 1));
    }

    void find_points(const HalfEdge& edge) {
        on_edge_.clear();
        const glm::dvec3 a = points_[edge.a], d = points_[edge.b] - a;
        const double end_margin = 0.5 * tolerance_ / edge.length;
        if (!(edge.length <= kMostSteps * cell_)) return;
        const int steps = int(std::ceil(edge.length / cell_));
        const double radius = 0.5 * edge.length / steps + tolerance_;
        for (int s = 0; s < steps; ++s) {
            grid_.near(a + d * ((s + 0.5) / steps), radius, [&](uint32_t v, const glm::dvec3& p) {
                const double t = glm::dot(p - a, d) / glm::dot(d, d);
                if (v == edge.a || v == edge.b || t <= end_margin || t >= 1.0 - end_margin) return;
                if (glm::length(p - a - t * d) <= tolerance_) on_edge_.emplace_back(t, v);
            });
        }
        std::sort(on_edge_.begin(), on_edge_.end());
        on_edge_.erase(std::unique(on_edge_.begin(), on_edge_.end()), on_edge_.end());
    }

    const std::vector<glm::dvec3>& points_;
    double cell_, tolerance_;
    PointGrid grid_;
    std::vector<std::pair<double, uint32_t>> on_edge_;
};

/// Replaces the edges with a single face by their parts between T-junction vertices.
std::vector<HalfEdge> split_open_edges(const std::vector<glm::dvec3>& points, const std::vector<HalfEdge>& edges,
                                       double tolerance) {
    std::vector<HalfEdge> open, result;
    for (size_t i = 0; i < edges.size(); ++i) {
        const bool paired =
            (i > 0 && edges[i].same_edge(edges[i - 1])) || (i + 1 < edges.size() && edges[i].same_edge(edges[i + 1]));
        (paired ? result : open).push_back(edges[i]);
    }
    EdgeSplitter splitter(points, open, tolerance);
    for (const HalfEdge& e : open) splitter.split(e, result);
    std::sort(result.begin(), result.end());
    return result;
}

} // namespace

FaceGraph::FaceGraph(const UnwrapMesh& mesh) {
    const uint32_t count = mesh.polygon_count();
    for (uint32_t f = 0; f < count; ++f) faces_.push_back(measure_face(mesh, f));
    const double tolerance = weld_tolerance(mesh.positions);
    const std::vector<uint32_t> welded = weld(mesh.positions, tolerance);
    std::vector<HalfEdge> edges = collect_edges(mesh, faces_, welded);
    edges = split_open_edges(mesh.positions, edges, kTouchTolerance);

    struct Pair {
        uint32_t face;
        FaceLink link;
    };
    std::vector<Pair> pairs;
    constexpr size_t kMostFacesPerEdge = 6; // more than that only happens in broken meshes
    for (size_t i = 0; i < edges.size(); ++i)
        for (size_t j = i + 1; j < edges.size() && j <= i + kMostFacesPerEdge && edges[i].same_edge(edges[j]); ++j) {
            if (edges[i].face == edges[j].face) continue;
            const bool sharp = edges[i].sharp || edges[j].sharp;
            pairs.push_back({edges[i].face, {edges[j].face, edges[i].length, sharp}});
            pairs.push_back({edges[j].face, {edges[i].face, edges[i].length, sharp}});
        }
    std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& x, const Pair& y) { return x.face < y.face; });
    link_start_.assign(count + 1, 0);
    for (const Pair& p : pairs) {
        ++link_start_[p.face + 1];
        links_.push_back(p.link);
    }
    for (uint32_t f = 0; f < count; ++f) link_start_[f + 1] += link_start_[f];
}

} // namespace ajar
