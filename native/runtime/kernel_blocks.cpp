// SPDX-License-Identifier: Apache-2.0
// Class B: blocks of receivers that share a list of terms, for any number of terms.
// On one core of a server, all terms on: about 2 ns for each entry of a receiver where the 16 of a block have the same
// terms, 5 where a fifth of them differs, 0.1 for a term that is off (tests/bench/overlap_bench.cpp).
#include <algorithm>
#include <bit>

#include "kernel.h"
#include "kernel_lanes.h"

namespace ajar::runtime {
namespace {

static_assert(kLanes == terms::kBlock);

constexpr uint32_t kEveryLane = (1u << kLanes) - 1;

/// The entries of a slot that all lanes have, which lie side by side from payload on.
template <uint32_t Words>
void read_whole(const uint32_t* payload, uint32_t plane, const TermWeight& weight, Entries& out) {
    for (uint32_t word = 0; word < Words; ++word) std::copy_n(payload + size_t{word} * plane, kLanes, out.words[word]);
    for (uint32_t i = 0; i < kLanes; ++i) out.set_weight(i, weight);
}

/// The entries of a slot that some lanes have; the others get nothing at weight 0.
template <uint32_t Words>
void read_part(const uint32_t* payload, uint32_t plane, uint32_t mask, const TermWeight& weight, Entries& out) {
    uint32_t next = 0;
    for (uint32_t i = 0; i < kLanes; ++i) {
        const bool has = ((mask >> i) & 1u) != 0;
        for (uint32_t word = 0; word < Words; ++word) // the mask is not 0: entry 0 is there
            out.words[word][i] = has ? payload[size_t{word} * plane + next] : 0;
        out.set_weight(i, has ? weight : TermWeight{0.0f, 0.0f, 0.0f, 0.0f});
        next += has;
    }
}

/// Adds the slots of a block whose terms are on.
template <uint32_t Words>
void add_block(const terms::Dispatch& d, const uint32_t* data, const terms::BlockStart* start, const uint16_t* palette,
               const TermWeight* weights, Lanes& lanes) {
    const uint32_t* payload = data + d.payload + start[0].entry;
    Entries entries;
    for (uint32_t slot = start[0].slot; slot < start[1].slot; ++slot) {
        const uint32_t word = data[size_t{d.index} + slot], mask = terms::slot_mask(word);
        const TermWeight& weight = weights[palette[terms::slot_place(word)]];
        if (weight.on != 0.0f) {
            if (mask == kEveryLane)
                read_whole<Words>(payload, d.entries, weight, entries);
            else
                read_part<Words>(payload, d.entries, mask, weight, entries);
            add<Words>(entries, lanes);
        }
        payload += std::popcount(mask);
    }
}

template <uint32_t Words>
void run_blocks(const terms::Dispatch& d, const uint32_t* data, const uint16_t* palette, const TermWeight* weights,
                const Target& target) {
    const auto* starts = reinterpret_cast<const terms::BlockStart*>(data + d.starts);
    for (uint32_t first = 0; first < d.receivers; first += kLanes, ++starts) {
        const uint32_t count = std::min(kLanes, d.receivers - first);
        uint32_t irradiance[kLanes] = {}, direction[kLanes] = {};
        std::copy_n(data + d.base + first, count, irradiance);
        std::copy_n(data + d.base + d.receivers + first, count, direction);
        Lanes lanes;
        load_base(irradiance, direction, lanes);
        add_block<Words>(d, data, starts, palette, weights, lanes);
        store(lanes, irradiance, direction, data + d.address + first, count, target);
    }
}

} // namespace

AJAR_WIDE_VECTORS
void run_block_dispatch(const terms::Dispatch& d, const uint32_t* data, const uint16_t* palette,
                        const TermWeight* weights, const Target& target) {
    if (d.words == 2)
        run_blocks<2>(d, data, palette, weights, target);
    else
        run_blocks<3>(d, data, palette, weights, target);
}

} // namespace ajar::runtime
