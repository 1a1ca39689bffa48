// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/sky.h"

namespace ajar {

Vec2 Sky::direction_to_uv(const Vec3& w) {
    return {0.5f - std::atan2(w.y, w.x) * (0.5f * kInvPi), 0.5f + std::asin(std::clamp(w.z, -1.0f, 1.0f)) * kInvPi};
}

Vec3 Sky::uv_to_direction(const Vec2& uv) {
    const float phi = (0.5f - uv.x) * 2.0f * kPi, latitude = (uv.y - 0.5f) * kPi;
    return {std::cos(latitude) * std::cos(phi), std::cos(latitude) * std::sin(phi), std::sin(latitude)};
}

Vec3 Sky::radiance(const Vec3& w) const {
    if (!has_image) return color;
    // Piecewise constant, so that importance sampling by texel reproduces it exactly.
    const Vec2 uv = direction_to_uv(w);
    const auto x =
        std::min(static_cast<uint32_t>(std::max(uv.x, 0.0f) * static_cast<float>(image.width)), image.width - 1);
    const auto y =
        std::min(static_cast<uint32_t>(std::max(uv.y, 0.0f) * static_cast<float>(image.height)), image.height - 1);
    return color * Vec3(image.texel(x, y));
}

} // namespace ajar
