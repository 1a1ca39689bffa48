// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/texture.h"

#include <array>

namespace ajar {

namespace {

std::array<float, 256> make_srgb_table() {
    std::array<float, 256> table{};
    for (int i = 0; i < 256; ++i) {
        const float c = static_cast<float>(i) / 255.0f;
        table[i] = c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
    }
    return table;
}

const std::array<float, 256> kSrgbToLinear = make_srgb_table();

/// Index of texel i under the extension rule, or -1 where the image is clipped away.
int64_t wrap(int64_t i, uint32_t size, Texture::Extend extend) {
    const int64_t n = size;
    if (extend == Texture::Extend::repeat) return ((i % n) + n) % n;
    if (extend == Texture::Extend::edge) return std::clamp<int64_t>(i, 0, n - 1);
    return i >= 0 && i < n ? i : -1;
}

Vec4 fetch(const Texture& t, int64_t x, int64_t y) {
    const int64_t wx = wrap(x, t.width, t.extend), wy = wrap(y, t.height, t.extend);
    return wx < 0 || wy < 0 ? Vec4(0.0f) : t.texel(static_cast<uint32_t>(wx), static_cast<uint32_t>(wy));
}

} // namespace

Vec4 Texture::texel(uint32_t x, uint32_t y) const {
    const size_t i = 4 * (static_cast<size_t>(y) * width + x);
    if (!floats.empty()) return {floats[i], floats[i + 1], floats[i + 2], floats[i + 3]};
    const uint8_t* b = &bytes[i];
    const float alpha = static_cast<float>(b[3]) / 255.0f;
    if (srgb) return {kSrgbToLinear[b[0]], kSrgbToLinear[b[1]], kSrgbToLinear[b[2]], alpha};
    return Vec4(b[0], b[1], b[2], b[3]) / 255.0f;
}

Vec4 Texture::sample(const Vec2& uv) const {
    // Far outside UVs would overflow the integer conversion; repeat is periodic, the others constant.
    const Vec2 limited =
        glm::clamp(Vec2(std::isfinite(uv.x) ? uv.x : 0.0f, std::isfinite(uv.y) ? uv.y : 0.0f), Vec2(-1e6f), Vec2(1e6f));
    const float px = limited.x * static_cast<float>(width), py = limited.y * static_cast<float>(height);
    if (nearest) return fetch(*this, static_cast<int64_t>(std::floor(px)), static_cast<int64_t>(std::floor(py)));
    const float fx = std::floor(px - 0.5f), fy = std::floor(py - 0.5f);
    const float tx = px - 0.5f - fx, ty = py - 0.5f - fy;
    const auto x = static_cast<int64_t>(fx), y = static_cast<int64_t>(fy);
    return glm::mix(glm::mix(fetch(*this, x, y), fetch(*this, x + 1, y), tx),
                    glm::mix(fetch(*this, x, y + 1), fetch(*this, x + 1, y + 1), tx), ty);
}

} // namespace ajar
