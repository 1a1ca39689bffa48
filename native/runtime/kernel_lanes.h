// SPDX-License-Identifier: Apache-2.0
#pragma once

// What the kernels of all classes share: receivers side by side, one entry of each, and the store.

#include "kernel.h"
#include "texel.h"

// One library for all processors, and the wider vectors where they are there: the same operations, so the same bits.
// Sanitizers start later than the choice between the two is made.
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define AJAR_WIDE_VECTORS __attribute__((flatten, target_clones("avx2", "default")))
#else
#define AJAR_WIDE_VECTORS
#endif

namespace ajar::runtime {

inline constexpr uint32_t kLanes = 16; ///< receivers at a time; also a batch of class V8 and a block of class B,
                                       ///< two batches of class V16

/// Several receivers side by side; loops over lanes become vector instructions.
struct Lanes {
    float r[kLanes], g[kLanes], b[kLanes], a[kLanes], x[kLanes], y[kLanes], on[kLanes];

    void set(uint32_t i, const LinearTexel& s) {
        r[i] = s.e.r, g[i] = s.e.g, b[i] = s.e.b, a[i] = s.a, x[i] = s.dx, y[i] = s.dy;
    }
    LinearTexel get(uint32_t i) const { return {{r[i], g[i], b[i]}, a[i], x[i], y[i]}; }
};

/// One entry of each receiver, gathered. Lanes without one have weight 0.
struct Entries {
    uint32_t words[3][kLanes];
    float r[kLanes], g[kLanes], b[kLanes], on[kLanes];

    void set_weight(uint32_t i, const TermWeight& w) { r[i] = w.r, g[i] = w.g, b[i] = w.b, on[i] = w.on; }
};

inline void load_base(const uint32_t* irradiance, const uint32_t* direction, Lanes& lanes) {
    for (uint32_t i = 0; i < kLanes; ++i) {
        lanes.set(i, make_linear(unpack_irradiance(irradiance[i]), direction[i]));
        lanes.on[i] = 0.0f;
    }
}

/// Light of the entry in lane i before its weight.
template <uint32_t Words>
Rgb entry_irradiance(const Entries& e, uint32_t i) {
    if constexpr (Words == 2)
        return unpack_irradiance(e.words[0][i]);
    else
        return {unpack_half(e.words[0][i] & 0xffffu), unpack_half(e.words[0][i] >> 16),
                unpack_half(e.words[1][i] & 0xffffu)};
}

template <uint32_t Words>
void add(const Entries& e, Lanes& lanes) {
    for (uint32_t i = 0; i < kLanes; ++i) {
        const Rgb light = entry_irradiance<Words>(e, i) * Rgb{e.r[i], e.g[i], e.b[i]};
        lanes.set(i, lanes.get(i) + make_linear(light, e.words[Words - 1][i]));
        lanes.on[i] += e.on[i];
    }
}

/// Writes the lanes that some term reached packed, the others as their base.
inline void store(const Lanes& lanes, const uint32_t* irradiance, const uint32_t* direction, const uint32_t* address,
                  uint32_t count, const Target& target) {
    PackedTexel packed[kLanes];
    for (uint32_t i = 0; i < kLanes; ++i) packed[i] = pack_texel(lanes.get(i));
    for (uint32_t i = 0; i < count; ++i) {
        const size_t texel = size_t{address[i] >> 16} * target.width + (address[i] & 0xffffu);
        const bool on = lanes.on[i] > 0.0f;
        target.irradiance[texel] = on ? packed[i].irradiance : irradiance[i];
        target.direction[texel] = on ? packed[i].direction : direction[i];
    }
}

} // namespace ajar::runtime
