// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/sky.h"

#include <vector>

namespace ajar {

/// Importance sampling of an image sky, by luminance times solid angle of its texels.
class SkySampler {
public:
    explicit SkySampler(const Sky& sky);
    /// Unit direction and its density per steradian; density 0 where the sky is black.
    Vec3 sample(const Vec2& u, float& pdf) const;
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
