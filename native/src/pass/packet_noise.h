// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pass/noise_plan.h"
#include "pass/tile_estimate.h"

namespace ajar {

/// Mean noise of the receivers first to end of a tile.
MeasuredNoise mean_noise(const TileEstimate& t, uint32_t first, uint32_t end);

/// What one receiver of a packet, first to end, has more than the others.
RareLight rare_light(const TileEstimate& t, uint32_t first, uint32_t end);

/// Mean rare light of a scene's parts: measured with some rays per receiver, its variance given for others.
RareLight mean_rare_light(const std::vector<RareLight>& parts, uint32_t measured_rays, uint32_t rays);

/// Mean level of some parts of a scene.
float mean_level(const std::vector<MeasuredNoise>& parts);

/// Noise of the packets of a tile's first lanes receivers, by their first rays: what says how many more they get.
///
/// A packet has its own noise, but not less than that of its neighbours together: eight receivers are few. If a tile
/// has, or by the scene's mean lacks, more rare light than the noise aimed at, all of its packets have the mean of it,
/// whether they met it or not. Else only those that did would get further rays, which thin it out, while the others
/// stayed too dark: of the sky that comes into a room of 4 x 3 x 3 m through a hole of 20 cm, 38 % were lost.
std::vector<MeasuredNoise> packet_noise(const TileEstimate& t, uint32_t lanes, const NoiseGoal& goal);

} // namespace ajar
