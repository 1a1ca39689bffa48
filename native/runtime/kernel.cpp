// SPDX-License-Identifier: Apache-2.0
#include "kernel.h"

#include <algorithm>

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
namespace {

using terms::Class;

constexpr uint32_t kLanes = 16; ///< receivers at a time; also a batch of class V8, two of class V16

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

void load_base(const uint32_t* irradiance, const uint32_t* direction, Lanes& lanes) {
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

/// Writes the lanes that some term reached packed, the others as their base.
void store(const Lanes& lanes, const uint32_t* irradiance, const uint32_t* direction, const uint32_t* address,
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
