// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "base/parallel.h"
#include "receiver/lightmap.h"

namespace ajar {

/// What the costly parts of a bake would take, from a trial of them.
struct TrialTimes {
    double bounces = 0.0; ///< s
    double gather = 0.0;  ///< s, the final gather
    double lights = 0.0;  ///< to be stored beside the base
};

/// Rays of the bounces in a trial: fewer than in the bake, whose light they need not be good enough for.
uint32_t trial_bounce_samples(uint32_t wanted);

/// Finishes tiles from all over the scene for a second or two, and sets gather and lights of times to what all of
/// them would take. finish_tile: of a tile; returns how much light it stores beside the base.
void gather_some(const LightmapReceivers& receivers, ThreadPool& pool, Progress& progress,
                 const std::function<size_t(size_t)>& finish_tile, TrialTimes& times);

} // namespace ajar
