// SPDX-License-Identifier: GPL-3.0-or-later
#include "pass/bright_patches.h"

#include <algorithm>
#include <unordered_map>

namespace ajar {

namespace {

constexpr double kBrightFactor = 6.0; ///< of the mean radiance; brighter texels are aimed at
constexpr float kLeastArea = 0.05f;   ///< texels; smaller parts of a texel are left to the gather rays

/// share: see BrightTexels.
std::vector<uint32_t> bright_receivers(const Snapshot& scene, const LightmapReceivers& receivers,
                                       const std::vector<float>& luminance_of, double& share) {
    double sum = 0.0, weight = 0.0, bright = 0.0;
    const auto area = [&](uint32_t r) { return double(receivers.texel_size[r]) * receivers.texel_size[r]; };
    for (uint32_t r = 0; r < receivers.count(); ++r) sum += area(r) * luminance_of[r], weight += area(r);
    const auto threshold = static_cast<float>(kBrightFactor * sum / std::max(weight, 1e-30));
    std::vector<uint32_t> out;
    for (uint32_t r = 0; r < receivers.count(); ++r)
        if (receivers.ring[r] == 0 && receivers.cut[r] == 0 && luminance_of[r] > threshold &&
            scene.is_gathered(receivers.triangle[r])) {
            out.push_back(r);
            bright += area(r) * luminance_of[r];
        }
    share = bright / std::max(sum, 1e-30);
    return out;
}

/// A triangle's plane in texels of its page.
BrightPatch plane_of(const Snapshot& scene, uint32_t triangle) {
    const Triangle& t = scene.triangles[triangle];
    const auto uv = texel_triangle(scene, triangle);
    const Vec2 a = uv[1] - uv[0], b = uv[2] - uv[0];
    const float det = a.x * b.y - a.y * b.x;
    const Vec3 origin = scene.positions[t.vertex[0]], ea = scene.positions[t.vertex[1]] - origin,
               eb = scene.positions[t.vertex[2]] - origin;
    BrightPatch out{};
    out.triangle = triangle;
    out.edge_x = (ea * b.y - eb * a.y) / det;
    out.edge_y = (eb * a.x - ea * b.x) / det;
    out.origin = origin - out.edge_x * uv[0].x - out.edge_y * uv[0].y;
    out.normal = scene.geometric_normal(triangle);
    out.presence = scene.presence(triangle);
    return out;
}

/// Patches of a scene's triangles on the texels of bright receivers, [receiver].
struct PatchFinder {
    const Snapshot& scene;
    std::vector<std::vector<BrightPatch>> found;
    std::vector<std::unordered_map<uint32_t, uint32_t>> on_page = {}; ///< texel of the page: which of the receivers

    PatchFinder(const Snapshot& s, const LightmapReceivers& receivers, const std::vector<uint32_t>& bright)
        : scene(s), found(bright.size()), on_page(s.pages.size()) {
        for (uint32_t i = 0; i < bright.size(); ++i) {
            const uint32_t page = s.instance_of(receivers.triangle[bright[i]]).page;
            on_page[page].emplace(receivers.texel[bright[i]] - s.pages[page].first_texel, i);
        }
    }
    void add(uint32_t triangle) {
        const Instance& instance = scene.instance_of(triangle);
        if (!instance.lightmapped || on_page[instance.page].empty() || !scene.is_gathered(triangle)) return;
        const auto uv = texel_triangle(scene, triangle);
        const Page& page = scene.pages[instance.page];
        const Vec2 low = glm::min(uv[0], glm::min(uv[1], uv[2])), high = glm::max(uv[0], glm::max(uv[1], uv[2]));
        for_each_texel(page, low, high, [&](uint32_t i, const Vec2& corner) {
            const TexelPolygon shape = clip_to_box(uv, corner, corner + 1.0f);
            if (shape.area() < kLeastArea) return;
            BrightPatch patch = plane_of(scene, triangle);
            patch.shape = shape;
            found[i].push_back(patch);
        });
    }
    /// Bright texels of a box, by walking over whichever is fewer: its texels or the page's bright ones.
    template <class Do>
    void for_each_texel(const Page& page, const Vec2& low, const Vec2& high, const Do& run) {
        const auto& texels = on_page[static_cast<size_t>(&page - scene.pages.data())];
        const auto in_box = [&](const Vec2& c) {
            return c.x + 1.0f > low.x && c.y + 1.0f > low.y && c.x < high.x && c.y < high.y;
        };
        const Vec2 size = high - low + 1.0f;
        if (size.x * size.y > static_cast<float>(texels.size())) {
            for (const auto& [texel, i] : texels)
                if (const Vec2 c(texel % page.width, texel / page.width); in_box(c)) run(i, c);
            return;
        }
        for (float y = std::floor(low.y); y < high.y; ++y)
            for (float x = std::floor(low.x); x < high.x; ++x)
                if (const auto it = texels.find(static_cast<uint32_t>(y) * page.width + static_cast<uint32_t>(x));
                    it != texels.end())
                    run(it->second, {x, y});
    }
};

} // namespace

BrightTexels find_bright_texels(const Snapshot& scene, const LightmapReceivers& receivers,
                                const std::function<Vec3(uint32_t)>& radiance_of, double least_share) {
    BrightTexels out;
    std::vector<float> luminance_of;
    for (uint32_t r = 0; r < receivers.count(); ++r) luminance_of.push_back(luminance(radiance_of(r)));
    const std::vector<uint32_t> bright = bright_receivers(scene, receivers, luminance_of, out.share);
    if (bright.empty() || out.share < least_share) return out;
    PatchFinder finder(scene, receivers, bright);
    for (uint32_t t = 0; t < scene.triangles.size(); ++t) finder.add(t);
    for (size_t i = 0; i < bright.size(); ++i) {
        if (finder.found[i].empty()) continue;
        out.receivers.push_back(bright[i]);
        const Vec3 radiance = radiance_of(bright[i]);
        for (BrightPatch& p : finder.found[i]) {
            p.texel = receivers.texel[bright[i]];
            p.radiance = radiance;
            out.patches.push_back(p);
        }
    }
    return out;
}

} // namespace ajar
