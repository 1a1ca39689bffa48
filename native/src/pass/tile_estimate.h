// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "pass/bake_parts.h"

namespace ajar {

inline std::unique_ptr<TileSums> make_sums(bool keep_sh) {
    auto sums = std::make_unique<TileSums>();
    sums->clear(keep_sh);
    return sums;
}

inline Vec3 sum_of(const TileSums& s, uint32_t lane) {
    return {s.irradiance[0][lane], s.irradiance[1][lane], s.irradiance[2][lane]};
}

/// Gather sums to irradiance. Dividing by the sum of cosine weights instead of its expectation
/// is a ratio estimator: it cancels the noise of the weights, so a uniform room stays uniform.
inline Vec3 gathered(const TileSums& s, uint32_t lane) {
    return s.cosine_sum[lane] > 0.0f ? sum_of(s, lane) * (kPi / s.cosine_sum[lane]) : Vec3(0.0f);
}

/// What the rays of one plan found for a tile, in a scene without elements.
struct TileEstimate {
    std::unique_ptr<TileSums> direct, gather;
    RayPlan plan;

    Vec3 irradiance(uint32_t lane) const {
        Vec3 e = gathered(*gather, lane);
        if (plan.direct != 0) e += sum_of(*direct, lane) / static_cast<float>(plan.direct);
        return e;
    }
    double gather_variance(uint32_t lane) const { return variance(*gather, plan.gather, lane); }
    double direct_variance(uint32_t lane) const { return variance(*direct, plan.direct, lane); }

private:
    static double variance(const TileSums& sums, uint32_t rays, uint32_t lane) {
        const double n = std::max(rays, 1u);
        return sums.pairs[lane] / (n * n);
    }
};

/// The light of a tile's receivers: mean of one or two estimates, each with a weight of its own.
struct TileLight {
    Vec3 irradiance[kTileReceivers] = {};
    float sh[kTileReceivers][kShCount] = {};
    double variance[kTileReceivers] = {}; ///< of the irradiance's luminance
    float samples[kTileReceivers] = {};   ///< gather rays
    float inside[kTileReceivers] = {};    ///< share of rays
    std::vector<float> sh_rgb;            ///< [kTileReceivers][27] if kept

    /// Adds an estimate's receivers first to end.
    void add(const TileEstimate& t, uint32_t first, uint32_t end, float weight) {
        const float gather = weight / static_cast<float>(std::max(t.plan.gather, 1u)),
                    direct = weight / static_cast<float>(std::max(t.plan.direct, 1u));
        for (uint32_t lane = first; lane < end; ++lane) {
            irradiance[lane] += weight * t.irradiance(lane);
            variance[lane] += double(weight) * weight * (t.gather_variance(lane) + t.direct_variance(lane));
            samples[lane] += static_cast<float>(t.plan.gather);
            inside[lane] += t.gather->inside[lane] * gather;
            for (size_t c = 0; c < kShCount; ++c)
                sh[lane][c] += t.gather->sh[c][lane] * gather + t.direct->sh[c][lane] * direct;
            if (t.gather->sh_rgb.empty()) continue;
            sh_rgb.resize(size_t{kTileReceivers} * 3 * kShCount, 0.0f);
            for (size_t c = 0; c < 3 * kShCount; ++c) {
                const size_t j = c * kTileReceivers + lane;
                sh_rgb[lane * 3 * kShCount + c] += t.gather->sh_rgb[j] * gather + t.direct->sh_rgb[j] * direct;
            }
        }
    }
};

} // namespace ajar
