// SPDX-License-Identifier: Apache-2.0
#include "kernel.h"

#include <algorithm>

#include "kernel_lanes.h"

namespace ajar::runtime {
namespace {

using terms::Class;

/// Reads entries of receivers [first, first + count) of a dispatch; count <= kLanes, and first is a
/// multiple of kLanes.
class EntryReader {
public:
    EntryReader(const terms::Dispatch& d, const uint32_t* data, const uint16_t* palette, const TermWeight* weights)
        : d_(d),
          payload_(data + d.payload),
          index_(reinterpret_cast<const uint8_t*>(data + d.index)),
          counts_(data + d.counts),
          starts_(reinterpret_cast<const uint16_t*>(data + d.starts)),
          palette_(palette),
          weights_(weights),
          kind_(static_cast<Class>(d.kind)) {}

    /// Once per block of receivers, before its slots are read.
    void begin(uint32_t first, uint32_t count);
    /// Entry number `slot` of every receiver of the block; false if no term in it is on.
    template <uint32_t Words>
    bool read(uint32_t slot, Entries& out) const;

private:
    template <uint32_t Words>
    bool read_strided(uint32_t slot, Entries& out) const;
    template <uint32_t Words>
    bool read_lists(uint32_t slot, Entries& out) const;

    const terms::Dispatch& d_;
    const uint32_t* payload_;
    const uint8_t* index_;
    const uint32_t* counts_;
    const uint16_t* starts_;
    const uint16_t* palette_;
    const TermWeight* weights_;
    Class kind_;
    uint32_t first_ = 0, count_ = 0;
    uint32_t entry_[kLanes] = {}, entries_[kLanes] = {}; ///< classes V8 and V16
};

void EntryReader::begin(uint32_t first, uint32_t count) {
    first_ = first;
    count_ = count;
    if (kind_ != Class::v8 && kind_ != Class::v16) return;
    const terms::CountPacking packing = terms::packing_of(kind_);
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t batch = (first + i) / packing.batch, t = (first + i) % packing.batch;
        const uint32_t fields = batch_fields(counts_, packing, batch);
        entry_[i] = starts_[batch] + entries_before(fields, packing, t);
        entries_[i] = field_count(fields, packing, t);
    }
}

template <uint32_t Words>
bool EntryReader::read_strided(uint32_t slot, Entries& out) const {
    const uint32_t begin = slot * d_.receivers + first_;
    float any = 0.0f;
    if (kind_ == Class::u) {
        const TermWeight& w = weights_[palette_[slot]];
        any = w.on;
        for (uint32_t i = 0; i < kLanes; ++i) out.set_weight(i, w);
    } else {
        for (uint32_t i = 0; i < count_; ++i) {
            const TermWeight& w = weights_[palette_[index_[begin + i]]];
            any += w.on;
            out.set_weight(i, w);
        }
    }
    if (any == 0.0f) return false;
    for (uint32_t word = 0; word < Words; ++word)
        std::copy_n(payload_ + word * d_.entries + begin, count_, out.words[word]);
    return true;
}

template <uint32_t Words>
bool EntryReader::read_lists(uint32_t slot, Entries& out) const {
    float any = 0.0f;
    for (uint32_t i = 0; i < count_; ++i) {
        const bool has = slot < entries_[i];
        const uint32_t entry = has ? entry_[i] + slot : 0;
        const TermWeight w = has ? weights_[palette_[index_[entry]]] : TermWeight{0.0f, 0.0f, 0.0f, 0.0f};
        any += w.on;
        out.set_weight(i, w);
        for (uint32_t word = 0; word < Words; ++word) out.words[word][i] = payload_[word * d_.entries + entry];
    }
    return any != 0.0f;
}

template <uint32_t Words>
bool EntryReader::read(uint32_t slot, Entries& out) const {
    return kind_ == Class::u || kind_ == Class::q ? read_strided<Words>(slot, out) : read_lists<Words>(slot, out);
}

template <uint32_t Words>
void run(const terms::Dispatch& d, const uint32_t* data, EntryReader reader, const Target& target) {
    for (uint32_t first = 0; first < d.receivers; first += kLanes) {
        const uint32_t count = std::min(kLanes, d.receivers - first);
        uint32_t irradiance[kLanes] = {}, direction[kLanes] = {};
        std::copy_n(data + d.base + first, count, irradiance);
        std::copy_n(data + d.base + d.receivers + first, count, direction);
        Lanes lanes;
        load_base(irradiance, direction, lanes);
        reader.begin(first, count);
        Entries entries = {};
        for (uint32_t slot = 0; slot < d.k; ++slot)
            if (reader.template read<Words>(slot, entries)) add<Words>(entries, lanes);
        store(lanes, irradiance, direction, data + d.address + first, count, target);
    }
}

} // namespace

AJAR_WIDE_VECTORS
void run_dispatch(const terms::Dispatch& d, const uint32_t* data, const uint16_t* palette, const TermWeight* weights,
                  const Target& target) {
    const EntryReader reader(d, data, palette, weights);
    if (d.words == 2)
        run<2>(d, data, reader, target);
    else
        run<3>(d, data, reader, target);
}

} // namespace ajar::runtime
