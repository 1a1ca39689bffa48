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

constexpr int32_t kNone = -1; ///< no texel: the image is clipped away there

/// Texel coordinates that may lie outside by any finite amount, brought to within a texel or two of
/// the image: repeat is periodic, the others are constant further out.
float near_image(float u, uint32_t size, Texture::Extend extend) {
    if (!std::isfinite(u)) u = 0.0f;
    const auto n = static_cast<float>(size);
    if (extend == Texture::Extend::repeat) return (u - std::floor(u)) * n;
    return std::clamp(u * n, -2.0f, n + 2.0f);
}

/// Index of texel i, at most a few texels outside, under the extension rule.
int32_t wrap(int32_t i, uint32_t size, Texture::Extend extend) {
    const auto n = static_cast<int32_t>(size);
    if (i >= 0 && i < n) return i;
    if (extend == Texture::Extend::repeat) return i < 0 ? i + n : i - n;
    if (extend == Texture::Extend::edge) return std::clamp(i, 0, n - 1);
    return kNone;
}

/// A texel as it is stored: floats, or bytes as numbers of 0..255.
inline Vec4 stored(const Texture& t, size_t texel) {
    const size_t i = 4 * texel;
    if (!t.floats.empty()) return {t.floats[i], t.floats[i + 1], t.floats[i + 2], t.floats[i + 3]};
    const uint8_t* b = &t.bytes[i];
    return Vec4(b[0], b[1], b[2], b[3]);
}

/// Between two bytes the curve is straight, to a relative error below 1e-4.
inline float decode_srgb(float byte) {
    const auto i = std::min(static_cast<int>(byte), 254);
    return kSrgbToLinear[i] + (kSrgbToLinear[i + 1] - kSrgbToLinear[i]) * (byte - static_cast<float>(i));
}

inline Vec4 decode(const Texture& t, const Vec4& v) {
    if (!t.floats.empty()) return v;
    if (!t.srgb) return v / 255.0f;
    return {decode_srgb(v.x), decode_srgb(v.y), decode_srgb(v.z), v.w / 255.0f};
}

inline Vec4 fetch(const Texture& t, int32_t x, int32_t y) {
    return x == kNone || y == kNone ? Vec4(0.0f) : stored(t, static_cast<size_t>(y) * t.width + static_cast<size_t>(x));
}

} // namespace

Vec4 Texture::texel(uint32_t x, uint32_t y) const {
    return decode(*this, stored(*this, static_cast<size_t>(y) * width + x));
}

Vec4 Texture::sample(const Vec2& uv) const {
    const float px = near_image(uv.x, width, extend), py = near_image(uv.y, height, extend);
    if (nearest)
        return decode(*this, fetch(*this, wrap(static_cast<int32_t>(std::floor(px)), width, extend),
                                   wrap(static_cast<int32_t>(std::floor(py)), height, extend)));
    const float fx = std::floor(px - 0.5f), fy = std::floor(py - 0.5f);
    const float tx = px - 0.5f - fx, ty = py - 0.5f - fy;
    const auto x = static_cast<int32_t>(fx), y = static_cast<int32_t>(fy);
    const int32_t x0 = wrap(x, width, extend), x1 = wrap(x + 1, width, extend), y0 = wrap(y, height, extend),
                  y1 = wrap(y + 1, height, extend);
    return decode(*this, glm::mix(glm::mix(fetch(*this, x0, y0), fetch(*this, x1, y0), tx),
                                  glm::mix(fetch(*this, x0, y1), fetch(*this, x1, y1), tx), ty));
}

} // namespace ajar
