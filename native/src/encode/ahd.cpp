// SPDX-License-Identifier: GPL-3.0-or-later
#include "encode/ahd.h"

#include <array>
#include <bit>

#include "base/lanes.h"
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

/// Where the search looks next, in steps.
constexpr float kDiagonal = 0.70710678f;
constexpr Vec2 kCompass[kLanes] = {{1, 0},  {kDiagonal, kDiagonal},   {0, 1},  {-kDiagonal, kDiagonal},
                                   {-1, 0}, {-kDiagonal, -kDiagonal}, {0, -1}, {kDiagonal, -kDiagonal}};

/// Eight unit directions.
struct alignas(32) Directions {
    float x[kLanes], y[kLanes], z[kLanes];

    void set(uint32_t lane, const Vec3& d) { x[lane] = d.x, y[lane] = d.y, z[lane] = d.z; }
    Vec3 at(uint32_t lane) const { return {x[lane], y[lane], z[lane]}; }
};

Lanes all(float v) { return v - Lanes{}; }

/// Ambient part of the best fit for each direction, and its squared error less that of no highlight.
struct alignas(32) Fits {
    float ambient[kLanes], cost[kLanes];
};

/// total = luminance of E_z; gap[k] = total - E of normal k. With a highlight of strength b, a normal on which it is
/// 1 - g as strong as along z is off by b g - gap.
Fits fit_ambient(const std::array<float, kNormals>& gap, float total, const Directions& d) {
    const Lanes x = lanes(d.x), y = lanes(d.y), z = lanes(d.z), per_z = 1.0f / z, none{};
    Lanes gg{}, g_gap{};
    for (int k = 0; k < kNormals; ++k) {
        const Vec3& n = kFitNormals[k];
        const Lanes along = n.x * x + n.y * y + n.z * z, g = 1.0f - (along > 0.0f ? along : none) * per_z;
        gg += g * g, g_gap += g * gap[k];
    }
    const Lanes best = gg > 1e-12f ? g_gap / gg : none, above = best > 0.0f ? best : none,
                strength = above < total ? above : all(total);
    Fits f;
    lanes(f.ambient) = total - strength;
    lanes(f.cost) = strength * (strength * gg - 2.0f * g_gap);
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

/// A direction and how well it fits.
struct Choice {
    Vec3 direction;
    float ambient, cost;
};

Choice best_of(const std::array<float, kNormals>& gap, float total, const Directions& d) {
    const Fits f = fit_ambient(gap, total, d);
    uint32_t best = 0;
    for (uint32_t lane = 1; lane < kLanes; ++lane)
        if (f.cost[lane] < f.cost[best]) best = lane;
    return {d.at(best), f.ambient[best], f.cost[best]};
}

/// Pattern search on the hemisphere: steps shrink until they no longer matter at 8 bits. Steps of a quarter find what
/// steps of a half find (mean errors .0065, .0257, .0350, .0228 for skies, one lobe, two, windows), in .75 of the time.
Choice search(const std::array<float, kNormals>& gap, float total, Choice best) {
    for (float step = 0.4f; step > 0.004f;) {
        const Frame f = frame_from_normal(best.direction);
        Directions around;
        for (uint32_t lane = 0; lane < kLanes; ++lane) {
            const Vec2& way = kCompass[lane];
            around.set(lane, limit_height(best.direction + (step * way.x) * f.x + (step * way.y) * f.y));
        }
        const Choice next = best_of(gap, total, around);
        if (next.cost < best.cost)
            best = next;
        else
            step *= 0.25f;
    }
    return best;
}

/// The mean direction of the light, or one of six around z.
Choice best_start(const std::array<float, kNormals>& gap, float total, const float* sh) {
    const Vec3 mean = limit_height({-sh[3], -sh[1], sh[2]});
    Directions starts;
    for (uint32_t lane = 0; lane < kLanes; ++lane) starts.set(lane, mean);
    for (uint32_t i = 0; i < 6; ++i) {
        const float phi = static_cast<float>(i) * kPi / 3.0f;
        starts.set(i + 1, {0.7660444f * std::cos(phi), 0.7660444f * std::sin(phi), 0.6427876f});
    }
    return best_of(gap, total, starts);
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
    std::array<float, kNormals> gap{};
    for (int k = 1; k < kNormals; ++k) gap[k] = total - sh_irradiance(sh, kFitNormals[k]);
    for (const float v : gap)
        if (!std::isfinite(v)) return out;
    const Choice best = search(gap, total, best_start(gap, total, sh));
    out.direction = best.direction;
    out.ratio = best.ambient / total;
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
