// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "receiver/lightmap.h"
#include "sampling/sh.h"

namespace ajar {

/// Running sums of one tile, lane-major so that eight receivers accumulate at once. Each sample
/// adds to the irradiance along z and to the spherical harmonics of the luminance.
struct alignas(32) TileSums {
    float irradiance[3][kTileReceivers];
    float sh[kShCount][kTileReceivers]; ///< luminance of incident radiance
    float previous[kTileReceivers];     ///< luminance of the last odd sample, for pairs
    float cosine_sum[kTileReceivers];   ///< sum of cosine / pdf; its expectation is pi per ray
    float inside[kTileReceivers];       ///< rays that met the inside of a solid close by
    double pairs[kTileReceivers]; ///< sum of squared differences inside pairs of strata; squares of extreme powers
                                  ///< leave a float's range
    std::vector<float> sh_rgb;    ///< [27][kTileReceivers] if colour is kept

    void clear(bool keep_sh) {
        for (auto& c : irradiance) std::fill(std::begin(c), std::end(c), 0.0f);
        for (auto& c : sh) std::fill(std::begin(c), std::end(c), 0.0f);
        std::fill(std::begin(pairs), std::end(pairs), 0.0);
        for (auto* a : {previous, cosine_sum, inside}) std::fill(a, a + kTileReceivers, 0.0f);
        sh_rgb.assign(keep_sh ? size_t{3} * kShCount * kTileReceivers : 0, 0.0f);
    }
    /// Adds one sample: flux density facing the direction w (local frame, w.z > 0).
    void add(uint32_t lane, const Vec3& w, const Vec3& facing) {
        for (int c = 0; c < 3; ++c) irradiance[c][lane] += facing[c] * w.z;
        float y[kShCount];
        sh_basis(w.x, w.y, w.z, y);
        const float l = luminance(facing);
        for (int i = 0; i < kShCount; ++i) sh[i][lane] += y[i] * l;
        if (sh_rgb.empty()) return;
        for (int i = 0; i < kShCount; ++i)
            for (int c = 0; c < 3; ++c) sh_rgb[(3 * size_t(i) + c) * kTileReceivers + lane] += y[i] * facing[c];
    }
    /// Collapsed-strata variance: neighbouring strata pair up, their difference estimates twice
    /// the variance inside (Cochran 1977, 5A.12). sample counts from 0.
    void add_pair(uint32_t lane, uint32_t sample, float value) {
        if (sample & 1) {
            const double d = double(value) - previous[lane];
            pairs[lane] += d * d;
        } else {
            previous[lane] = value;
        }
    }
};

} // namespace ajar
