// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/error.h"
#include "package/baked_pages.h"

namespace ajar {

/// The brightest that packed irradiance holds in all three channels, in units of the scale.
inline constexpr float kLargestPacked = 64512.0f;

/// Luminous sum of base and terms at every texel (largest channel, W/m^2), light sets as they start, or at 1 where they
/// start off; doors and toggles either way.
std::vector<float> brightest_light(const Snapshot& scene, const BakedPages& pages);

/// W/m^2 that 1 in packed irradiance stands for: 1, but a power of two where the brightest texel would fall below the
/// format's precise range or a part of all texels above its largest number.
float choose_scale(const Snapshot& scene, const std::vector<float>& brightest);

/// Objects with texels brighter than packed irradiance of this scale holds, and a scale that is not 1.
std::vector<Warning> exposure_warnings(const Snapshot& scene, const LightmapReceivers& receivers,
                                       const std::vector<float>& brightest, float scale);

} // namespace ajar
