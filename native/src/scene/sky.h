// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/math.h"
#include "scene/texture.h"

namespace ajar {

/// Light from infinity: none, one colour, or a colour times an equirectangular image in Blender's
/// mapping (u = 0.5 - atan2(y, x) / 2 pi, v = 0.5 + asin(z) / pi).
struct Sky {
    bool present = false;
    Vec3 color{0.0f}; ///< radiance W/(m^2 sr), or factor of the image
    bool has_image = false;
    Texture image;

    bool lit() const { return present && max_component(color) > 0.0f; }
    /// Radiance arriving from the unit direction w, constant over each image texel.
    Vec3 radiance(const Vec3& w) const;
    /// Image coordinates in [0,1]^2 of a unit direction.
    static Vec2 direction_to_uv(const Vec3& w);
    static Vec3 uv_to_direction(const Vec2& uv);
};

} // namespace ajar
