// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Owen-scrambled Sobol points by hashing (Burley 2020, "Practical Hash-based Owen Scrambling",
// with Vegdahl's constants). Blocks of 4^k points starting at a multiple of 4^k have exactly one
// point in each cell of a 2^k x 2^k grid.

#include "base/hash.h"
#include "base/math.h"

namespace ajar {

inline uint32_t reverse_bits(uint32_t x) {
    x = __builtin_bswap32(x);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
    x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
    return ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
}

/// Nested uniform scramble of a bit-reversed number.
inline uint32_t laine_karras(uint32_t x, uint32_t seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    return x ^ (x * 0x53a22864u);
}

/// Second Sobol dimension, bit-reversed: the Pascal matrix by doubling (Ahmed 2024 form).
inline uint32_t sobol_second_reversed(uint32_t index) {
    index ^= (index & 0xaaaaaaaau) >> 1;
    index ^= (index & 0xccccccccu) >> 2;
    index ^= (index & 0xf0f0f0f0u) >> 4;
    index ^= (index & 0xff00ff00u) >> 8;
    return index ^ ((index & 0xffff0000u) >> 16);
}

/// Permutes indices inside every aligned block of 2^k, so that their low bits no longer follow
/// the sequence while each block stays a net (Burley 2020, section 5).
inline uint32_t shuffle_index(uint32_t index, uint32_t seed) {
    return reverse_bits(laine_karras(reverse_bits(index), seed));
}

/// Point index of the sequence scrambled by seed, in [0,1)^2. The dimensions' seeds must differ by
/// more than a flip of fixed bits, whose hashes are too much alike: single points would cluster.
inline Vec2 owen_sobol(uint32_t index, uint32_t seed) {
    const uint32_t x = reverse_bits(laine_karras(index, hash32(seed)));
    const uint32_t y = reverse_bits(laine_karras(sobol_second_reversed(index), hash32(seed + 0x9e3779b9u)));
    return {unit_float(x), unit_float(y)};
}

} // namespace ajar
