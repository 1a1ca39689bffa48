// SPDX-License-Identifier: Apache-2.0
#include "terms_check.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>

namespace ajar::runtime {
namespace {

using terms::Class;

/// Whether [first, first + count) lies within size.
bool fits(uint64_t first, uint64_t count, uint64_t size) { return first <= size && count <= size - first; }

template <class Values>
bool ascends(const Values& values, size_t limit) {
    return std::adjacent_find(values.begin(), values.end(), std::greater_equal<>()) == values.end() &&
           (values.empty() || values.back() < limit);
}

bool element_ok(const terms::Element& e, size_t string_bytes) {
    const bool light_set = e.kind == static_cast<uint32_t>(terms::Kind::light_set);
    return fits(e.name_offset, e.name_size, string_bytes) && e.kind <= static_cast<uint32_t>(terms::Kind::toggle) &&
           e.weight >= 0.0f && std::isfinite(e.weight) && (light_set || e.weight <= 1.0f);
}

bool term_ok(const terms::Term& t, size_t elements) {
    const auto layout = static_cast<terms::Layout>(t.layout);
    return t.element_count >= 1 && t.element_count <= terms::kMaxElements &&
           ascends(std::span(t.elements, t.element_count), elements) &&
           (layout == terms::Layout::unsigned_words || layout == terms::Layout::signed_words) && t.scale > 0.0f &&
           std::isfinite(t.scale);
}

/// The dispatches of a file, one after the other.
class DispatchCheck {
public:
    explicit DispatchCheck(const TermsFile& file) : file_(file) {
        for (const terms::Page& page : file.pages()) taken_.emplace_back(size_t{page.width} * page.height, false);
    }
    bool ok(const terms::Dispatch& d);

private:
    bool shape_ok(const terms::Dispatch& d) const;
    bool places_ok(const terms::Dispatch& d) const;
    bool addresses_ok(const terms::Dispatch& d);
    bool index_ok(const terms::Dispatch& d) const;
    bool counts_ok(const terms::Dispatch& d) const;
    bool blocks_ok(const terms::Dispatch& d) const;
    bool room(uint32_t first, uint64_t words) const { return fits(first, words, file_.data().size()); }

    const TermsFile& file_;
    std::vector<std::vector<bool>> taken_; ///< texels of each page that a dispatch updates
};

bool DispatchCheck::shape_ok(const terms::Dispatch& d) const {
    const bool blocks = static_cast<Class>(d.kind) == Class::b;
    if (d.receivers == 0 || d.receivers > terms::kMaxReceivers || (!blocks && d.entries > terms::kMaxEntries))
        return false;
    if (d.page >= file_.pages().size() || (d.words != 2 && d.words != 3)) return false;
    if (d.palette_count > (blocks ? terms::kMaxBlockPalette : terms::kMaxPalette)) return false;
    if (!fits(d.palette, d.palette_count, file_.palettes().size())) return false;
    if (!ascends(file_.palette(d), file_.terms().size())) return false;
    const bool strided = d.entries == uint64_t{d.k} * d.receivers;
    switch (static_cast<Class>(d.kind)) {
        case Class::u:
            return d.k >= 1 && d.k <= 8 && strided && d.palette_count == d.k;
        case Class::q:
            return d.k >= 1 && d.k <= 4 && strided;
        case Class::v8:
            return d.k >= 5 && d.k <= 8;
        case Class::v16:
            return d.k >= 9 && d.k <= 16;
        case Class::b:
            return d.k >= 1;
    }
    return false;
}

bool DispatchCheck::places_ok(const terms::Dispatch& d) const {
    if (!room(d.address, d.receivers) || !room(d.base, 2ull * d.receivers)) return false;
    if (!room(d.payload, uint64_t{d.words} * d.entries)) return false;
    const auto kind = static_cast<Class>(d.kind);
    if (kind == Class::b) {
        const size_t blocks = terms::block_count(d.receivers);
        return room(d.starts, 2ull * (blocks + 1)) && room(d.index, file_.data()[d.starts + 2 * blocks]);
    }
    if (kind != Class::u && !room(d.index, (d.entries + 3ull) / 4)) return false;
    if (kind != Class::v8 && kind != Class::v16) return true;
    const terms::CountPacking p = terms::packing_of(kind);
    const uint64_t batches = (d.receivers + p.batch - 1) / p.batch;
    return room(d.counts, (batches * batch_bytes(p) + 3) / 4) && room(d.starts, (batches + 1) / 2);
}

bool DispatchCheck::addresses_ok(const terms::Dispatch& d) {
    const terms::Page& page = file_.pages()[d.page];
    const uint32_t x0 = d.rect_min & 0xffffu, y0 = d.rect_min >> 16, x1 = d.rect_max & 0xffffu, y1 = d.rect_max >> 16;
    if (x1 >= page.width || y1 >= page.height) return false;
    for (const uint32_t address : file_.data().subspan(d.address, d.receivers)) {
        const uint32_t x = address & 0xffffu, y = address >> 16;
        if (x < x0 || x > x1 || y < y0 || y > y1) return false;
        auto taken = taken_[d.page][size_t{y} * page.width + x];
        if (taken) return false;
        taken = true;
    }
    return true;
}

bool DispatchCheck::index_ok(const terms::Dispatch& d) const {
    if (static_cast<Class>(d.kind) == Class::u || static_cast<Class>(d.kind) == Class::b) return true;
    const auto* index = reinterpret_cast<const uint8_t*>(file_.data().data() + d.index);
    return std::all_of(index, index + d.entries, [&](uint8_t i) { return i < d.palette_count; });
}

bool DispatchCheck::counts_ok(const terms::Dispatch& d) const {
    const auto kind = static_cast<Class>(d.kind);
    if (kind != Class::v8 && kind != Class::v16) return true;
    const terms::CountPacking p = terms::packing_of(kind);
    const auto* starts = reinterpret_cast<const uint16_t*>(file_.data().data() + d.starts);
    uint64_t running = 0;
    uint32_t fields = 0, most = 0;
    for (uint32_t r = 0; r < d.receivers; ++r) {
        const uint32_t batch = r / p.batch, t = r % p.batch;
        if (t == 0) {
            if (starts[batch] != running) return false;
            fields = batch_fields(file_.data().data() + d.counts, p, batch);
        }
        const uint32_t count = field_count(fields, p, t);
        most = std::max(most, count);
        running += count;
    }
    return running == d.entries && most == d.k;
}

/// Slots and entries of every block follow those of the one before; a block's terms ascend.
bool DispatchCheck::blocks_ok(const terms::Dispatch& d) const {
    if (static_cast<Class>(d.kind) != Class::b) return true;
    const uint32_t* const slots = file_.data().data() + d.index;
    const auto* starts = reinterpret_cast<const terms::BlockStart*>(file_.data().data() + d.starts);
    const uint32_t blocks = terms::block_count(d.receivers), slot_count = starts[blocks].slot;
    uint64_t slot = 0, entry = 0;
    uint32_t most = 0;
    for (uint32_t b = 0; b < blocks; ++b) {
        if (starts[b].slot != slot || starts[b].entry != entry) return false;
        if (starts[b + 1].slot < slot || starts[b + 1].slot > slot_count) return false;
        const uint32_t lanes = std::min(terms::kBlock, d.receivers - b * terms::kBlock);
        uint32_t count[terms::kBlock] = {};
        for (uint32_t least = 0; slot < starts[b + 1].slot; ++slot) {
            const uint32_t place = terms::slot_place(slots[slot]), mask = terms::slot_mask(slots[slot]);
            if (place < least || place >= d.palette_count || mask == 0 || (mask >> lanes) != 0) return false;
            least = place + 1;
            entry += static_cast<uint32_t>(std::popcount(mask));
            for (uint32_t i = 0; i < lanes; ++i) most = std::max(most, count[i] += (mask >> i) & 1u);
        }
    }
    return starts[blocks].entry == entry && entry == d.entries && most == d.k;
}

bool DispatchCheck::ok(const terms::Dispatch& d) {
    return shape_ok(d) && places_ok(d) && addresses_ok(d) && index_ok(d) && counts_ok(d) && blocks_ok(d);
}

bool page_ok(const terms::Page& page) {
    return page.width >= 1 && page.width <= 65536 && page.height >= 1 && page.height <= 65536;
}

} // namespace

const char* find_table_fault(const TermsFile& file, size_t string_bytes) {
    for (const terms::Element& e : file.elements())
        if (!element_ok(e, string_bytes)) return "an element is wrong";
    for (const terms::Page& page : file.pages())
        if (!page_ok(page)) return "a page is wrong";
    for (const terms::Term& t : file.terms())
        if (!term_ok(t, file.elements().size())) return "a term is wrong";
    return nullptr;
}

const char* find_dispatch_fault(const TermsFile& file) {
    DispatchCheck check(file);
    for (const terms::Dispatch& d : file.dispatches())
        if (!check.ok(d)) return "a dispatch is wrong";
    return nullptr;
}

} // namespace ajar::runtime
