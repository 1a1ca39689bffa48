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
    /// per channel and lane, aligned as Lanes are. Sample counts from 0. What is not finite counts as dark.
    void add(uint32_t first, uint32_t sample, const PacketDirections& w, const float (&radiance)[3][kLanes]) {
        const Lanes x = lanes(w.x), y = lanes(w.y), z = lanes(w.z);
        Lanes color[3], basis[kShCount];
        for (int c = 0; c < 3; ++c) color[c] = lanes(radiance[c]) * lanes(w.weight);
        Lanes light = 0.2126f * color[0] + 0.7152f * color[1] + 0.0722f * color[2];
        const auto finite = light - light == 0.0f;
        light = finite ? light : Lanes{};
        for (int c = 0; c < 3; ++c) color[c] = finite ? color[c] : Lanes{};
        for (int c = 0; c < 3; ++c) lanes(irradiance[c] + first) += color[c] * z;
        sh_basis(x, y, z, basis);
        for (int i = 0; i < kShCount; ++i) lanes(sh[i] + first) += basis[i] * light;
        add_pairs(first, sample, light * z);
        if (!sh_rgb.empty()) add_color(first, basis, color);
    }
    void add_cosines(uint32_t first, const PacketDirections& w) {
        lanes(cosine_sum + first) += lanes(w.weight) * lanes(w.z);
    }

private:
    /// Collapsed-strata variance: neighbouring strata pair up, their difference estimates twice
    /// the variance inside (Cochran 1977, 5A.12).
    void add_pairs(uint32_t first, uint32_t sample, const Lanes& value) {
        if ((sample & 1) != 0)
            for (uint32_t lane = 0; lane < kLanes; ++lane) {
                const double d = double(value[lane]) - double(previous[first + lane]);
                pairs[first + lane] += d * d;
            }
        lanes(previous + first) = value;
    }
    void add_color(uint32_t first, const Lanes* basis, const Lanes* color) {
        for (size_t i = 0; i < kShCount; ++i)
            for (size_t c = 0; c < 3; ++c)
                for (uint32_t lane = 0; lane < kLanes; ++lane)
                    sh_rgb[(3 * i + c) * kTileReceivers + first + lane] += basis[i][lane] * color[c][lane];
    }
};

} // namespace ajar
