// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "accel/ray.h"
#include "sampling/warp.h"
#include "transport/packet_directions.h"
#include "transport/stratified_batch.h"

namespace ajar {

/// Makes the gather rays of a tile, eight receivers at a time. Everything lies lane by lane, for the
/// compiler to vectorise.
class TileRays {
public:
    TileRays(const LightmapReceivers& receivers, const Tile& tile, float share, uint32_t seed)
        : receivers_(receivers), tile_(tile), share_(share), seed_(seed) {
        for (uint32_t i = 0; i < kTileReceivers; ++i) {
            const Frame& f = receivers.frame[receiver(i)];
            for (int c = 0; c < 3; ++c) frame_[c][i] = f.x[c], frame_[3 + c][i] = f.y[c], frame_[6 + c][i] = f.z[c];
        }
    }

    /// Prepares samples first_sample to first_sample + count of the receivers' sequences, for some
    /// packets.
    void begin(uint32_t first_sample, uint32_t count, uint32_t block, PacketChoice packets) {
        batch_.fill(receivers_, tile_, first_sample, count, seed_, packets);
        // Neighbouring strata visit all positions, and so does each stratum over the batches, in an
        // order that does not follow the sequence.
        for (uint32_t i = 0; i < kTileReceivers; ++i)
            turn_[i] = shuffle_index(block, hash32(receivers_.texel[receiver(i)] ^ seed_)) & 0xffffu;
    }

    /// Rays of one stratum from receivers first to first + kLanes; those past the tile repeat its last. position:
    /// [kLanes] which of its receiver's each starts at.
    void aim(uint32_t first, uint32_t stratum, RayPacket& packet, PacketDirections& local, uint32_t* position) const {
        const float *x = batch_.x(first, stratum), *y = batch_.y(first, stratum);
        for (uint32_t lane = 0; lane < kLanes; ++lane) {
            const Vec3 w = sample_hemisphere({x[lane], y[lane]}, share_);
            local.set(lane, w, 1.0f / hemisphere_pdf(std::max(w.z, 1e-6f), share_));
        }
        batch_.fetch(first + kLanes, stratum);
        turn_to_world(first, local, packet);
        for (uint32_t lane = 0; lane < kLanes; ++lane) {
            position[lane] = (stratum + turn_[first + lane]) % receivers_.positions_per_texel;
            const Vec3& p = receivers_.origins(receiver(first + lane))[position[lane]];
            packet.ox[lane] = p.x, packet.oy[lane] = p.y, packet.oz[lane] = p.z;
            packet.tfar[lane] = std::numeric_limits<float>::infinity();
        }
    }

private:
    uint32_t receiver(uint32_t i) const { return tile_.first + std::min(i, tile_.count - 1); }

    void turn_to_world(uint32_t first, const PacketDirections& local, RayPacket& packet) const {
        float* out[3] = {packet.dx, packet.dy, packet.dz};
        for (int c = 0; c < 3; ++c) {
            const float *fx = frame_[c] + first, *fy = frame_[3 + c] + first, *fz = frame_[6 + c] + first;
            for (uint32_t lane = 0; lane < kLanes; ++lane)
                out[c][lane] = local.x[lane] * fx[lane] + local.y[lane] * fy[lane] + local.z[lane] * fz[lane];
        }
    }

    const LightmapReceivers& receivers_;
    const Tile& tile_;
    float share_;
    uint32_t seed_;
    StratifiedBatch batch_;
    alignas(32) float frame_[9][kTileReceivers]; ///< x, y, z axes, each x, y, z
    uint32_t turn_[kTileReceivers];              ///< which position a stratum starts at
};

} // namespace ajar
