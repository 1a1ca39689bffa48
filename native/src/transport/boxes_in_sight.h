// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <mutex>

#include "accel/embree_scene.h"
#include "receiver/lightmap.h"
#include "sampling/aim_box.h"

namespace ajar {

/// Which boxes some receivers of each tile see: of many doors, most tiles see few. Found by rays, so a box that
/// only a few of a tile's receivers see may be missed: such a tile aims no rays at it, which costs noise alone.
class BoxesInSight {
public:
    /// Everything must outlive this. seed: of the rays.
    BoxesInSight(const Tracer& tracer, const LightmapReceivers& receivers, std::vector<AimBox> boxes, uint32_t seed);

    const std::vector<AimBox>& boxes() const { return boxes_; }
    /// Indices of the boxes that the tile around a receiver sees, ascending. Found when first asked for, from any
    /// thread; adds the rays that this took.
    const std::vector<uint32_t>& from(uint32_t receiver, uint64_t& rays);

private:
    struct Seen {
        std::once_flag found;
        std::vector<uint32_t> boxes;
    };
    bool sees(const Tile& tile, const AimBox& box, uint64_t& traced) const;

    const Tracer& tracer_;
    const LightmapReceivers& receivers_;
    std::vector<AimBox> boxes_;
    uint32_t seed_;
    std::vector<Seen> seen_; ///< per tile
};

} // namespace ajar
