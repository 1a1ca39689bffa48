// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "receiver/lightmap.h"
#include "sampling/sh.h"
#include "transport/packet_directions.h"

namespace ajar {

/// Running sums of one tile, lane-major so that eight receivers accumulate at once. Each sample
/// adds to the irradiance along z and to the spherical harmonics of the luminance.
struct alignas(32) TileSums {
    float irradiance[3][kTileReceivers];
    float sh[kShCount][kTileReceivers]; ///< luminance of incident radiance
    float previous[kTileReceivers];     ///< luminance of the last sample, for pairs
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
    /// Adds one sample of each of the receivers first to first + kLanes: radiance from directions w,
    /// per channel and lane. Sample counts from 0. What is not finite counts as dark.
    void add(uint32_t first, uint32_t sample, const PacketDirections& w, const float (&radiance)[3][kLanes]) {
        alignas(32) float facing[3][kLanes], light[kLanes];
        for (uint32_t lane = 0; lane < kLanes; ++lane) {
            const float r = radiance[0][lane] * w.weight[lane], g = radiance[1][lane] * w.weight[lane],
                        b = radiance[2][lane] * w.weight[lane], l = luminance({r, g, b});
            const bool finite = l - l == 0.0f;
            facing[0][lane] = finite ? r : 0.0f, facing[1][lane] = finite ? g : 0.0f;
            facing[2][lane] = finite ? b : 0.0f, light[lane] = finite ? l : 0.0f;
        }
        for (int c = 0; c < 3; ++c)
            for (uint32_t lane = 0; lane < kLanes; ++lane) irradiance[c][first + lane] += facing[c][lane] * w.z[lane];
        for (uint32_t lane = 0; lane < kLanes; ++lane) {
            float y[kShCount];
            sh_basis(w.x[lane], w.y[lane], w.z[lane], y);
            for (int i = 0; i < kShCount; ++i) sh[i][first + lane] += y[i] * light[lane];
        }
        add_pairs(first, sample, w, light);
        if (!sh_rgb.empty()) add_color(first, w, facing);
    }

private:
    /// Collapsed-strata variance: neighbouring strata pair up, their difference estimates twice
    /// the variance inside (Cochran 1977, 5A.12).
    void add_pairs(uint32_t first, uint32_t sample, const PacketDirections& w, const float (&light)[kLanes]) {
        for (uint32_t lane = 0; lane < kLanes; ++lane) {
            const float value = light[lane] * w.z[lane];
            const double d = (sample & 1) != 0 ? double(value) - double(previous[first + lane]) : 0.0;
            pairs[first + lane] += d * d;
            previous[first + lane] = value;
        }
    }
    void add_color(uint32_t first, const PacketDirections& w, const float (&facing)[3][kLanes]) {
        for (uint32_t lane = 0; lane < kLanes; ++lane) {
            float y[kShCount];
            sh_basis(w.x[lane], w.y[lane], w.z[lane], y);
            for (size_t i = 0; i < kShCount; ++i)
                for (size_t c = 0; c < 3; ++c)
                    sh_rgb[(3 * i + c) * kTileReceivers + first + lane] += y[i] * facing[c][lane];
        }
    }
};

} // namespace ajar
