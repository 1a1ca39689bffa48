// SPDX-License-Identifier: GPL-3.0-or-later
#include "receiver/lightmap.h"

#include <atomic>
#include <numeric>
#include <tuple>

#include "base/hash.h"
#include "base/owen_sobol.h"
#include "receiver/push_out.h"
#include "receiver/texel_square.h"

namespace ajar {

namespace {

constexpr int kAlbedoSamples = 16;
constexpr uint32_t kSidePoints = 16; ///< points of a texel that tell into which parts a wall cuts it
constexpr float kLargePart = 0.25f;  ///< of those points: the part before a wall without thickness stands for the texel
constexpr float kLowCover = 0.125f;  ///< texel edges: what hangs that low over a surface hides it
constexpr float kUpright = 0.2f;     ///< cosine between normals
constexpr float kFlat = 0.9999f;     ///< cosine between normals of what counts as one plane
constexpr float kUneven = 0.02f;     ///< texel edges by which positions of equal cells may be off
constexpr uint32_t kPositionSalt = 0xa11ce5u;
/// Cosine between the shading and the geometric normal of a texel from which on the surface itself is asked what is
/// below it. At this angle, 0.26 degrees, 5e-6 of an even light comes from there.
constexpr float kLean = 0.99999f;
constexpr float kOverlapArea = 1.1f; ///< more triangle area than a texel has means overlapping UVs
constexpr float kFullArea = 0.9999f; ///< texels: a fragment that covers all of its texel

uint32_t part_bits(uint32_t v) { // spreads 4 bits for a Morton code
    v = (v | (v << 2)) & 0x33;
    return (v | (v << 1)) & 0x55;
}

/// Texels on charts, those of the ring whose 2x2 block has some on charts, and the others.
enum class TexelKind : uint8_t { on_chart, near_chart, apart };

class TexelKinds {
public:
    TexelKinds(const Snapshot& scene, const Coverage& coverage) : scene_(scene), on_chart_(scene.texel_count(), false) {
        for (const Fragment& f : coverage.fragments)
            if (!f.ring) on_chart_[f.texel] = true;
    }
    TexelKind of(const Fragment& f) const {
        if (on_chart_[f.texel]) return TexelKind::on_chart;
        const Page& page = scene_.pages[scene_.instance_of(f.triangle).page];
        const auto [x, y] = place_of(page, f.texel);
        return any(page, {page, x & ~1, y & ~1, 2}) ? TexelKind::near_chart : TexelKind::apart;
    }

private:
    bool any(const Page& page, const TexelSquare& range) const {
        bool found = false;
        range.each(page, [&](uint64_t t) { found |= on_chart_[t]; });
        return found;
    }

    const Snapshot& scene_;
    std::vector<bool> on_chart_; ///< [page texels]
};

/// Order key of a texel: page tile, then its kind, then Morton inside.
struct TexelKey {
    uint32_t tile;
    TexelKind kind;
    uint32_t morton;

    auto operator<=>(const TexelKey&) const = default;
};

TexelKey key_of(const Snapshot& scene, uint32_t page_index, uint32_t texel, TexelKind kind, uint32_t first_tile) {
    const Page& page = scene.pages[page_index];
    const auto [px, py] = place_of(page, texel);
    const auto x = static_cast<uint32_t>(px), y = static_cast<uint32_t>(py);
    const uint32_t tiles_x = (page.width + kTileEdge - 1) / kTileEdge;
    return {first_tile + (y / kTileEdge) * tiles_x + x / kTileEdge, kind,
            part_bits(x % kTileEdge) | (part_bits(y % kTileEdge) << 1)};
}

/// A point of a texel on a triangle.
struct TexelPoint {
    uint32_t triangle;
    float u, v;
};

/// Ray origin of a position, and what stands for it while a switchable solid covers it.
struct Spot {
    Vec3 origin{0.0f};
    Vec3 plane{0.0f};       ///< geometric normal
    bool is_pushed = false; ///< lies beside its texel, out of a thing that stands on it
    MovedPosition moved{};
    /// Where it is while all switchable things are there.
    const Vec3& shown() const { return moved.exists() ? moved.origin : origin; }
};
using Spots = std::vector<Spot>; ///< of one texel

struct Builder {
    const Snapshot& scene;
    const Tracer& tracer;
    const Coverage& coverage;
    PushOut push_out;
    SwitchSolids solids;
    std::vector<std::pair<uint32_t, uint32_t>> runs; ///< fragments [begin, end) of each receiver
    std::vector<TexelKind> kind;                     ///< [receivers]
    std::vector<Spots> moved;                        ///< [receivers] those with a moved position; empty without solids
    std::vector<std::vector<Vec3>> planes;           ///< [receivers] geometric normals where the shading normal leans
    LightmapReceivers out;
    std::atomic<uint64_t> pushed{0}, clamped{0};

    void order();
    void build(uint32_t receiver);
    TexelPoint point(uint32_t receiver, Vec2 u) const;
    TexelPoint sub_texel(uint32_t receiver, uint32_t k, uint32_t base) const;
    TexelPoint on_triangle(uint32_t triangle, const Vec2& p) const;
    Vec2 texel_corner(const Fragment& f) const;
    float depth_inside(uint32_t triangle, const Vec2& p) const;
    Vec3 smooth_position(const TexelPoint& p) const;
    Spot spot_at(uint32_t receiver, const TexelPoint& point);
    bool is_covered(uint32_t receiver, const Spot& spot) const;
    Spots scattered_spots(uint32_t receiver, uint32_t base);
    void leave_covered(uint32_t receiver, uint32_t base, Spots& spots);
    void keep_one_side(uint32_t receiver, uint32_t base, Spots& spots);
    bool is_before_sheet(uint32_t receiver, const Spot& a, const Spot& b) const;
    bool is_open(uint32_t receiver, const Spots& spots) const;
    void join_moved();
    void join_planes();
    void find_sharing(const Tile& tile);
    Vec3 look_out(uint32_t receiver) const;
    bool is_walled_off(uint32_t receiver, uint32_t from) const;
    uint32_t stand_in(uint32_t receiver) const;
    void set_frame(uint32_t receiver);
    void set_albedo(uint32_t receiver);
};

void Builder::order() {
    struct Entry {
        TexelKey key;
        uint32_t begin, end;
    };
    std::vector<Entry> entries;
    std::vector<uint32_t> first_tile(scene.pages.size(), 0);
    for (size_t p = 1; p < scene.pages.size(); ++p) {
        const Page& before = scene.pages[p - 1];
        first_tile[p] = first_tile[p - 1] +
                        ((before.width + kTileEdge - 1) / kTileEdge) * ((before.height + kTileEdge - 1) / kTileEdge);
    }
    const auto& f = coverage.fragments;
    const TexelKinds kinds(scene, coverage);
    for (uint32_t begin = 0, end; begin < f.size(); begin = end) {
        for (end = begin + 1; end < f.size() && f[end].texel == f[begin].texel;) ++end;
        const uint32_t page = scene.instance_of(f[begin].triangle).page;
        entries.push_back({key_of(scene, page, f[begin].texel, kinds.of(f[begin]), first_tile[page]), begin, end});
    }
    std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.key < b.key; });
    for (size_t i = 0; i < entries.size(); ++i) {
        if (i == 0 || entries[i].key.tile != entries[i - 1].key.tile)
            out.tiles.push_back({static_cast<uint32_t>(i), 0});
        ++out.tiles.back().count;
        runs.emplace_back(entries[i].begin, entries[i].end);
        out.texel.push_back(f[entries[i].begin].texel);
        kind.push_back(entries[i].key.kind);
    }
}

/// Picks a fragment by area, then a point of its polygon inside the texel.
TexelPoint Builder::point(uint32_t receiver, Vec2 u) const {
    const auto [begin, end] = runs[receiver];
    float total = 0.0f;
    for (uint32_t i = begin; i < end; ++i) total += coverage.fragments[i].area;
    float left = u.x * total;
    uint32_t i = begin;
    while (i + 1 < end && left >= coverage.fragments[i].area) left -= coverage.fragments[i++].area;
    const Fragment& f = coverage.fragments[i];
    u.x = std::min(left / f.area, 0x1.fffffep-1f);
    const Vec2 low = texel_corner(f);
    if (!f.ring && f.area > kFullArea) return on_triangle(f.triangle, low + u);
    const float margin = f.ring ? 0.5f : 0.0f;
    return on_triangle(f.triangle,
                       clip_to_box(texel_triangle(scene, f.triangle), low - margin, low + 1.0f + margin).sample(u));
}

Vec2 Builder::texel_corner(const Fragment& f) const {
    const auto [x, y] = place_of(scene.pages[scene.instance_of(f.triangle).page], f.texel);
    return {x, y};
}

TexelPoint Builder::on_triangle(uint32_t triangle, const Vec2& p) const {
    const auto t = texel_triangle(scene, triangle);
    const Vec2 a = t[1] - t[0], b = t[2] - t[0], c = p - t[0];
    const float det = a.x * b.y - a.y * b.x;
    const float bu = std::clamp((c.x * b.y - c.y * b.x) / det, 0.0f, 1.0f);
    return {triangle, bu, std::clamp((a.x * c.y - a.y * c.x) / det, 0.0f, 1.0f - bu)};
}

/// Position k of the texel. A fully covered texel is split into equal cells whose centres integrate
/// any linear change of light exactly; at chart borders scattered points do.
TexelPoint Builder::sub_texel(uint32_t receiver, uint32_t k, uint32_t base) const {
    const auto [begin, end] = runs[receiver];
    const uint32_t columns = grid_columns(out.positions_per_texel), rows = out.positions_per_texel / columns;
    if (out.whole[receiver] == 0) return point(receiver, owen_sobol(k, base));
    const Vec2 cell((static_cast<float>(k % columns) + 0.5f) / static_cast<float>(columns),
                    (static_cast<float>(k / columns) + 0.5f) / static_cast<float>(rows));
    const Vec2 p = texel_corner(coverage.fragments[begin]) + cell;
    uint32_t best = begin;
    for (uint32_t i = begin; i < end; ++i)
        if (depth_inside(coverage.fragments[i].triangle, p) > depth_inside(coverage.fragments[best].triangle, p))
            best = i;
    return on_triangle(coverage.fragments[best].triangle, p);
}

/// Smallest barycentric weight of p; negative outside the triangle.
float Builder::depth_inside(uint32_t triangle, const Vec2& p) const {
    const auto t = texel_triangle(scene, triangle);
    const Vec2 a = t[1] - t[0], b = t[2] - t[0], c = p - t[0];
    const float det = a.x * b.y - a.y * b.x;
    const float u = (c.x * b.y - c.y * b.x) / det, v = (a.x * c.y - a.y * c.x) / det;
    return std::min({u, v, 1.0f - u - v});
}

// Hanika 2021, "Hacking the shadow terminator": on the smooth surface that the normals describe,
// the point lies further out; only outward moves are taken.
Vec3 Builder::smooth_position(const TexelPoint& p) const {
    const Triangle& t = scene.triangles[p.triangle];
    const Vec3 flat = scene.position(p.triangle, p.u, p.v);
    if (scene.is_flat(p.triangle)) return flat;
    const float weight[3] = {1.0f - p.u - p.v, p.u, p.v};
    Vec3 moved(0.0f);
    for (int k = 0; k < 3; ++k) {
        const Vec3 n = scene.corner_normal(p.triangle, k);
        moved += weight[k] * (flat - n * glm::dot(flat - scene.positions[t.vertex[k]], n));
    }
    const Vec3 n = scene.geometric_normal(p.triangle);
    const float outward = glm::dot(moved - flat, n);
    return outward > 0.0f ? flat + n * outward : flat;
}

/// Where a ray that stands for a point of the texel starts.
Spot Builder::spot_at(uint32_t r, const TexelPoint& p) {
    Spot s;
    s.plane = scene.geometric_normal(p.triangle);
    s.origin = tracer.offset(smooth_position(p), s.plane);
    uint64_t moves = 0;
    s.origin = push_out.out_of_the_dark(s.origin, out.frame[r], out.texel_size[r], moves);
    s.is_pushed = moves != 0;
    if (s.is_pushed) pushed.fetch_add(moves, std::memory_order_relaxed);
    if (!solids.empty()) s.moved = solids.move_out(s.origin, out.frame[r], out.texel_size[r]);
    return s;
}

/// Whether something hangs low over a position. What stands upright, as a wall does at the edge of a floor, does not.
bool Builder::is_covered(uint32_t r, const Spot& s) const {
    const Vec3 up = out.frame[r].z * (kLowCover * out.texel_size[r]);
    const Hit hit = tracer.intersect({s.origin, up, 0.0f, 1.0f}, kMaskGather);
    return hit.triangle != kMiss && std::abs(glm::dot(scene.geometric_normal(hit.triangle), out.frame[r].z)) > kUpright;
}

/// More points of a texel.
Spots Builder::scattered_spots(uint32_t r, uint32_t base) {
    Spots all;
    for (uint32_t k = 0; k < kSidePoints; ++k) all.push_back(spot_at(r, point(r, owen_sobol(k, hash32(base)))));
    return all;
}

/// What lies under a decal, a foot or a lamp close to the surface is not seen, but its darkness or glare would
/// show in the whole texel: its positions are in the open, where it has such.
void Builder::leave_covered(uint32_t r, uint32_t base, Spots& spots) {
    if (std::none_of(spots.begin(), spots.end(), [&](const Spot& s) { return is_covered(r, s); })) return;
    Spots open;
    for (const Spots& some : {spots, scattered_spots(r, base)})
        for (const Spot& s : some)
            if (!is_covered(r, s)) open.push_back(s);
    if (open.empty()) return;
    for (size_t k = 0; k < spots.size(); ++k) spots[k] = open[k * open.size() / spots.size()];
}

/// Light on the two sides of a wall must not mix in one texel: where its positions do not see each other,
/// all are taken from the largest of the parts that a wall cuts it into, or from the one before a wall without
/// thickness, where people look at it, unless that is small.
void Builder::keep_one_side(uint32_t r, uint32_t base, Spots& spots) {
    const size_t n = spots.size();
    const Vec3 up = out.frame[r].z * (kSideHeight * out.texel_size[r]);
    const auto sees = [&](const Spot& a, const Spot& b) {
        return !tracer.occluded({a.shown() + up, b.shown() - a.shown(), 0.0f, 1.0f}, kMaskWall);
    };
    uint32_t seen = 1;
    for (size_t b = 1; b < n; ++b) seen += sees(spots[0], spots[b]);
    if (seen == n) return;
    out.cut[r] = 1;
    Spots points = spots, best, side;
    for (const Spot& s : scattered_spots(r, base)) points.push_back(s);
    const auto is_large = [&](const Spots& part) {
        const auto own = std::count_if(part.begin(), part.end(), [](const Spot& s) { return !s.is_pushed; });
        return static_cast<float>(own) >= kLargePart * static_cast<float>(points.size());
    };
    for (const Spot& a : points) {
        side.clear();
        for (const Spot& b : points)
            if (&a == &b || sees(a, b)) side.push_back(b);
        const bool before = !best.empty() && is_large(side) && is_before_sheet(r, side[0], best[0]),
                   behind = !best.empty() && is_large(best) && is_before_sheet(r, best[0], side[0]);
        if (before || (!behind && side.size() > best.size())) best = side;
    }
    for (size_t k = 0; k < n; ++k) spots[k] = best[k * best.size() / n];
}

/// Whether the way from a to b leads first through the front of a wall, and the way back through its back.
bool Builder::is_before_sheet(uint32_t r, const Spot& a, const Spot& b) const {
    const Vec3 up = out.frame[r].z * (kSideHeight * out.texel_size[r]), way = b.shown() - a.shown();
    const Hit there = tracer.intersect({a.shown() + up, way, 0.0f, 1.0f}, kMaskGather);
    return there.triangle != kMiss && !there.back &&
           tracer.intersect({b.shown() + up, -way, 0.0f, 1.0f}, kMaskGather).back;
}

/// A wall between two texels of a block ends all sharing in it. What is far from all blocks of charts takes the
/// coarse light of a neighbour.
void Builder::find_sharing(const Tile& tile) {
    for (uint32_t r = tile.first; r < tile.first + tile.count; ++r) {
        out.shares[r] = 1;
        out.coarse_from[r] = kind[r] == TexelKind::apart ? stand_in(r) : r;
        for (const uint32_t q : block_of(scene, out, r))
            if (q != r && is_walled_off(r, q)) out.shares[r] = 0;
    }
}

/// Where a receiver looks at others from, above whatever lies on the surface.
Vec3 Builder::look_out(uint32_t r) const {
    return out.shown_origin(r) + out.frame[r].z * (kSideHeight * out.texel_size[r]);
}

bool Builder::is_walled_off(uint32_t r, uint32_t q) const {
    return tracer.occluded({look_out(r), look_out(q) - look_out(r), 0.0f, 1.0f}, kMaskWall);
}

/// The receiver on a chart next to one of the ring: of those that it sees the one that faces most the same way, the
/// nearest of several.
uint32_t Builder::stand_in(uint32_t r) const {
    const Page& page = scene.pages[scene.instance_of(out.triangle[r]).page];
    const auto [x, y] = place_of(page, out.texel[r]);
    uint32_t best = r;
    std::tuple<bool, float, float> best_rank{};
    TexelSquare(page, x - 1, y - 1, 3).each(page, [&](uint64_t t) {
        const uint32_t q = out.of_texel[t];
        if (q == kNoReceiver || kind[q] != TexelKind::on_chart) return;
        const Vec3 to = look_out(q) - look_out(r);
        const std::tuple rank{!is_walled_off(r, q), std::round(8.0f * glm::dot(out.frame[q].z, out.frame[r].z)),
                              -glm::dot(to, to)};
        if (best != r && rank <= best_rank) return;
        best = q, best_rank = rank;
    });
    return best;
}

void Builder::set_frame(uint32_t r) {
    const auto [begin, end] = runs[r];
    uint32_t best = begin;
    for (uint32_t i = begin; i < end; ++i)
        if (coverage.fragments[i].area > coverage.fragments[best].area) best = i;
    const uint32_t triangle = coverage.fragments[best].triangle;
    const auto uv = texel_triangle(scene, triangle);
    const Triangle& t = scene.triangles[triangle];
    const Vec2 a = uv[1] - uv[0], b = uv[2] - uv[0];
    const float det = a.x * b.y - a.y * b.x;
    const Vec3 ea = scene.positions[t.vertex[1]] - scene.positions[t.vertex[0]],
               eb = scene.positions[t.vertex[2]] - scene.positions[t.vertex[0]];
    const Vec3 du = (ea * b.y - eb * a.y) / det, dv = (eb * a.x - ea * b.x) / det;
    Vec3 normal(0.0f);
    for (uint32_t k = 0; k < 4; ++k) {
        const TexelPoint p =
            point(r, {(static_cast<float>(k) + 0.5f) / 4.0f, static_cast<float>(k & 1) * 0.5f + 0.25f});
        normal += scene.shading_normal(p.triangle, p.u, p.v);
    }
    const Vec3 n = normalize_or(normal, scene.geometric_normal(triangle));
    out.triangle[r] = triangle;
    out.frame[r] = frame_from_tangent(n, du, glm::dot(glm::cross(n, du), dv) < 0.0f ? -1.0f : 1.0f);
    out.texel_size[r] = std::sqrt(2.0f * scene.area(triangle) / std::abs(det));
    out.ring[r] = coverage.fragments[begin].ring;
    float covered = 0.0f;
    for (uint32_t i = begin; i < end; ++i) covered += coverage.fragments[i].ring ? 0.0f : coverage.fragments[i].area;
    out.whole[r] = std::abs(covered - 1.0f) <= 1e-3f;
    out.full[r] = end - begin == 1 && !coverage.fragments[begin].ring && coverage.fragments[begin].area > kFullArea;
}

void Builder::set_albedo(uint32_t r) {
    Vec3 sum(0.0f);
    for (int k = 0; k < kAlbedoSamples; ++k) {
        const TexelPoint p =
            point(r, {(static_cast<float>(k) + 0.5f) / kAlbedoSamples, unit_float(hash_combine(out.texel[r], k))});
        sum += scene.surface(p.triangle, p.u, p.v).reflectance;
    }
    out.albedo[r] = sum / static_cast<float>(kAlbedoSamples);
    if (max_component(out.albedo[r]) >= kMaxReflectance - 1e-4f) clamped.fetch_add(1, std::memory_order_relaxed);
}

void Builder::build(uint32_t r) {
    set_frame(r);
    set_albedo(r);
    const uint32_t base = hash_combine(kPositionSalt, out.texel[r]);
    Spots spots;
    for (uint32_t k = 0; k < out.positions_per_texel; ++k) spots.push_back(spot_at(r, sub_texel(r, k, base)));
    leave_covered(r, base, spots);
    keep_one_side(r, base, spots);
    for (size_t k = 0; k < spots.size(); ++k) out.positions[size_t{r} * spots.size() + k] = spots[k].origin;
    const auto leans = [&](const Spot& s) { return !(glm::dot(s.plane, out.frame[r].z) >= kLean); };
    if (std::any_of(spots.begin(), spots.end(), leans))
        for (const Spot& s : spots) planes[r].push_back(s.plane);
    out.open[r] = is_open(r, spots);
    const auto is_moved = [](const Spot& s) { return s.moved.exists(); };
    if (std::any_of(spots.begin(), spots.end(), is_moved)) moved[r] = std::move(spots);
}

/// Whether the positions are the middles of equal cells of one plane, whose outer corners see each other and are not
/// covered.
bool Builder::is_open(uint32_t r, const Spots& spots) const {
    const uint32_t columns = grid_columns(out.positions_per_texel), rows = out.positions_per_texel / columns;
    if (columns < 2 || rows < 2 || out.whole[r] == 0 || out.cut[r] != 0) return false;
    const auto [begin, end] = runs[r];
    const Vec3 n = scene.geometric_normal(out.triangle[r]);
    for (uint32_t i = begin; i < end; ++i)
        if (glm::dot(scene.geometric_normal(coverage.fragments[i].triangle), n) < kFlat) return false;
    const Vec3 x = spots[1].origin - spots[0].origin, y = spots[columns].origin - spots[0].origin;
    for (uint32_t k = 0; k < spots.size(); ++k) {
        const Vec3 expected =
            spots[0].origin + static_cast<float>(k % columns) * x + static_cast<float>(k / columns) * y;
        if (spots[k].moved.exists() || glm::distance(spots[k].origin, expected) > kUneven * out.texel_size[r])
            return false;
    }
    const Vec3 up = out.frame[r].z * (kSideHeight * out.texel_size[r]);
    const Vec3 low = spots[0].origin - 0.49f * (x + y), high = spots.back().origin + 0.49f * (x + y);
    const Vec3 side = spots[0].origin + (static_cast<float>(columns) - 0.51f) * x - 0.49f * y;
    const Spot corners[4] = {{low}, {side}, {high}, {low + high - side}};
    for (int k = 0; k < 4; ++k) {
        const Vec3 a = corners[k].origin, b = corners[(k + 1) % 4].origin;
        if (is_covered(r, corners[k]) || tracer.occluded({a + up, b - a, 0.0f, 1.0f}, kMaskWall)) return false;
    }
    return true;
}

/// Rows of the receivers with moved positions, in their order.
void Builder::join_moved() {
    if (std::all_of(moved.begin(), moved.end(), [](const Spots& s) { return s.empty(); })) return;
    out.moved_row.assign(moved.size(), kNoReceiver);
    uint32_t rows = 0;
    for (size_t r = 0; r < moved.size(); ++r) {
        if (moved[r].empty()) continue;
        out.moved_row[r] = rows++;
        for (const Spot& s : moved[r]) out.moved.push_back(s.moved);
    }
}

/// Rows of the receivers that lean, in their order.
void Builder::join_planes() {
    if (std::all_of(planes.begin(), planes.end(), [](const auto& p) { return p.empty(); })) return;
    out.plane_row.assign(planes.size(), kNoReceiver);
    uint32_t rows = 0;
    for (size_t r = 0; r < planes.size(); ++r) {
        if (planes[r].empty()) continue;
        out.plane_row[r] = rows++;
        out.planes.insert(out.planes.end(), planes[r].begin(), planes[r].end());
    }
}

void warn_about_uvs(const Snapshot& scene, const Coverage& coverage, std::vector<Warning>& warnings) {
    std::vector<uint32_t> overlaps(scene.instances.size(), 0);
    const auto& f = coverage.fragments;
    for (size_t begin = 0, end; begin < f.size(); begin = end) {
        float area = 0.0f;
        for (end = begin; end < f.size() && f[end].texel == f[begin].texel; ++end)
            area += f[end].ring ? 0.0f : f[end].area;
        if (area < kOverlapArea) continue;
        for (size_t i = begin; i < end; ++i)
            if (i == begin || scene.triangles[f[i].triangle].instance != scene.triangles[f[i - 1].triangle].instance)
                ++overlaps[scene.triangles[f[i].triangle].instance];
    }
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const std::string& name = scene.instances[i].name;
        if (overlaps[i] != 0)
            warnings.push_back({name, "lightmap UVs overlap in " + std::to_string(overlaps[i]) +
                                          " texels, which share their light; unwrap it again with Prepare UVs"});
        if (coverage.outside_triangles[i] != 0)
            warnings.push_back({name, std::to_string(coverage.outside_triangles[i]) +
                                          " triangles have lightmap UVs outside the page and are not lit there; unwrap "
                                          "it again with Prepare UVs"});
        if (coverage.flat_uv_triangles[i] != 0)
            warnings.push_back({name, std::to_string(coverage.flat_uv_triangles[i]) +
                                          " triangles have no area in the lightmap UVs and store no light"});
    }
}

/// Objects most of whose texels reflect more than can be allowed.
void warn_about_albedo(const Snapshot& scene, const LightmapReceivers& receivers, std::vector<Warning>& warnings) {
    std::vector<uint32_t> all(scene.instances.size(), 0), clamped(scene.instances.size(), 0);
    for (uint32_t r = 0; r < receivers.count(); ++r) {
        const uint32_t i = scene.triangles[receivers.triangle[r]].instance;
        ++all[i];
        clamped[i] += max_component(receivers.albedo[r]) >= kMaxReflectance - 1e-4f;
    }
    for (size_t i = 0; i < all.size(); ++i)
        if (2 * clamped[i] > all[i])
            warnings.push_back({scene.instances[i].name,
                                "reflects nearly all light; its reflectance is limited to 0.95, darken its material "
                                "for a faithful bake"});
}

} // namespace

Block block_of(const Snapshot& scene, const LightmapReceivers& receivers, uint32_t r) {
    const Page& page = scene.pages[scene.instance_of(receivers.triangle[r]).page];
    const auto [x, y] = place_of(page, receivers.texel[r]);
    Block block;
    TexelSquare(page, x & ~1, y & ~1, 2).each(page, [&](uint64_t t) {
        const uint32_t q = receivers.of_texel[t];
        if (q != kNoReceiver) block.members[block.count++] = q;
    });
    return block;
}

TileParts split(const LightmapReceivers& receivers, const Tile& tile) {
    const auto begin = receivers.ring.begin() + tile.first, end = begin + tile.count;
    const auto on_charts = static_cast<uint32_t>(std::find(begin, end, uint8_t{1}) - begin);
    const uint32_t own = std::min((on_charts + kLanes - 1) / kLanes * kLanes, tile.count);
    uint32_t coarse = on_charts;
    while (coarse < tile.count && receivers.coarse_from[tile.first + coarse] == tile.first + coarse) ++coarse;
    return {{tile.first, own}, {tile.first + own, tile.count - own}, {tile.first, coarse}, on_charts};
}

LightmapReceivers make_receivers(const Snapshot& scene, const Tracer& tracer, const Coverage& coverage,
                                 const std::vector<Behind>& behind, uint32_t positions_per_texel, ThreadPool& pool,
                                 Progress& progress, std::vector<Warning>& warnings) {
    Builder b{scene, tracer, coverage, PushOut(scene, tracer, behind), SwitchSolids(scene, tracer, behind), {}, {}, {},
              {},    {},     {}};
    b.order();
    const size_t count = b.runs.size();
    b.out.positions_per_texel = positions_per_texel;
    b.out.triangle.resize(count);
    b.out.frame.resize(count);
    b.out.albedo.resize(count);
    b.out.texel_size.resize(count);
    b.out.ring.resize(count);
    b.out.full.resize(count);
    b.out.cut.resize(count);
    b.out.whole.resize(count);
    b.out.open.resize(count);
    b.out.of_texel.assign(scene.texel_count(), kNoReceiver);
    for (uint32_t r = 0; r < count; ++r) b.out.of_texel[b.out.texel[r]] = r;
    b.out.positions.resize(count * positions_per_texel);
    if (!b.solids.empty()) b.moved.resize(count);
    b.planes.resize(count);
    pool.for_each(b.out.tiles.size(), progress, [&](size_t i) {
        for (uint32_t r = b.out.tiles[i].first; r < b.out.tiles[i].first + b.out.tiles[i].count; ++r) b.build(r);
    });
    b.join_moved();
    b.join_planes();
    b.out.shares.resize(count);
    b.out.coarse_from.resize(count);
    pool.for_each(b.out.tiles.size(), progress, [&](size_t i) { b.find_sharing(b.out.tiles[i]); });
    b.out.pushed_positions = b.pushed;
    b.out.clamped_albedo = b.clamped;
    warn_about_uvs(scene, coverage, warnings);
    warn_about_albedo(scene, b.out, warnings);
    return std::move(b.out);
}

} // namespace ajar
