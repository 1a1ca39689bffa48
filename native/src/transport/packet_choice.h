// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "accel/ray.h"

namespace ajar {

/// Some of the packets of a tile, kLanes receivers each; all by default.
struct PacketChoice {
    const uint8_t* chosen = nullptr; ///< per packet

    /// The packet that a receiver of the tile lies in is one of them.
    bool has(uint32_t local) const { return chosen == nullptr || chosen[local / kLanes] != 0; }
};

} // namespace ajar
