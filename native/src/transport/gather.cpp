// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "transport/unmapped_chain.h"

namespace ajar {

uint32_t texel_on_side(const GatherScene& g, uint32_t triangle, uint32_t texel, const Vec3& p) {
    const Page& page = g.scene.pages[g.scene.instance_of(triangle).page];
    const auto local = static_cast<uint32_t>(texel - page.first_texel);
    const uint32_t x = local % page.width, y = local / page.width;
    const uint32_t own = g.receivers.of_texel[texel];
    const Vec3 up = g.receivers.frame[own].z * (kSideHeight * g.receivers.texel_size[own]);
    struct Near {
        float distance; ///< m^2
        uint32_t texel, receiver;
        bool operator<(const Near& other) const {
            return distance < other.distance || (distance == other.distance && texel < other.texel);
        }
    } near[9];
    size_t count = 0;
    for (uint32_t ny = std::max(y, 1u) - 1; ny <= std::min(y + 1, page.height - 1); ++ny)
        for (uint32_t nx = std::max(x, 1u) - 1; nx <= std::min(x + 1, page.width - 1); ++nx) {
            const auto t = static_cast<uint32_t>(page.first_texel + ny * page.width + nx);
            const uint32_t r = g.receivers.of_texel[t];
            if (r == kNoReceiver || glm::dot(g.receivers.frame[r].z, g.receivers.frame[own].z) < 0.5f) continue;
            const Vec3 to = g.receivers.shown_origin(r) - p;
            near[count++] = {glm::dot(to, to), t, r};
        }
    for (; count > 0; --count) {
        Near& next = *std::min_element(near, near + count);
        const Ray to{p + up, g.receivers.shown_origin(next.receiver) - p, 0.0f, 1.0f};
        if (!g.tracer.occluded(to, kMaskWall)) return next.texel;
        next = near[count - 1];
    }
    return texel;
}

uint64_t gather_tile(const GatherScene& scene, const Tile& tile, const GatherOptions& options, const Vec4* radiance,
                     TileSums& sums) {
    return run_gather(scene, tile, options, PlainSink(radiance, sums));
}

uint64_t gather_tile(const GatherScene& scene, const Tile& tile, const GatherOptions& options, const TermRows* rows,
                     const TermLimits& limits, TermSums& sums) {
    if (scene.scene.has_switches())
        return run_gather(scene, tile, options, TermSink<true>(scene.scene, rows, limits, sums));
    return run_gather(scene, tile, options, TermSink<false>(scene.scene, rows, limits, sums));
}

} // namespace ajar
