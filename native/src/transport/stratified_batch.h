// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <vector>

#include "base/owen_sobol.h"
#include "receiver/lightmap.h"

namespace ajar {

/// A batch of samples of all receivers of a tile, sorted into strata: [stratum][receiver].
struct StratifiedBatch {
    static constexpr uint32_t kRays = 256; ///< rays per receiver whose strata are visited together
    std::vector<float> x, y;

    /// A block of count samples holds one point per cell of a grid; cells are visited in Morton
    /// order, so that neighbours in the order are neighbours on the hemisphere.
    void fill(const LightmapReceivers& receivers, const Tile& tile, uint32_t first_sample, uint32_t count,
              uint32_t seed) {
        x.resize(size_t{count} * kTileReceivers);
        y.resize(size_t{count} * kTileReceivers);
        const auto log2 = static_cast<uint32_t>(std::countr_zero(count));
        const auto nx = static_cast<float>(1u << ((log2 + 1) / 2)), ny = static_cast<float>(1u << (log2 / 2));
        for (uint32_t i = 0; i < kTileReceivers; ++i) {
            const uint32_t h = hash_combine(seed, i < tile.count ? receivers.texel[tile.first + i] : 0u);
            for (uint32_t s = 0; s < count; ++s) {
                const Vec2 u = owen_sobol(first_sample + s, h);
                const auto cx = static_cast<uint32_t>(u.x * nx), cy = static_cast<uint32_t>(u.y * ny);
                // Grids twice as wide as high interleave the extra column bit last.
                const uint32_t cell = log2 & 1 ? morton2(cx >> 1, cy) * 2 + (cx & 1) : morton2(cx, cy);
                x[size_t{cell} * kTileReceivers + i] = u.x;
                y[size_t{cell} * kTileReceivers + i] = u.y;
            }
        }
    }

private:
    static uint32_t morton2(uint32_t x, uint32_t y) {
        const auto spread = [](uint32_t v) {
            v = (v | (v << 4)) & 0x0f0fu;
            v = (v | (v << 2)) & 0x3333u;
            return (v | (v << 1)) & 0x5555u;
        };
        return spread(x) | (spread(y) << 1);
    }
};

} // namespace ajar
