// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "scene/sky.h"

namespace ajar {

/// A direction of the sky. The radiance is that of the texel it was drawn from: looked up by the
/// rounded direction it could be a brighter neighbour's, far too bright for this density.
struct SkySample {
    Vec3 direction{0, 0, 1}; ///< unit
    Vec3 radiance{0.0f};     ///< W/(m^2 sr)
    float pdf = 0.0f;        ///< per steradian; 0 where the sky is black
};

/// Importance sampling of an image sky, by luminance times solid angle of its texels.
class SkySampler {
public:
    explicit SkySampler(const Sky& sky);
    SkySample sample(const Vec2& u) const;
    /// Density per steradian with which sample() picks w.
    float pdf(const Vec3& w) const;
    /// Integral of luminance over the sphere, W/m^2.
    float total() const { return total_; }

private:
    float texel_solid_angle(uint32_t y) const;
    const Sky& sky_;
    std::vector<float> column_cdf_; ///< [height][width] running sums inside a row
    std::vector<float> row_cdf_;    ///< running sums over rows
    float total_ = 0.0f;
};

} // namespace ajar
