// SPDX-License-Identifier: GPL-3.0-or-later
#include "receiver/uv_raster.h"

#include <atomic>

namespace ajar {

namespace {

/// Keeps the side where sign * (corner[axis] - limit) <= 0 (Sutherland and Hodgman 1974).
TexelPolygon clip(const TexelPolygon& in, int axis, float limit, float sign) {
    TexelPolygon out;
    for (int i = 0; i < in.count; ++i) {
        const Vec2 a = in.corner[i], b = in.corner[(i + 1) % in.count];
        const float da = sign * (a[axis] - limit), db = sign * (b[axis] - limit);
        if (da <= 0.0f) out.corner[out.count++] = a;
        if ((da < 0.0f && db > 0.0f) || (da > 0.0f && db < 0.0f))
            out.corner[out.count++] = a + (b - a) * (da / (da - db));
    }
    return out;
}

float cross2(const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; }

bool inside(const std::array<Vec2, 3>& t, const Vec2& p) {
    const float a = cross2(t[1] - t[0], p - t[0]), b = cross2(t[2] - t[1], p - t[1]), c = cross2(t[0] - t[2], p - t[2]);
    return (a >= 0.0f && b >= 0.0f && c >= 0.0f) || (a <= 0.0f && b <= 0.0f && c <= 0.0f);
}

struct TexelRange {
    int x0, y0, x1, y1; ///< half open
};

TexelRange texels_of(const std::array<Vec2, 3>& t, const Page& page, float margin) {
    const Vec2 low = glm::min(t[0], glm::min(t[1], t[2])) - margin,
               high = glm::max(t[0], glm::max(t[1], t[2])) + margin;
    const auto limit = [](float v, uint32_t size) {
        return static_cast<int>(std::clamp(v, 0.0f, static_cast<float>(size)));
    };
    return {limit(std::floor(low.x), page.width), limit(std::floor(low.y), page.height),
            limit(std::ceil(high.x), page.width), limit(std::ceil(high.y), page.height)};
}

float square_area(const std::array<Vec2, 3>& t, float x, float y) {
    if (inside(t, {x, y}) && inside(t, {x + 1, y}) && inside(t, {x, y + 1}) && inside(t, {x + 1, y + 1})) return 1.0f;
    return clip_to_box(t, {x, y}, {x + 1, y + 1}).area();
}

constexpr float kSmallestArea = 1e-6f; ///< texels; below it a clipped sliver is rounding

struct PageRaster {
    const Snapshot& scene;
    const Page& page;
    std::vector<uint8_t> covered;
    std::vector<Fragment> fragments;

    PageRaster(const Snapshot& s, const Page& p) : scene(s), page(p), covered(size_t{p.width} * p.height, 0) {}

    void add_squares(uint32_t triangle) {
        const auto t = texel_triangle(scene, triangle);
        const TexelRange r = texels_of(t, page, 0.0f);
        for (int y = r.y0; y < r.y1; ++y)
            for (int x = r.x0; x < r.x1; ++x) {
                const float area = square_area(t, static_cast<float>(x), static_cast<float>(y));
                if (area > kSmallestArea) add(triangle, x, y, area, false);
            }
    }
    void add_tents(uint32_t triangle) {
        const auto t = texel_triangle(scene, triangle);
        const TexelRange r = texels_of(t, page, 0.5f);
        for (int y = r.y0; y < r.y1; ++y)
            for (int x = r.x0; x < r.x1; ++x) {
                if (covered[size_t(y) * page.width + x] == 1) continue;
                const Vec2 center(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
                const float area = clip_to_box(t, center - 1.0f, center + 1.0f).area();
                if (area > kSmallestArea) add(triangle, x, y, area, true);
            }
    }
    void add(uint32_t triangle, int x, int y, float area, bool ring) {
        const size_t local = size_t(y) * page.width + x;
        if (!ring) covered[local] = 1;
        fragments.push_back({static_cast<uint32_t>(page.first_texel + local), triangle, area, ring});
    }
};

} // namespace

float TexelPolygon::area() const {
    float sum = 0.0f;
    for (int i = 2; i < count; ++i) sum += cross2(corner[i - 1] - corner[0], corner[i] - corner[0]);
    return 0.5f * std::abs(sum);
}

Vec2 TexelPolygon::sample(Vec2 u) const {
    float left = u.x * area();
    for (int i = 2; i < count; ++i) {
        const Vec2 a = corner[i - 1] - corner[0], b = corner[i] - corner[0];
        const float part = 0.5f * std::abs(cross2(a, b));
        if (left <= part || i == count - 1) {
            const float root = std::sqrt(part > 0.0f ? std::min(left / part, 1.0f) : 0.0f);
            return corner[0] + root * (a + (b - a) * u.y);
        }
        left -= part;
    }
    return count > 0 ? corner[0] : Vec2(0.0f);
}

TexelPolygon clip_to_box(const std::array<Vec2, 3>& t, const Vec2& low, const Vec2& high) {
    TexelPolygon p;
    for (const Vec2& c : t) p.corner[p.count++] = c;
    p = clip(p, 0, low.x, -1.0f);
    p = clip(p, 0, high.x, 1.0f);
    p = clip(p, 1, low.y, -1.0f);
    return clip(p, 1, high.y, 1.0f);
}

std::array<Vec2, 3> texel_triangle(const Snapshot& scene, uint32_t triangle) {
    return {scene.lightmap_uv(triangle, 0), scene.lightmap_uv(triangle, 1), scene.lightmap_uv(triangle, 2)};
}

Coverage rasterize(const Snapshot& scene, ThreadPool& pool, Progress& progress) {
    Coverage out;
    out.flat_uv_triangles.resize(scene.instances.size());
    out.outside_triangles.resize(scene.instances.size());
    std::vector<std::vector<uint32_t>> by_page(scene.pages.size());
    for (uint32_t i = 0; i < scene.triangles.size(); ++i) {
        const Instance& instance = scene.instance_of(i);
        if (!instance.lightmapped) continue;
        const auto t = texel_triangle(scene, i);
        const Page& page = scene.pages[instance.page];
        for (const Vec2& c : t)
            if (c.x < -0.01f || c.y < -0.01f || c.x > static_cast<float>(page.width) + 0.01f ||
                c.y > static_cast<float>(page.height) + 0.01f) {
                ++out.outside_triangles[scene.triangles[i].instance];
                break;
            }
        if (!(std::abs(cross2(t[1] - t[0], t[2] - t[0])) > 1e-9f))
            ++out.flat_uv_triangles[scene.triangles[i].instance];
        else
            by_page[instance.page].push_back(i);
    }
    std::vector<std::vector<Fragment>> parts(scene.pages.size());
    pool.for_each(scene.pages.size(), progress, [&](size_t p) {
        PageRaster raster(scene, scene.pages[p]);
        for (const uint32_t t : by_page[p]) raster.add_squares(t);
        for (const uint32_t t : by_page[p]) raster.add_tents(t);
        std::stable_sort(raster.fragments.begin(), raster.fragments.end(),
                         [](const Fragment& a, const Fragment& b) { return a.texel < b.texel; });
        parts[p] = std::move(raster.fragments);
    });
    for (auto& part : parts) out.fragments.insert(out.fragments.end(), part.begin(), part.end());
    return out;
}

} // namespace ajar
