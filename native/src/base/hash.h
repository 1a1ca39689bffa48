// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace ajar {

/// Mixes 32 bits (lowbias32, Wellons 2018). Every input bit changes about half of the output bits.
inline uint32_t hash32(uint32_t x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return x ^ (x >> 16);
}

inline uint32_t hash_combine(uint32_t a, uint32_t b) {
    return hash32(a ^ (hash32(b) + 0x9e3779b9u + (a << 6) + (a >> 2)));
}

/// 24 high bits as a float in [0, 1).
inline float unit_float(uint32_t x) { return static_cast<float>(x >> 8) * 0x1p-24f; }

} // namespace ajar
