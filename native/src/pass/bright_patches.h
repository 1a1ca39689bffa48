// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "receiver/lightmap.h"
#include "sampling/emitters.h"

namespace ajar {

/// Bright texels of a scene as the final gather aims at them.
struct BrightTexels {
    std::vector<uint32_t> receivers;  ///< whose texels they are, ascending
    std::vector<BrightPatch> patches; ///< by texel
    double share = 0.0;               ///< of all that texels send out
};

/// Texels that stand out by radiance: a lamp close to a wall leaves a spot that few gather rays find. Those that a wall
/// cuts are left out, for their light is not the same all over, and those that no gather ray meets.
/// radiance_of: of a receiver's texel, W/(m^2 sr). least_share: none, if they
/// send out less of all light.
BrightTexels find_bright_texels(const Snapshot& scene, const LightmapReceivers& receivers,
                                const std::function<Vec3(uint32_t)>& radiance_of, double least_share);

} // namespace ajar
