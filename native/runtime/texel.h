// SPDX-License-Identifier: Apache-2.0
#pragma once

// The light of a texel as numbers that add up. A texel stores irradiance E along the normal, the
// ambient share r of it and a highlight direction d; on a normal n it means
//     E(n) = E * (r + (1 - r) * max(0, n.d) / d.z).
// Its linear state is E, the ambient luminance A = r lum(E), and the highlight's luminance times its
// slope, D = (1 - r) lum(E) d.xy / d.z. States of base and terms are added with their weights and
// packed once. E stays exact under sums; r and d are those of the sum's ambient part and highlight.
//
// Every operation is one that IEEE 754 rounds correctly, in a fixed order (compile without
// contraction), and integers do the unpacking: results do not depend on the machine, and
// ajar_terms.comp is the same code.

#include <bit>
#include <cmath>
#include <cstdint>

namespace ajar::runtime {

struct Rgb {
    float r, g, b;
};

struct LinearTexel {
    Rgb e;
    float a, dx, dy;
};

/// Rec.709.
inline float luminance(const Rgb& c) { return 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b; }

/// Float with 5 exponent bits (bias 15) and the given mantissa bits, no sign. The exponent that would
/// mean infinity and NaN counts as a number: nothing that a file holds is not finite. Denormals are
/// made from an integer, for processors that flush them.
inline float unpack_small(uint32_t p, int mantissa) {
    const float normal = std::bit_cast<float>((p << (23 - mantissa)) + (112u << 23));
    const float denormal = static_cast<float>(static_cast<int32_t>(p)) * (mantissa == 6   ? 0x1p-20f
                                                                          : mantissa == 5 ? 0x1p-19f
                                                                                          : 0x1p-24f);
    return (p >> mantissa) == 0 ? denormal : normal;
}

/// Rounds to nearest; not positive becomes 0, more than largest becomes largest.
inline uint32_t pack_small(float v, int mantissa, float largest) {
    const float limited = v < largest ? (v > 0.0f ? v : 0.0f) : largest;
    const uint32_t shift = static_cast<uint32_t>(23 - mantissa);
    const uint32_t bits = std::bit_cast<uint32_t>(limited) - (112u << 23);
    const uint32_t normal = (bits + (1u << (shift - 1)) - 1u + ((bits >> shift) & 1u)) >> shift;
    const float steps = (limited < 0x1p-14f ? limited : 0.0f) * (mantissa == 6 ? 0x1p20f : 0x1p19f);
    const uint32_t denormal = static_cast<uint32_t>(static_cast<int32_t>(steps + 0.5f));
    return limited < 0x1p-14f ? denormal : normal;
}

inline Rgb unpack_irradiance(uint32_t p) {
    return {unpack_small(p & 0x7ffu, 6), unpack_small((p >> 11) & 0x7ffu, 6), unpack_small(p >> 22, 5)};
}

inline uint32_t pack_irradiance(const Rgb& e) {
    return pack_small(e.r, 6, 65024.0f) | (pack_small(e.g, 6, 65024.0f) << 11) | (pack_small(e.b, 5, 64512.0f) << 22);
}

inline float unpack_half(uint32_t p) {
    const float v = unpack_small(p & 0x7fffu, 10);
    return (p & 0x8000u) != 0 ? -v : v;
}

inline float channel(uint32_t word, int shift) {
    return static_cast<float>(static_cast<int32_t>((word >> shift) & 0xffu)) / 255.0f;
}

/// State of irradiance e whose ratio and direction are packed in word.
inline LinearTexel make_linear(const Rgb& e, uint32_t word) {
    const float r = channel(word, 24), z = channel(word, 16) * 2.0f - 1.0f;
    const float height = z > 0.1f ? z : 0.1f;
    const float total = luminance(e), highlight = (1.0f - r) * total;
    return {e, r * total, highlight * ((channel(word, 0) * 2.0f - 1.0f) / height),
            highlight * ((channel(word, 8) * 2.0f - 1.0f) / height)};
}

inline LinearTexel operator+(const LinearTexel& s, const LinearTexel& t) {
    return {{s.e.r + t.e.r, s.e.g + t.e.g, s.e.b + t.e.b}, s.a + t.a, s.dx + t.dx, s.dy + t.dy};
}

inline Rgb operator*(const Rgb& a, const Rgb& b) { return {a.r * b.r, a.g * b.g, a.b * b.b}; }

inline uint32_t unorm8(float v) { // v in [0, 1]
    return static_cast<uint32_t>(static_cast<int32_t>(v * 255.0f + 0.5f));
}

inline float limit(float v, float low, float high) { return v < high ? (v > low ? v : low) : high; }

struct PackedTexel {
    uint32_t irradiance, direction;
};

/// Ambient light alone, with the direction that filters best with any neighbour.
inline constexpr uint32_t kNoHighlight = 0xffff8080u;
/// Longest slope of a direction: stored directions are at least 0.2 high.
inline constexpr float kSteepest2 = 24.0f;    // (1 - 0.2^2) / 0.2^2
inline constexpr float kLargestSlope = 1e15f; // whose square is finite

/// Packs a sum of states. Light that terms took away below zero is zero.
inline PackedTexel pack_texel(const LinearTexel& s) {
    const Rgb e{s.e.r > 0.0f ? s.e.r : 0.0f, s.e.g > 0.0f ? s.e.g : 0.0f, s.e.b > 0.0f ? s.e.b : 0.0f};
    const float total = luminance(e);
    const float ambient = limit(s.a, 0.0f, total), highlight = total - ambient;
    const float ratio = ambient / (total > 0.0f ? total : 1.0f);
    const bool has_highlight = total > 0.0f && ratio < 1.0f - 0.5f / 255.0f;
    const float divisor = has_highlight ? highlight : 1.0f;
    const float sx = limit(s.dx / divisor, -kLargestSlope, kLargestSlope);
    const float sy = limit(s.dy / divisor, -kLargestSlope, kLargestSlope);
    const float slope2 = sx * sx + sy * sy;
    const float flatten = slope2 > kSteepest2 ? std::sqrt(kSteepest2 / slope2) : 1.0f;
    const float x = sx * flatten, y = sy * flatten;
    const float z = 1.0f / std::sqrt(1.0f + (x * x + y * y));
    const uint32_t direction = unorm8(x * z * 0.5f + 0.5f) | (unorm8(y * z * 0.5f + 0.5f) << 8) |
                               (unorm8(z * 0.5f + 0.5f) << 16) | (unorm8(ratio) << 24);
    const uint32_t ambient_only = (kNoHighlight & 0xffffffu) | (unorm8(total > 0.0f ? ratio : 1.0f) << 24);
    return {pack_irradiance(e), has_highlight ? direction : ambient_only};
}

} // namespace ajar::runtime
