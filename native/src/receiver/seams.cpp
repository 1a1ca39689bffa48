// SPDX-License-Identifier: GPL-3.0-or-later
#include "receiver/seams.h"

#include <algorithm>

#include "base/hash.h"

namespace ajar {

namespace {

constexpr float kSmoothCosine = 0.985f; ///< cos 10 degrees
constexpr float kPointsPerTexel = 3.0f;
constexpr float kSplitTexels = 1e-3f; ///< closer UVs are one place
constexpr uint32_t kMaxPoints = 4096; ///< along one edge

/// A triangle edge with a direction that does not depend on the winding.
struct Edge {
    std::array<int64_t, 6> key; ///< quantised end points, smaller one first
    uint32_t triangle;
    uint8_t from, to; ///< corners in key order
};

std::array<int64_t, 3> quantise(const Vec3& p, float step) {
    return {std::llround(p.x / step), std::llround(p.y / step), std::llround(p.z / step)};
}

std::vector<Edge> collect_edges(const Snapshot& scene) {
    const float step = std::max(scene.diagonal(), 1e-3f) * 2e-6f;
    std::vector<Edge> edges;
    for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
        if (!scene.instance_of(t).lightmapped) continue;
        for (uint8_t i = 0; i < 3; ++i) {
            uint8_t from = i, to = static_cast<uint8_t>((i + 1) % 3);
            auto a = quantise(scene.positions[scene.triangles[t].vertex[from]], step),
                 b = quantise(scene.positions[scene.triangles[t].vertex[to]], step);
            if (a == b) continue;
            if (b < a) std::swap(a, b), std::swap(from, to);
            edges.push_back({{a[0], a[1], a[2], b[0], b[1], b[2]}, t, from, to});
        }
    }
    std::sort(edges.begin(), edges.end(),
              [](const Edge& a, const Edge& b) { return a.key != b.key ? a.key < b.key : a.triangle < b.triangle; });
    return edges;
}

bool smooth_across(const Snapshot& scene, const Edge& a, const Edge& b) {
    return glm::dot(scene.corner_normal(a.triangle, a.from), scene.corner_normal(b.triangle, b.from)) > kSmoothCosine &&
           glm::dot(scene.corner_normal(a.triangle, a.to), scene.corner_normal(b.triangle, b.to)) > kSmoothCosine;
}

void add_points(const Snapshot& scene, const Edge& a, const Edge& b, std::vector<SeamPoint>& out) {
    const uint32_t page_a = scene.instance_of(a.triangle).page, page_b = scene.instance_of(b.triangle).page;
    const Vec2 a0 = scene.lightmap_uv(a.triangle, a.from), a1 = scene.lightmap_uv(a.triangle, a.to);
    const Vec2 b0 = scene.lightmap_uv(b.triangle, b.from), b1 = scene.lightmap_uv(b.triangle, b.to);
    if (page_a == page_b && glm::length(a0 - b0) < kSplitTexels && glm::length(a1 - b1) < kSplitTexels) return;
    const float length = std::max(glm::length(a1 - a0), glm::length(b1 - b0));
    const auto count =
        static_cast<uint32_t>(std::clamp(std::ceil(length * kPointsPerTexel), 2.0f, static_cast<float>(kMaxPoints)));
    for (uint32_t i = 0; i < count; ++i) {
        const float t = (static_cast<float>(i) + 0.5f) / static_cast<float>(count);
        out.push_back({bilinear_tap(scene.pages[page_a], glm::mix(a0, a1, t)),
                       bilinear_tap(scene.pages[page_b], glm::mix(b0, b1, t))});
    }
}

} // namespace

BilinearTap bilinear_tap(const Page& page, const Vec2& p) {
    const float fx = std::floor(p.x - 0.5f), fy = std::floor(p.y - 0.5f);
    const float tx = p.x - 0.5f - fx, ty = p.y - 0.5f - fy;
    const auto column = [&](float x) {
        return static_cast<uint32_t>(std::clamp(x, 0.0f, static_cast<float>(page.width - 1)));
    };
    const auto row = [&](float y) {
        return static_cast<uint32_t>(std::clamp(y, 0.0f, static_cast<float>(page.height - 1)));
    };
    const auto at = [&](float x, float y) {
        return static_cast<uint32_t>(page.first_texel + uint64_t{row(y)} * page.width + column(x));
    };
    return {{at(fx, fy), at(fx + 1, fy), at(fx, fy + 1), at(fx + 1, fy + 1)},
            {(1 - tx) * (1 - ty), tx * (1 - ty), (1 - tx) * ty, tx * ty}};
}

std::vector<SeamPoint> find_seams(const Snapshot& scene) {
    const std::vector<Edge> edges = collect_edges(scene);
    std::vector<SeamPoint> out;
    for (size_t begin = 0, end; begin < edges.size(); begin = end) {
        for (end = begin + 1; end < edges.size() && edges[end].key == edges[begin].key;) ++end;
        for (size_t i = begin + 1; i < end; ++i)
            if (smooth_across(scene, edges[i - 1], edges[i])) add_points(scene, edges[i - 1], edges[i], out);
    }
    return out;
}

} // namespace ajar
