// SPDX-License-Identifier: GPL-3.0-or-later
#include "receiver/chart_grow.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>

#include "receiver/bit_rows.h"

namespace ajar {
namespace {

constexpr uint32_t kNone = 0xffffffffu;
constexpr double kCoplanarCos = 0.99985; ///< cos of 1 degree
constexpr double kCoplanarOffset = 0.1;  ///< texels a coplanar polygon may stand off the plane
constexpr double kThinShare = 0.02;      ///< and of their longest edge
constexpr double kThin = 0.05;           ///< texels: thinner polygons have unreliable normals
constexpr double kSamplesPerTexel = 4.0; ///< of the overlap test
constexpr double kMostSamples = 6.4e7;   ///< per chart; larger charts are tested more coarsely
constexpr double kMostColumns = 65536.0;

struct Box2 {
    glm::dvec2 low{std::numeric_limits<double>::max()}, high{-std::numeric_limits<double>::max()};
    void add(const glm::dvec2& p) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    void add(const Box2& b) {
        low = glm::min(low, b.low);
        high = glm::max(high, b.high);
    }
    double extent() const { return std::max(high.x - low.x, high.y - low.y); }
};

/// A sliver, on the scale of a texel as well as of its own length.
bool is_thin(const UnwrapFace& face) {
    return face.thickness < kThin && face.thickness * face.thickness <= kThinShare * face.area;
}

class Grower {
public:
    Grower(const UnwrapMesh& mesh, const FaceGraph& graph, const std::vector<uint8_t>& wanted, double angle,
           double max_extent)
        : mesh_(mesh),
          graph_(graph),
          angle_cos_(std::cos(angle)),
          place_cos_(std::cos(std::min(angle + 0.2, 1.5))),
          max_extent_(max_extent),
          open_(wanted),
          chart_of_(wanted.size(), kNone) {
        for (uint32_t f = 0; f < open_.size(); ++f)
            if (open_[f] && is_thin(graph.faces()[f])) {
                open_[f] = 0;
                if (graph.faces()[f].finite) thin_.push_back(f);
            }
        for (uint32_t f = 0; f < open_.size(); ++f)
            if (open_[f]) order_.push_back(f);
        std::stable_sort(order_.begin(), order_.end(),
                         [&](uint32_t a, uint32_t b) { return graph_.faces()[a].area > graph_.faces()[b].area; });
    }

    GrowResult run() {
        while (!order_.empty()) {
            make_clusters();
            for (std::vector<uint32_t>& candidate : merge_clusters()) place(candidate);
            std::erase_if(order_, [&](uint32_t f) { return !open_[f]; });
        }
        attach_thin();
        return std::move(result_);
    }

private:
    struct Cluster {
        std::vector<uint32_t> faces;
        glm::dvec3 normal;
        double area = 0.0;
    };

    const UnwrapFace& face(uint32_t f) const { return graph_.faces()[f]; }

    Box2 project_box(uint32_t f, const glm::dvec3& u, const glm::dvec3& v) const {
        Box2 box;
        for (uint32_t i = 0; i < mesh_.polygon_size[f]; ++i) {
            const glm::dvec3& p = mesh_.corner(mesh_.polygon_start[f] + i);
            box.add({glm::dot(p, u), glm::dot(p, v)});
        }
        return box;
    }

    /// Sets of connected coplanar faces, each grown from its largest face.
    void make_clusters() {
        clusters_.clear();
        cluster_of_.assign(open_.size(), kNone);
        for (uint32_t seed : order_) {
            if (cluster_of_[seed] != kNone) continue;
            clusters_.push_back({{seed}, face(seed).normal, 0.0});
            fill_cluster(uint32_t(clusters_.size() - 1), seed);
        }
        cluster_order_.resize(clusters_.size());
        std::iota(cluster_order_.begin(), cluster_order_.end(), 0u);
        std::stable_sort(cluster_order_.begin(), cluster_order_.end(),
                         [&](uint32_t a, uint32_t b) { return clusters_[a].area > clusters_[b].area; });
    }

    void fill_cluster(uint32_t id, uint32_t seed) {
        Cluster& cluster = clusters_[id];
        const glm::dvec3 normal = cluster.normal;
        const double plane = glm::dot(normal, mesh_.corner(mesh_.polygon_start[seed]));
        glm::dvec3 u, v;
        chart_frame(normal, u, v);
        Box2 box = project_box(seed, u, v);
        cluster_of_[seed] = id;
        for (size_t next = 0; next < cluster.faces.size(); ++next) {
            const uint32_t at = cluster.faces[next];
            cluster.area += face(at).area;
            for (const FaceLink& link : graph_.links(at)) {
                const uint32_t f = link.face;
                if (!open_[f] || cluster_of_[f] != kNone || glm::dot(face(f).normal, normal) < kCoplanarCos) continue;
                if (distance_to_plane(f, normal, plane) > kCoplanarOffset) continue;
                Box2 grown = box;
                grown.add(project_box(f, u, v));
                if (grown.extent() > max_extent_) continue;
                box = grown;
                cluster_of_[f] = id;
                cluster.faces.push_back(f);
            }
        }
    }

    double distance_to_plane(uint32_t f, const glm::dvec3& normal, double plane) const {
        double most = 0.0;
        for (uint32_t i = 0; i < mesh_.polygon_size[f]; ++i)
            most = std::max(most, std::abs(glm::dot(mesh_.corner(mesh_.polygon_start[f] + i), normal) - plane));
        return most;
    }

    /// Joins clusters over soft edges, flattest edge first.
    std::vector<std::vector<uint32_t>> merge_clusters() {
        std::vector<std::vector<uint32_t>> charts;
        std::vector<uint8_t> taken(clusters_.size(), 0);
        for (uint32_t seed : cluster_order_)
            if (!taken[seed]) charts.push_back(grow_from(seed, taken));
        absorb_remnants(charts);
        return charts;
    }

    struct Extent {
        glm::dvec3 sum{0.0}; ///< area-weighted normals
        double area = 0.0;
        glm::dvec3 low{std::numeric_limits<double>::max()}, high{-std::numeric_limits<double>::max()};

        void add(const Extent& e) {
            sum += e.sum;
            area += e.area;
            low = glm::min(low, e.low);
            high = glm::max(high, e.high);
        }
    };

    Extent face_extent(uint32_t f) const {
        Extent e;
        e.sum = face(f).normal * face(f).area;
        e.area = face(f).area;
        for (uint32_t i = 0; i < mesh_.polygon_size[f]; ++i) {
            e.low = glm::min(e.low, mesh_.corner(mesh_.polygon_start[f] + i));
            e.high = glm::max(e.high, mesh_.corner(mesh_.polygon_start[f] + i));
        }
        return e;
    }

    /// Gives small charts, left between larger ones, to a neighbour that bends a little further.
    void absorb_remnants(std::vector<std::vector<uint32_t>>& charts) {
        std::vector<uint32_t> owner(open_.size(), kNone), order(charts.size());
        std::vector<Extent> extents(charts.size());
        for (uint32_t c = 0; c < charts.size(); ++c)
            for (uint32_t f : charts[c]) {
                owner[f] = c;
                extents[c].add(face_extent(f));
            }
        std::iota(order.begin(), order.end(), 0u);
        std::stable_sort(order.begin(), order.end(),
                         [&](uint32_t a, uint32_t b) { return extents[a].area < extents[b].area; });
        for (uint32_t c : order) {
            const uint32_t host = find_host(charts[c], owner, extents);
            if (host == kNone) continue;
            for (uint32_t f : charts[c]) owner[f] = host;
            charts[host].insert(charts[host].end(), charts[c].begin(), charts[c].end());
            extents[host].add(extents[c]);
            charts[c].clear();
        }
        std::erase_if(charts, [](const std::vector<uint32_t>& chart) { return chart.empty(); });
    }

    /// The chart behind a soft edge, at least four times as large, that the remnant fits best.
    uint32_t find_host(const std::vector<uint32_t>& remnant, const std::vector<uint32_t>& owner,
                       const std::vector<Extent>& extents) const {
        const uint32_t self = owner[remnant[0]];
        std::vector<uint32_t> hosts;
        for (uint32_t f : remnant)
            for (const FaceLink& link : graph_.links(f))
                if (open_[link.face] && !link.sharp && owner[link.face] != self) hosts.push_back(owner[link.face]);
        std::sort(hosts.begin(), hosts.end());
        hosts.erase(std::unique(hosts.begin(), hosts.end()), hosts.end());
        uint32_t best = kNone;
        double best_cos = place_cos_;
        for (uint32_t host : hosts) {
            Extent both = extents[host];
            both.add(extents[self]);
            if (extents[host].area < 4.0 * extents[self].area || glm::length(both.high - both.low) > max_extent_)
                continue;
            const glm::dvec3 axis = glm::normalize(both.sum);
            double worst = 1.0;
            for (uint32_t f : remnant) worst = std::min(worst, glm::dot(axis, face(f).normal));
            if (worst <= best_cos) continue;
            best_cos = worst;
            best = host;
        }
        return best;
    }

    std::vector<uint32_t> grow_from(uint32_t seed, std::vector<uint8_t>& taken) {
        using Entry = std::pair<double, uint32_t>; // 1 - cos of the fold, cluster
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
        std::vector<uint32_t> faces;
        glm::dvec3 sum(0.0), u, v;
        chart_frame(clusters_[seed].normal, u, v);
        Box2 box;
        queue.emplace(0.0, seed);
        while (!queue.empty()) {
            const uint32_t id = queue.top().second;
            queue.pop();
            const Cluster& cluster = clusters_[id];
            if (taken[id]) continue;
            if (!faces.empty() && glm::dot(glm::normalize(sum), cluster.normal) < angle_cos_) continue;
            Box2 grown = box;
            for (uint32_t f : cluster.faces) grown.add(project_box(f, u, v));
            if (!faces.empty() && grown.extent() > max_extent_) continue;
            box = grown;
            taken[id] = 1;
            sum += cluster.normal * cluster.area;
            faces.insert(faces.end(), cluster.faces.begin(), cluster.faces.end());
            for (uint32_t f : cluster.faces)
                for (const FaceLink& link : graph_.links(f))
                    if (open_[link.face] && !link.sharp && !taken[cluster_of_[link.face]])
                        queue.emplace(1.0 - glm::dot(face(f).normal, face(link.face).normal), cluster_of_[link.face]);
        }
        return faces;
    }

    /// Keeps the connected part of a candidate that does not cover itself; the rest stays open.
    void place(const std::vector<uint32_t>& candidate) {
        GrownChart chart;
        glm::dvec3 sum(0.0);
        for (uint32_t f : candidate) sum += face(f).normal * face(f).area;
        chart.axis = glm::length(sum) > 0.0 ? glm::normalize(sum) : face(candidate[0]).normal;
        if (glm::dot(chart.axis, face(candidate[0]).normal) < place_cos_) chart.axis = face(candidate[0]).normal;
        chart.polygons.push_back(candidate[0]);
        chart_of_[candidate[0]] = uint32_t(result_.charts.size());
        // A polygon alone may be of any size: testing it would take a bitmap as large.
        if (candidate.size() > 1) add_uncovered(candidate, chart);
        for (uint32_t f : chart.polygons) open_[f] = 0;
        result_.charts.push_back(std::move(chart));
    }

    /// Adds to the chart, which holds the candidate's first polygon, what is linked to it and covers none of it.
    void add_uncovered(const std::vector<uint32_t>& candidate, GrownChart& chart) {
        glm::dvec3 u, v;
        chart_frame(chart.axis, u, v);
        Box2 box;
        for (uint32_t f : candidate) box.add(project_box(f, u, v));
        const glm::dvec2 size = box.high - box.low;
        const double scale = std::min({kSamplesPerTexel, std::sqrt(kMostSamples / std::max(size.x * size.y, 1.0)),
                                       kMostColumns / std::max({size.x, size.y, 1.0})});
        BitRows covered(int(size.x * scale) + 2, int(size.y * scale) + 2);

        for (size_t i = 1; i < candidate.size(); ++i) chart_of_[candidate[i]] = kPending;
        cover(candidate[0], u, v, box.low, scale, covered);
        for (size_t next = 0; next < chart.polygons.size(); ++next)
            for (const FaceLink& link : graph_.links(chart.polygons[next])) {
                const uint32_t f = link.face;
                if (chart_of_[f] != kPending || glm::dot(face(f).normal, chart.axis) < place_cos_) continue;
                if (!cover(f, u, v, box.low, scale, covered)) continue;
                chart_of_[f] = uint32_t(result_.charts.size());
                chart.polygons.push_back(f);
            }
        if (chart.polygons.size() < candidate.size()) ++result_.overlap_splits;
        for (uint32_t f : candidate)
            if (chart_of_[f] == kPending) chart_of_[f] = kNone;
    }

    /// Marks the polygon's samples. False, and nothing marked, if a 2x2 block was covered before.
    bool cover(uint32_t f, const glm::dvec3& u, const glm::dvec3& v, const glm::dvec2& low, double scale,
               BitRows& covered) {
        polygon_.clear();
        for (uint32_t i = 0; i < mesh_.polygon_size[f]; ++i) {
            const glm::dvec3& p = mesh_.corner(mesh_.polygon_start[f] + i);
            polygon_.push_back((glm::dvec2(glm::dot(p, u), glm::dot(p, v)) - low) * scale + 0.5);
        }
        polygon_spans(polygon_, covered.width(), covered.height(), spans_);
        for (size_t i = 0; i + 1 < spans_.size(); ++i)
            for (size_t j = i + 1; j < spans_.size() && spans_[j].y <= spans_[i].y + 1; ++j)
                if (spans_[j].y == spans_[i].y + 1 && block_covered(spans_[i], spans_[j], covered)) return false;
        for (const SampleSpan& s : spans_) covered.set_span(s.y, s.begin, s.end);
        return true;
    }

    static bool block_covered(const SampleSpan& a, const SampleSpan& b, const BitRows& covered) {
        const int end = std::min(a.end, b.end);
        int run = 0;
        for (int x = std::max(a.begin, b.begin); x < end; ++x) {
            run = covered.get(x, a.y) && covered.get(x, b.y) ? run + 1 : 0;
            if (run == 2) return true;
        }
        return false;
    }

    /// Thin polygons join the chart they share most edge length with; those without one start theirs.
    void attach_thin() {
        std::vector<uint8_t> waiting(open_.size(), 0);
        for (uint32_t f : thin_) waiting[f] = 1;
        spread(thin_, waiting);
        std::stable_sort(thin_.begin(), thin_.end(),
                         [&](uint32_t a, uint32_t b) { return face(a).area > face(b).area; });
        for (uint32_t f : thin_) {
            if (!waiting[f] || glm::length(face(f).normal) < 0.5) continue; // without area it is no chart
            waiting[f] = 0;
            chart_of_[f] = uint32_t(result_.charts.size());
            result_.charts.push_back({face(f).normal, {f}});
            std::vector<uint32_t> next;
            for (const FaceLink& link : graph_.links(f)) next.push_back(link.face);
            spread(std::move(next), waiting);
        }
    }

    /// Gives waiting polygons to their neighbours' charts, and on from there.
    void spread(std::vector<uint32_t> work, std::vector<uint8_t>& waiting) {
        for (size_t i = 0; i < work.size(); ++i) {
            const uint32_t f = work[i], chart = waiting[f] ? best_neighbour(f) : kNone;
            if (chart == kNone) continue;
            waiting[f] = 0;
            chart_of_[f] = chart;
            result_.charts[chart].polygons.push_back(f);
            for (const FaceLink& link : graph_.links(f)) work.push_back(link.face);
        }
    }

    uint32_t best_neighbour(uint32_t f) const {
        uint32_t best = kNone;
        double longest = -1.0;
        for (const FaceLink& link : graph_.links(f))
            if (chart_of_[link.face] != kNone && link.length > longest) {
                longest = link.length;
                best = chart_of_[link.face];
            }
        return best;
    }

    static constexpr uint32_t kPending = 0xfffffffeu;

    const UnwrapMesh& mesh_;
    const FaceGraph& graph_;
    double angle_cos_, place_cos_, max_extent_;
    std::vector<uint8_t> open_; ///< faces that wait for a chart
    std::vector<uint32_t> chart_of_;
    std::vector<uint32_t> order_, thin_;
    std::vector<Cluster> clusters_;
    std::vector<uint32_t> cluster_of_, cluster_order_;
    std::vector<glm::dvec2> polygon_;
    std::vector<SampleSpan> spans_;
    GrowResult result_;
};

} // namespace

void chart_frame(const glm::dvec3& axis, glm::dvec3& u, glm::dvec3& v) {
    const glm::dvec3 side = std::abs(axis.z) < 0.7 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
    u = glm::normalize(glm::cross(side, axis));
    v = glm::cross(axis, u);
}

GrowResult grow_charts(const UnwrapMesh& mesh, const FaceGraph& graph, const std::vector<uint8_t>& wanted,
                       double chart_angle, double max_extent) {
    return Grower(mesh, graph, wanted, chart_angle, max_extent).run();
}

} // namespace ajar
