// SPDX-License-Identifier: GPL-3.0-or-later
#include "encode/ahd.h"

#include <array>
#include <bit>

#include "sampling/sh.h"

namespace ajar {

namespace {

constexpr int kNormals = 13;
constexpr float kLargestFloat11 = 65024.0f, kLargestFloat10 = 64512.0f, kLargestHalf = 65504.0f;

/// z, 4 at 30 degrees, 8 at 55 degrees (algorithms.md 1.5).
std::array<Vec3, kNormals> make_normals() {
    std::array<Vec3, kNormals> n{};
    n[0] = {0, 0, 1};
    for (int i = 0; i < 4; ++i) {
        const float phi = (static_cast<float>(i) + 0.5f) * 0.5f * kPi;
        n[1 + i] = {0.5f * std::cos(phi), 0.5f * std::sin(phi), 0.8660254f};
    }
    for (int i = 0; i < 8; ++i) {
        const float phi = static_cast<float>(i) * 0.25f * kPi;
        n[5 + i] = {0.8191520f * std::cos(phi), 0.8191520f * std::sin(phi), 0.5735764f};
    }
    return n;
}
const std::array<Vec3, kNormals> kFitNormals = make_normals();

/// Ambient part and squared error of the best fit for a given direction; total = luminance of E_z.
struct Fit {
    float ambient = 0.0f, cost = 0.0f;
};

Fit fit_ambient(const std::array<float, kNormals>& e, float total, const Vec3& d) {
    float gg = 0.0f, gh = 0.0f, hh = 0.0f;
    for (int k = 0; k < kNormals; ++k) {
        const float c = std::max(0.0f, glm::dot(kFitNormals[k], d)) / d.z;
        const float g = 1.0f - c, h = total * c - e[k];
        gg += g * g;
        gh += g * h;
        hh += h * h;
    }
    Fit f;
    f.ambient = gg > 1e-12f ? std::clamp(-gh / gg, 0.0f, total) : total;
    f.cost = hh + f.ambient * (2.0f * gh + f.ambient * gg);
    return f;
}

/// Keeps the azimuth, raises the height to the minimum.
Vec3 limit_height(const Vec3& v) {
    const Vec3 d = normalize_or(v, {0, 0, 1});
    if (d.z >= kAhdMinHeight) return d;
    const float flat = std::sqrt(d.x * d.x + d.y * d.y);
    const float scale = flat > 0.0f ? std::sqrt(1.0f - kAhdMinHeight * kAhdMinHeight) / flat : 0.0f;
    return scale > 0.0f ? Vec3(d.x * scale, d.y * scale, kAhdMinHeight) : Vec3(0, 0, 1);
}

/// Pattern search on the hemisphere: steps shrink until they no longer matter at 8 bits.
Vec3 search(const std::array<float, kNormals>& e, float total, Vec3 best) {
    float cost = fit_ambient(e, total, best).cost;
    for (float step = 0.4f; step > 0.004f;) {
        const Frame f = frame_from_normal(best);
        Vec3 next = best;
        for (const Vec3& axis : {f.x, -f.x, f.y, -f.y}) {
            const Vec3 d = limit_height(best + step * axis);
            const float c = fit_ambient(e, total, d).cost;
            if (c < cost) cost = c, next = d;
        }
        if (next == best)
            step *= 0.5f;
        else
            best = next;
    }
    return best;
}

Vec3 best_start(const std::array<float, kNormals>& e, float total, const float* sh) {
    Vec3 best = limit_height({-sh[3], -sh[1], sh[2]});
    float cost = fit_ambient(e, total, best).cost;
    for (int i = 0; i < 6; ++i) {
        const float phi = static_cast<float>(i) * kPi / 3.0f;
        const Vec3 d(0.7660444f * std::cos(phi), 0.7660444f * std::sin(phi), 0.6427876f);
        const float c = fit_ambient(e, total, d).cost;
        if (c < cost) cost = c, best = d;
    }
    return best;
}

/// Unsigned float with 5 exponent bits (bias 15) and the given mantissa bits.
uint32_t pack_small_float(float v, int mantissa, float largest) {
    if (!(v > 0.0f)) return 0; // negative and NaN
    v = std::min(v, largest);
    const int shift = 23 - mantissa;
    if (v < 0x1p-14f) return static_cast<uint32_t>(std::lround(v * std::ldexp(1.0f, 14 + mantissa))); // denormal
    const uint32_t bits = std::bit_cast<uint32_t>(v) - (112u << 23); // exponent bias 127 to 15
    const uint32_t half = (1u << (shift - 1)) - 1u + ((bits >> shift) & 1u);
    return (bits + half) >> shift; // round to nearest even
}

float unpack_small_float(uint32_t p, int mantissa) {
    const uint32_t exponent = p >> mantissa, fraction = p & ((1u << mantissa) - 1u);
    const float m = static_cast<float>(fraction) / static_cast<float>(1u << mantissa);
    return exponent == 0 ? std::ldexp(m, -14) : std::ldexp(1.0f + m, static_cast<int>(exponent) - 15);
}

uint32_t unorm8(float v) { return static_cast<uint32_t>(std::lround(std::clamp(v, 0.0f, 1.0f) * 255.0f)); }

} // namespace

Ahd fit_ahd(const Vec3& irradiance, const float* sh) {
    Ahd out;
    out.irradiance = irradiance;
    const float total = luminance(irradiance);
    if (!(total > 0.0f)) return out;
    std::array<float, kNormals> e;
    for (int k = 0; k < kNormals; ++k) e[k] = sh_irradiance(sh, kFitNormals[k]);
    e[0] = total;
    for (const float v : e)
        if (!std::isfinite(v)) return out;
    out.direction = search(e, total, best_start(e, total, sh));
    out.ratio = fit_ambient(e, total, out.direction).ambient / total;
    // Without a highlight any direction does; z filters best with the neighbours.
    if (out.ratio >= 1.0f - 0.5f / 255.0f) out.direction = {0, 0, 1};
    return out;
}

Vec3 decode_ahd(const Ahd& a, const Vec3& n) {
    const float highlight = std::max(0.0f, glm::dot(n, a.direction)) / std::max(a.direction.z, 0.1f);
    return a.irradiance * (a.ratio + (1.0f - a.ratio) * highlight);
}

uint32_t pack_r11g11b10f(const Vec3& v) {
    return pack_small_float(v.x, 6, kLargestFloat11) | (pack_small_float(v.y, 6, kLargestFloat11) << 11) |
           (pack_small_float(v.z, 5, kLargestFloat10) << 22);
}

Vec3 unpack_r11g11b10f(uint32_t p) {
    return {unpack_small_float(p & 0x7ff, 6), unpack_small_float((p >> 11) & 0x7ff, 6), unpack_small_float(p >> 22, 5)};
}

uint32_t pack_half(float v) { return pack_small_float(std::fabs(v), 10, kLargestHalf) | (v < 0.0f ? 0x8000u : 0u); }

float unpack_half(uint32_t p) {
    const float v = unpack_small_float(p & 0x7fffu, 10);
    return (p & 0x8000u) != 0 ? -v : v;
}

uint32_t pack_direction(const Ahd& a) {
    const Vec3 d = a.direction * 0.5f + 0.5f;
    return unorm8(d.x) | (unorm8(d.y) << 8) | (unorm8(d.z) << 16) | (unorm8(a.ratio) << 24);
}

Ahd unpack_direction(uint32_t p, const Vec3& irradiance) {
    const auto channel = [&](int i) { return static_cast<float>((p >> (8 * i)) & 0xff) / 255.0f; };
    return {irradiance, channel(3), Vec3(channel(0), channel(1), channel(2)) * 2.0f - 1.0f};
}

} // namespace ajar
