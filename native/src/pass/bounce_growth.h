// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "receiver/lightmap.h"

namespace ajar {

/// Light of a bounce over that of the bounce before it.
struct BounceGain {
    double gain = 0.0;
    double error = 0.0; ///< bound of its standard error
};

/// Follows the power that reaches lightmaps from bounce to bounce. Surfaces reflect less than all light, so from the
/// second bounce on it falls; what grows beyond its error is wrong.
struct BounceGrowth {
    std::vector<BounceGain> steps; ///< first: of bounce 1 over direct light
    std::vector<float> power;      ///< per receiver, of the last bounce

    /// Takes the next bounce: luminance of the irradiance of each receiver. Receivers outside charts are left out.
    void add(const LightmapReceivers& receivers, const std::function<float(uint32_t)>& luminance_of);
};

/// Ratio of the sums of after and before with its standard error, as a ratio estimator over samples (Cochran 1977,
/// Sampling Techniques, section 2.11). What differs from place to place counts as noise too, so it is a bound.
BounceGain ratio_of_sums(const std::vector<float>& before, const std::vector<float>& after);

} // namespace ajar
