// SPDX-License-Identifier: GPL-3.0-or-later
#include "pass/bounce_growth.h"

#include <cmath>
#include <numeric>

namespace ajar {

namespace {

/// Coarse light is the mean of up to 4 receivers of a 2x2 block, whose errors then are one: at most this many
/// times the standard error of independent ones.
constexpr double kBlockError = 2.0;

} // namespace

BounceGain ratio_of_sums(const std::vector<float>& before, const std::vector<float>& after) {
    const double a = std::accumulate(before.begin(), before.end(), 0.0),
                 b = std::accumulate(after.begin(), after.end(), 0.0);
    if (!(a > 0.0)) return {};
    const double gain = b / a;
    double squares = 0.0;
    for (size_t i = 0; i < before.size(); ++i) squares += std::pow(double{after[i]} - gain * double{before[i]}, 2.0);
    return {gain, std::sqrt(squares) / a};
}

void BounceGrowth::add(const LightmapReceivers& receivers, const std::function<float(uint32_t)>& luminance_of) {
    std::vector<float> next(receivers.count(), 0.0f);
    for (uint32_t r = 0; r < receivers.count(); ++r) {
        const float edge = receivers.texel_size[r];
        if (receivers.ring[r] == 0) next[r] = luminance_of(r) * edge * edge;
    }
    if (!power.empty()) {
        steps.push_back(ratio_of_sums(power, next));
        steps.back().error *= kBlockError;
    }
    power = std::move(next);
}

} // namespace ajar
