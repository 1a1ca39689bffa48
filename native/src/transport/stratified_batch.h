// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <vector>

#include "accel/ray.h"
#include "base/owen_sobol.h"
#include "receiver/lightmap.h"
#include "transport/packet_choice.h"

namespace ajar {

/// A batch of samples of all receivers of a tile, sorted into strata. Samples of a packet's
/// receivers lie together, stratum after stratum.
class StratifiedBatch {
public:
    static constexpr uint32_t kRays = 256; ///< rays per receiver whose strata are visited together

    /// count: a power of two, at most kRays. A block of count samples holds one point per cell of a
    /// grid; cells are visited in Morton order, so that neighbours in the order are neighbours on the
    /// hemisphere.
    /// packets: those that are filled.
    void fill(const LightmapReceivers& receivers, const Tile& tile, uint32_t first_sample, uint32_t count,
              uint32_t seed, PacketChoice packets) {
        row_ = count + 2; // powers of two apart, all rows would want the same lines of the cache
        x_.resize(size_t{row_} * kTileReceivers);
        y_.resize(size_t{row_} * kTileReceivers);
        const auto log2 = static_cast<uint32_t>(std::countr_zero(count));
        const auto nx = static_cast<float>(1u << ((log2 + 1) / 2)), ny = static_cast<float>(1u << (log2 / 2));
        const uint32_t extra = log2 & 1;
        for (uint32_t i = 0; i < (tile.count + kLanes - 1) / kLanes * kLanes; ++i) {
            if (!packets.has(i)) continue;
            const uint32_t h = hash_combine(seed, i < tile.count ? receivers.texel[tile.first + i] : 0u);
            float ux[kRays], uy[kRays];
            uint32_t cell[kRays];
            for (uint32_t s = 0; s < count; ++s) {
                const Vec2 u = owen_sobol(first_sample + s, h);
                const auto cx = static_cast<uint32_t>(static_cast<int32_t>(u.x * nx));
                const auto cy = static_cast<uint32_t>(static_cast<int32_t>(u.y * ny));
                // Grids twice as wide as high interleave the extra column bit last.
                cell[s] = (morton2(cx >> extra, cy) << extra) | (cx & extra);
                ux[s] = u.x, uy[s] = u.y;
            }
            for (uint32_t s = 0; s < count; ++s) {
                const size_t to = index(i, cell[s]);
                x_[to] = ux[s], y_[to] = uy[s];
            }
        }
    }

    /// [kLanes] coordinates of a stratum's points for the receivers from first on.
    const float* x(uint32_t first, uint32_t stratum) const { return &x_[index(first, stratum)]; }
    const float* y(uint32_t first, uint32_t stratum) const { return &y_[index(first, stratum)]; }
    /// Calls for the points of a packet that comes next, if there is one.
    void fetch(uint32_t first, uint32_t stratum) const {
        if (first >= kTileReceivers) return;
        __builtin_prefetch(x(first, stratum));
        __builtin_prefetch(y(first, stratum));
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
    size_t index(uint32_t receiver, uint32_t stratum) const {
        return (size_t{receiver / kLanes} * row_ + stratum) * kLanes + receiver % kLanes;
    }

    uint32_t row_ = 0; ///< strata from one packet of receivers to the next, with a gap
    std::vector<float> x_, y_;
};

} // namespace ajar
