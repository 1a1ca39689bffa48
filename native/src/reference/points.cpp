// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/points.h"

#include <algorithm>
#include <array>
#include <map>

namespace ajar {

namespace {

constexpr int kTries = 256;           ///< rounds of draws, and draws of a place in a texel
constexpr int kMostTries = 1024;      ///< rounds where some places were found: a share of 1 % is missed once in 30000
constexpr uint64_t kVainDraws = 4096; ///< of which none is in the open: there is no such place
constexpr int kSideProbes = 8;
constexpr int kEnclosureRays = 32;
constexpr float kNearBack = 4.0f;      ///< texels: so near, the back of a thing that is not closed is its inside
constexpr uint32_t kMaxRow = 1u << 14; ///< no page is larger
constexpr float kCoverHeight = 0.125f; ///< texels above the surface
constexpr float kProbeHeight = 0.25f;  ///< texels above the surface

std::array<Vec2, 3> corners(const Snapshot& s, uint32_t t) {
    return {s.lightmap_uv(t, 0), s.lightmap_uv(t, 1), s.lightmap_uv(t, 2)};
}

float cross(const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; }

/// Mean edge of the texels on a triangle, m.
float texel_edge(const Snapshot& s, uint32_t t) {
    const auto c = corners(s, t);
    return std::sqrt(2.0f * s.area(t) / std::abs(cross(c[1] - c[0], c[2] - c[0])));
}

/// Barycentric weights of p in texels; false outside.
bool locate(const std::array<Vec2, 3>& c, const Vec2& p, Place& out) {
    const Vec2 a = c[1] - c[0], b = c[2] - c[0], d = p - c[0];
    const float det = cross(a, b);
    out.u = cross(d, b) / det, out.v = cross(a, d) / det;
    return out.u >= 0.0f && out.v >= 0.0f && out.u + out.v <= 1.0f;
}

} // namespace

PointChooser::PointChooser(const World& world, bool by_texel, bool whole_texels, const SceneState& state,
                           std::function<bool(const Place&)> is_lit)
    : world_(world), state_(state), whole_texels_(whole_texels), is_lit_(std::move(is_lit)) {
    const Snapshot& s = world.scene;
    double total = 0.0;
    for (uint32_t t = 0; t < s.triangles.size(); ++t) {
        if (!s.instance_of(t).lightmapped) continue;
        const auto c = corners(s, t);
        const float texels = 0.5f * std::abs(cross(c[1] - c[0], c[2] - c[0]));
        if (!(texels > 1e-6f)) continue;
        triangles_.push_back(t);
        running_.push_back(total += by_texel ? texels : s.area(t));
    }
}

std::vector<ReferencePoint> PointChooser::choose(uint32_t count, uint64_t seed, const Progress& progress) const {
    std::vector<ReferencePoint> out(count);
    std::vector<uint32_t> open(count);
    for (uint32_t i = 0; i < count; ++i) open[i] = i;
    // Each point has its own numbers, so that the first ones do not depend on how many there are.
    const auto goes_on = [&](int round) {
        if (open.empty() || triangles_.empty()) return false;
        if (open.size() < count) return round < kMostTries;
        return round < kTries && static_cast<uint64_t>(round) * count < kVainDraws;
    };
    for (int round = 0; goes_on(round); ++round) {
        progress.check_cancel();
        std::vector<uint32_t> drawn, again;
        for (const uint32_t i : open) {
            Pcg random(seed + (static_cast<uint64_t>(round) << 32), i);
            (draw(out[i], random) ? drawn : again).push_back(i);
        }
        if (whole_texels_ && !drawn.empty()) {
            find_neighbours(out, drawn);
            for (const uint32_t i : drawn)
                if (is_parted(out[i], round)) again.push_back(i);
        }
        open = std::move(again);
    }
    std::sort(open.begin(), open.end());
    for (size_t k = open.size(); k-- > 0;) out.erase(out.begin() + open[k]);
    return out;
}

/// Triangles that share the texels of the numbered points.
void PointChooser::find_neighbours(std::vector<ReferencePoint>& points, const std::vector<uint32_t>& numbers) const {
    std::map<std::array<uint32_t, 3>, std::vector<uint32_t>> of_texel; // page, row, column
    for (const uint32_t i : numbers) {
        points[i].neighbours.clear();
        of_texel[{points[i].page, points[i].y, points[i].x}].push_back(i);
    }
    for (const uint32_t t : triangles_) {
        const auto c = corners(world_.scene, t);
        const uint32_t page = world_.scene.instance_of(t).page;
        const Vec2 low = glm::max(glm::min(c[0], glm::min(c[1], c[2])), Vec2(0.0f)),
                   high = glm::max(glm::max(c[0], glm::max(c[1], c[2])), Vec2(0.0f));
        const auto left = static_cast<uint32_t>(low.x), right = static_cast<uint32_t>(high.x);
        for (auto y = static_cast<uint32_t>(low.y); y <= std::min(static_cast<uint32_t>(high.y), kMaxRow); ++y)
            for (auto it = of_texel.lower_bound({page, y, left});
                 it != of_texel.end() && it->first <= std::array{page, y, right}; ++it)
                for (const uint32_t i : it->second) points[i].neighbours.push_back(t);
    }
}

bool PointChooser::draw(ReferencePoint& point, Pcg& random) const {
    const Snapshot& s = world_.scene;
    const auto it = std::upper_bound(running_.begin(), running_.end(), random.uniform() * running_.back());
    const uint32_t t = triangles_[std::min<size_t>(it - running_.begin(), triangles_.size() - 1)];
    const float r = std::sqrt(random.uniform()), split = random.uniform();
    point.place = {t, r * (1.0f - split), r * split};
    const auto c = corners(s, t);
    const Vec2 p = c[0] + (c[1] - c[0]) * point.place.u + (c[2] - c[0]) * point.place.v;
    point.page = s.instance_of(t).page;
    const Page& page = s.pages[point.page];
    if (p.x < 0.0f || p.y < 0.0f || p.x >= static_cast<float>(page.width) || p.y >= static_cast<float>(page.height))
        return false;
    point.x = static_cast<uint32_t>(p.x), point.y = static_cast<uint32_t>(p.y);
    if (is_covered(point.place)) return false;
    point.in_lit_solid = is_buried(point.place) || is_enclosed(point.place);
    return !point.in_lit_solid || is_lit_(point.place);
}

Place PointChooser::place_in_texel(const ReferencePoint& point, Pcg& random) const {
    for (int tries = 0; tries < kTries; ++tries) {
        const Vec2 p(static_cast<float>(point.x) + random.uniform(), static_cast<float>(point.y) + random.uniform());
        for (const uint32_t t : point.neighbours) {
            Place place{t, 0.0f, 0.0f};
            if (!locate(corners(world_.scene, t), p, place) || is_covered(place)) continue;
            if (point.in_lit_solid || !is_buried(place)) return place;
        }
    }
    return point.place;
}

PointChooser::View PointChooser::view_from(const Place& p) const {
    const Frame f = frame_from_normal(world_.scene.geometric_normal(p.triangle));
    View view{f, world_.tracer.offset(world_.scene.position(p.triangle, p.u, p.v), f.z), state_};
    view.state.own = world_.scene.presence(p.triangle);
    return view;
}

/// Inside a thing that stands there: most ways lead to the inside of a solid, or all of them to backs close by; backs
/// far away are walls and roofs of single sheets. One way is not enough, as it may end where that thing touches
/// another.
bool PointChooser::is_buried(const Place& p) const {
    const View view = view_from(p);
    const float near = kNearBack * texel_edge(world_.scene, p.triangle);
    int backs = 0, inside = 0, others = 0;
    for (const Vec3& w : {Vec3(0.1f, 0.2f, 0.97f), Vec3(0.6f, -0.5f, 0.62f), Vec3(-0.7f, 0.3f, 0.65f)}) {
        const Hit hit = world_.meet(view.along(glm::normalize(w)), view.state);
        if (hit.triangle == kMiss || !hit.back) {
            if (++others == 2) return false; // the third way cannot change the answer
            continue;
        }
        backs += hit.t < near;
        inside += world_.is_inside(hit);
    }
    return inside >= 2 || backs == 3;
}

/// Where something else sticks into the solid around a place, single rays end on its front; most do not.
bool PointChooser::is_enclosed(const Place& p) const {
    const View view = view_from(p);
    const float near = kNearBack * texel_edge(world_.scene, p.triangle);
    int inside = 0;
    for (int i = 0; i < kEnclosureRays; ++i) { // cosine distributed, on a spiral
        const float up = (static_cast<float>(i) + 0.5f) / kEnclosureRays, r = std::sqrt(1.0f - up);
        const float angle = 2.39996f * static_cast<float>(i);
        const Vec3 w(r * std::cos(angle), r * std::sin(angle), std::sqrt(up));
        const Hit hit = world_.meet(view.along(w), view.state);
        inside += hit.triangle != kMiss && (world_.is_inside(hit) || (hit.back && hit.t < near));
    }
    return 2 * inside >= kEnclosureRays;
}

bool PointChooser::is_covered(const Place& p) const {
    Ray up = view_from(p).along({0, 0, 1});
    up.tfar = kCoverHeight * texel_edge(world_.scene, p.triangle);
    return world_.tracer.occluded(up, kMaskGather);
}

bool PointChooser::is_parted(const ReferencePoint& point, uint32_t draw) const {
    Pcg random(draw, point.place.triangle);
    const Snapshot& s = world_.scene;
    const float size = texel_edge(s, point.place.triangle);
    const auto above = [&](const Place& p) {
        return s.position(p.triangle, p.u, p.v) + s.shading_normal(p.triangle, p.u, p.v) * (kProbeHeight * size);
    };
    const Vec3 from = above(point.place);
    for (int i = 0; i < kSideProbes; ++i)
        if (world_.tracer.occluded({from, above(place_in_texel(point, random)) - from, 0.0f, 1.0f}, kMaskWall))
            return true;
    return false;
}

} // namespace ajar
