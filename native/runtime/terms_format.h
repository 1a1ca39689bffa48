// SPDX-License-Identifier: Apache-2.0
#pragma once

// terms.bin: the light of a package's elements, as the engine writes it and the run-time reads it.
//
// All numbers are little endian. The file is a Header, then its sections in any order, each aligned
// to 16 bytes. A term is a product of elements with the light it carries at the texels that keep
// it; what each element multiplies it by is element_variable(). The base is the light while all
// variables are 0: light sets off, doors and toggles as at the start. A receiver is a texel that some term reaches; a
// dispatch is a run of receivers on one page that are updated together. Every receiver is in exactly one dispatch,
// which holds its base light too: the sum of base and terms needs nothing but the dispatch.
//
// Data of a dispatch, all offsets in 32 bit words of the data section:
//   address  [receivers]      y << 16 | x, row 0 is the top row, as in the page's DDS files
//   base     [2][receivers]   R11G11B10F irradiance of all, then RGBA8 direction and ratio of all
//   payload  [words][entries] plane by plane; words is 2 or 3 (see Layout)
//   index    [entries] bytes  place of the entry's term in the dispatch's palette; not in U and B
//            [slots]          class B: place of the slot's term in the palette | mask << 16
//   counts   packed bits      entries of each receiver less the class's least; classes V8 and V16
//   starts   [batches] u16    first entry of each batch of receivers; classes V8 and V16
//            [blocks + 1]     class B: BlockStart, of the first slot and entry of each block
// Entries of a receiver are in ascending order of terms. Classes U and Q store entry s of receiver
// t at s * receivers + t; V8 and V16 store a receiver's entries one after the other.
//
// Class B: receivers 16 b ... 16 b + 15 are block b. A block lists the terms that any of them has,
// ascending: its slots. Bit i of a slot's mask says that receiver 16 b + i has the term. Entries lie
// slot by slot, in a slot by receiver, only those that are there: in a slot of all 16, neighbouring
// receivers read neighbouring words, and the weight of a term is looked up once for all of them.
//
// Version 2 added class B and made room for 8 elements of a term instead of 4; version 1 held 16
// terms at a receiver at most.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace ajar::terms {

static_assert(std::endian::native == std::endian::little, "terms.bin is read in place");

inline constexpr char kFileName[] = "terms.bin";
inline constexpr char kMagic[8] = {'A', 'J', 'A', 'R', 'T', 'E', 'R', 'M'};
inline constexpr uint32_t kVersion = 2;
inline constexpr size_t kSectionAlignment = 16;

enum Section : uint32_t { kStrings, kElements, kPages, kTerms, kDispatches, kPalette, kData, kSectionCount };

struct SectionPlace {
    uint64_t offset, size; ///< bytes from the start of the file
};

struct Header {
    char magic[8];
    uint32_t version, section_count;
    uint64_t file_size;
    uint64_t checksum; ///< checksum() of the whole file with this field 0
    SectionPlace sections[kSectionCount];
};
static_assert(sizeof(Header) == 144);

enum class Kind : uint32_t { light_set = 0, door = 1, toggle = 2 };

struct Element {
    uint32_t name_offset, name_size; ///< bytes in the strings section, UTF-8
    uint32_t kind;                   ///< Kind
    float weight;                    ///< at the start
};
static_assert(sizeof(Element) == 16);

/// What an element at a weight multiplies the light of its terms by. Of a light set it is the weight. Of a door or
/// toggle it is the distance from the weight at the start: 1 - weight if it starts at 1, else weight - start.
inline double element_variable(const Element& e, double weight) {
    if (e.kind == static_cast<uint32_t>(Kind::light_set)) return weight;
    return e.weight == 1.0f ? 1.0 - weight : weight - e.weight;
}

/// Size of a page, and the checksums of its two DDS files.
struct Page {
    uint32_t width, height;
    uint64_t irradiance_checksum, direction_checksum;
};
static_assert(sizeof(Page) == 24);

/// What a payload entry holds. Irradiance is divided by the term's scale.
///   unsigned: R11G11B10F irradiance, RGBA8 direction and ratio
///   signed:   half floats r | g << 16, half float b, RGBA8 direction and ratio
/// A dispatch with a signed term stores all its entries in the signed layout; values of unsigned
/// terms are those of the unsigned layout there too.
enum class Layout : uint32_t { unsigned_words = 2, signed_words = 3 };

inline constexpr uint32_t kMaxElements = 8; ///< of a term

struct Term {
    uint32_t element_count;
    uint32_t elements[kMaxElements]; ///< ascending
    uint32_t layout;                 ///< Layout; the term is signed where this is signed
    float scale;                     ///< power of two
    uint32_t receivers;
};
static_assert(sizeof(Term) == 48);

/// U: all receivers share one list of 1..8 terms. Q: all have the same number of terms, 1..4.
/// V8: 5..8 terms each. V16: 9..16 terms each. B: any number; the engine uses it from 17 on.
enum class Class : uint32_t { u = 0, q = 1, v8 = 2, v16 = 3, b = 4 };
inline constexpr uint32_t kClassCount = 5;

inline constexpr uint32_t kMaxReceivers = 65536;    ///< of a dispatch
inline constexpr uint32_t kMaxEntries = 65536;      ///< of a dispatch, but in class B: starts are 16 bits wide
inline constexpr uint32_t kMaxPalette = 256;        ///< of a dispatch, but in class B: an index is a byte
inline constexpr uint32_t kMaxBlockPalette = 65536; ///< of a dispatch of class B
inline constexpr uint32_t kMaxListed = 16;          ///< terms of a receiver outside class B
inline constexpr uint32_t kBlock = 16;              ///< receivers of a block of class B

struct Dispatch {
    uint32_t kind; ///< Class
    uint32_t k;    ///< terms of each receiver; the most of any in V8, V16 and B
    uint32_t words;
    uint32_t page;
    uint32_t receivers, entries;
    uint32_t palette, palette_count; ///< u16 term ids in the palette section, ascending; it has an even number
    uint32_t address, base, payload, index, counts, starts;
    uint32_t rect_min, rect_max; ///< y << 16 | x of the box around the receivers, inclusive
};
static_assert(sizeof(Dispatch) == 64);

/// How V8 and V16 pack the number of entries of a receiver.
struct CountPacking {
    uint32_t least, bits, batch; ///< fewest entries, bits of a field, receivers of a batch
};
inline constexpr CountPacking kV8Packing{5, 2, 16};
inline constexpr CountPacking kV16Packing{9, 3, 8};
constexpr CountPacking packing_of(Class c) { return c == Class::v8 ? kV8Packing : kV16Packing; }

/// Bytes of one batch's counts; batches follow each other without gaps.
constexpr uint32_t batch_bytes(const CountPacking& p) { return p.bits * p.batch / 8; }

/// Counts of batch b. Reads up to two words.
inline uint32_t batch_fields(const uint32_t* counts, const CountPacking& p, uint32_t b) {
    const uint32_t bit = 8 * batch_bytes(p) * b, word = bit >> 5, shift = bit & 31;
    const uint64_t two = counts[word] | (shift + p.bits * p.batch > 32 ? uint64_t{counts[word + 1]} << 32 : 0);
    return static_cast<uint32_t>(two >> shift);
}

/// Entries of receiver t of a batch.
constexpr uint32_t field_count(uint32_t fields, const CountPacking& p, uint32_t t) {
    return p.least + ((fields >> (p.bits * t)) & ((1u << p.bits) - 1u));
}

/// Entries of the receivers before receiver t of a batch.
constexpr uint32_t entries_before(uint32_t fields, const CountPacking& p, uint32_t t) {
    const uint32_t before = fields & ((1u << (p.bits * t)) - 1u); // t < batch: the shift is below 32
    if (p.bits == 2) return p.least * t + std::popcount(before & 0x55555555u) + 2 * std::popcount(before & 0xaaaaaaaau);
    return p.least * t + std::popcount(before & 0x249249u) + 2 * std::popcount(before & 0x492492u) +
           4 * std::popcount(before & 0x924924u);
}

/// Where a block of class B begins; one more after the last block says where it ends.
struct BlockStart {
    uint32_t slot, entry;
};
static_assert(sizeof(BlockStart) == 8);

constexpr uint32_t block_count(uint32_t receivers) { return (receivers + kBlock - 1) / kBlock; }
constexpr uint32_t make_slot(uint32_t place, uint32_t mask) { return place | (mask << 16); }
constexpr uint32_t slot_place(uint32_t slot) { return slot & 0xffffu; }
constexpr uint32_t slot_mask(uint32_t slot) { return slot >> 16; }

/// Hash of bytes, 8 at a time: xor, multiply, fold (constants of splitmix64). Each step is a
/// bijection of the state, so a change within one word always changes the result.
class Checksum {
public:
    void add(uint64_t value) {
        state_ = (state_ ^ value) * 0xbf58476d1ce4e5b9ull;
        state_ ^= state_ >> 29;
    }
    /// Bytes of a whole file or of a part that is a multiple of 8 long.
    void add_bytes(std::span<const uint8_t> bytes) {
        size_t i = 0;
        uint64_t word = 0;
        for (; i + 8 <= bytes.size(); i += 8) {
            std::memcpy(&word, bytes.data() + i, 8);
            add(word);
        }
        word = 0;
        if (i < bytes.size()) {
            std::memcpy(&word, bytes.data() + i, bytes.size() - i);
            add(word);
        }
    }
    uint64_t value() const { return state_; }

private:
    uint64_t state_ = 0x9e3779b97f4a7c15ull;
};

/// Checksum of a file that does not hold its own.
inline uint64_t file_checksum(std::span<const uint8_t> bytes) {
    Checksum sum;
    sum.add(bytes.size());
    sum.add_bytes(bytes);
    return sum.value();
}

/// Checksum of terms.bin, whose own field counts as 0. bytes hold at least a Header.
inline uint64_t terms_checksum(std::span<const uint8_t> bytes) {
    static_assert(offsetof(Header, checksum) % 8 == 0);
    Checksum sum;
    sum.add(bytes.size());
    sum.add_bytes(bytes.first(offsetof(Header, checksum)));
    sum.add(0);
    sum.add_bytes(bytes.subspan(offsetof(Header, checksum) + 8));
    return sum.value();
}

} // namespace ajar::terms
