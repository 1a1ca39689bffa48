// SPDX-License-Identifier: GPL-3.0-or-later
#include "package/terms_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/error.h"
#include "package/dispatch_plan.h"
#include "package/rounded_base.h"
#include "package/term_blocks.h"

namespace ajar {
namespace {

using terms::Class;

/// The sections of terms.bin while they grow.
struct Sections {
    std::vector<uint8_t> strings;
    std::vector<terms::Element> elements;
    std::vector<terms::Page> pages;
    std::vector<terms::Term> terms;
    std::vector<terms::Dispatch> dispatches;
    std::vector<uint16_t> palette;
    std::vector<uint32_t> data;
};

class Builder {
public:
    explicit Builder(const PackageContent& content) : content_(content), lists_(collect_terms(content)) {
        for (const PackagePage& page : content.pages) {
            page_first_.push_back(static_cast<uint32_t>(texels_));
            texels_ += uint64_t{page.width} * page.height;
        }
        for (auto* v : {&texel_terms_, &texel_bytes_}) v->assign(content.overlap_pictures ? texels_ : 0, 0);
    }

    TermsFile build(std::span<const PageChecksums> checksums);

private:
    void add_names();
    void add_pages(std::span<const PageChecksums> checksums);
    void add_terms();
    void add_dispatch(const PlannedDispatch& plan);
    void add_receivers(const PlannedDispatch& plan, terms::Dispatch& d);
    void add_entries(const PlannedDispatch& plan, terms::Dispatch& d);
    void add_counts(const PlannedDispatch& plan, terms::Dispatch& d);
    void add_blocks(const PlannedDispatch& plan, terms::Dispatch& d);
    /// Stores an entry of the lists at a place of the dispatch's payload; returns its term.
    uint16_t put_entry(const PlannedDispatch& plan, const terms::Dispatch& d, uint32_t place, uint32_t entry);
    template <class T>
    uint32_t put_array(const std::vector<T>& values);
    /// Room for `bytes` in the data section, zeroed, aligned to 16 bytes; returns the first word.
    uint32_t reserve(uint64_t bytes);
    void put_byte(uint32_t word, size_t index, uint32_t value) {
        out_.data[word + index / 4] |= value << (8 * (index % 4));
    }
    void count_dispatch(const PlannedDispatch& plan, const terms::Dispatch& d, uint64_t bytes);
    void summarise_waste(const std::vector<PlannedDispatch>& plan);

    const PackageContent& content_;
    TermLists lists_;
    std::vector<uint32_t> page_first_;
    uint64_t texels_ = 0;
    Sections out_;
    TermsSummary summary_;
    std::vector<uint32_t> texel_terms_, texel_bytes_;
};

void Builder::add_names() {
    for (const PackageElement& e : content_.elements) {
        const auto offset = static_cast<uint32_t>(out_.strings.size());
        out_.strings.insert(out_.strings.end(), e.name.begin(), e.name.end());
        out_.elements.push_back({offset, static_cast<uint32_t>(e.name.size()), element_kind(e), e.weight});
    }
}

void Builder::add_pages(std::span<const PageChecksums> checksums) {
    for (size_t i = 0; i < content_.pages.size(); ++i)
        out_.pages.push_back(
            {content_.pages[i].width, content_.pages[i].height, checksums[i].irradiance, checksums[i].direction});
}

void Builder::add_terms() {
    for (size_t i = 0; i < content_.terms.size(); ++i) {
        const std::vector<uint32_t>& elements = content_.terms[i].elements;
        terms::Term t{};
        t.element_count = static_cast<uint32_t>(elements.size());
        std::copy(elements.begin(), elements.end(), t.elements);
        const StoredTerm& stored = lists_.terms[i];
        t.layout =
            static_cast<uint32_t>(stored.is_signed ? terms::Layout::signed_words : terms::Layout::unsigned_words);
        t.scale = std::clamp(stored.scale / content_.scale, 0x1p-126f, 0x1p127f); // sums are in the pages' unit
        t.receivers = stored.texels;
        out_.terms.push_back(t);
        summary_.terms.push_back({stored.is_signed, stored.scale, stored.texels, 0});
    }
}

uint32_t Builder::reserve(uint64_t bytes) {
    const size_t first = out_.data.size();
    const uint64_t words = (bytes + 15) / 16 * 4;
    if (first + words > 0xffffffffull) throw Error(AJAR_ERROR_ARGUMENT, "The package's terms take more than 16 GiB");
    out_.data.resize(first + words, 0);
    return static_cast<uint32_t>(first);
}

void Builder::add_receivers(const PlannedDispatch& plan, terms::Dispatch& d) {
    const PackagePage& page = content_.pages[plan.page];
    d.address = reserve(4ull * d.receivers);
    d.base = reserve(8ull * d.receivers);
    uint32_t x0 = ~0u, y0 = ~0u, x1 = 0, y1 = 0;
    for (uint32_t r = 0; r < d.receivers; ++r) {
        const uint32_t texel = plan.texels[r] - page_first_[plan.page];
        const uint32_t x = texel % page.width, y = page.height - 1 - texel / page.width;
        x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
        out_.data[d.address + r] = (y << 16) | x;
        out_.data[d.base + r] = page.packed_irradiance[texel];
        out_.data[d.base + d.receivers + r] = page.packed_direction[texel];
    }
    d.rect_min = (y0 << 16) | x0;
    d.rect_max = (y1 << 16) | x1;
}

uint16_t Builder::put_entry(const PlannedDispatch& plan, const terms::Dispatch& d, uint32_t place, uint32_t entry) {
    const uint16_t term = lists_.term[entry];
    const auto words = entry_words(content_.terms[term], lists_.terms[term], lists_.source[entry], plan.is_signed);
    for (size_t w = 0; w < d.words; ++w) out_.data[d.payload + w * d.entries + place] = words[w];
    return term;
}

template <class T>
uint32_t Builder::put_array(const std::vector<T>& values) {
    const uint32_t first = reserve(values.size() * sizeof(T));
    std::memcpy(&out_.data[first], values.data(), values.size() * sizeof(T));
    return first;
}

void Builder::add_blocks(const PlannedDispatch& plan, terms::Dispatch& d) {
    const TermBlocks blocks = make_blocks(lists_, plan.texels, plan.palette);
    d.payload = reserve(4ull * d.words * d.entries);
    for (uint32_t i = 0; i < d.entries; ++i) put_entry(plan, d, i, blocks.entries[i]);
    d.index = put_array(blocks.slots);
    d.starts = put_array(blocks.starts);
    for (const uint32_t slot : blocks.slots) summary_.terms[plan.palette[terms::slot_place(slot)]].bytes += sizeof slot;
}

void Builder::add_entries(const PlannedDispatch& plan, terms::Dispatch& d) {
    const bool strided = plan.kind == Class::u || plan.kind == Class::q;
    d.payload = reserve(4ull * d.words * d.entries);
    d.index = plan.kind == Class::u ? 0 : reserve(d.entries);
    uint32_t running = 0;
    for (uint32_t r = 0; r < d.receivers; ++r) {
        const uint32_t first = lists_.first[plan.texels[r]], count = lists_.count(plan.texels[r]);
        for (uint32_t s = 0; s < count; ++s) {
            const uint32_t entry = strided ? s * d.receivers + r : running + s;
            const uint16_t term = put_entry(plan, d, entry, first + s);
            if (plan.kind == Class::u) continue;
            const auto place = std::lower_bound(plan.palette.begin(), plan.palette.end(), term);
            put_byte(d.index, entry, static_cast<uint32_t>(place - plan.palette.begin()));
        }
        running += count;
    }
}

void Builder::add_counts(const PlannedDispatch& plan, terms::Dispatch& d) {
    if (plan.kind != Class::v8 && plan.kind != Class::v16) return;
    const terms::CountPacking packing = terms::packing_of(plan.kind);
    const uint32_t batches = (d.receivers + packing.batch - 1) / packing.batch;
    d.counts = reserve(uint64_t{batches} * batch_bytes(packing));
    d.starts = reserve(uint64_t{batches} * 2);
    uint32_t running = 0;
    for (uint32_t r = 0; r < d.receivers; ++r) {
        const uint32_t batch = r / packing.batch, bit = packing.bits * (r % packing.batch);
        if (bit == 0) out_.data[d.starts + batch / 2] |= running << (16 * (batch % 2));
        const uint32_t count = lists_.count(plan.texels[r]), field = count - packing.least;
        const uint64_t at = uint64_t{8} * batch_bytes(packing) * batch + bit;
        for (uint32_t i = 0; i < packing.bits; ++i)
            out_.data[d.counts + (at + i) / 32] |= ((field >> i) & 1u) << ((at + i) % 32);
        running += count;
    }
}

void Builder::add_dispatch(const PlannedDispatch& plan) {
    terms::Dispatch d{};
    const size_t before = out_.data.size();
    d.kind = static_cast<uint32_t>(plan.kind);
    d.k = plan.k;
    d.words = static_cast<uint32_t>(plan.is_signed ? terms::Layout::signed_words : terms::Layout::unsigned_words);
    d.page = plan.page;
    d.receivers = static_cast<uint32_t>(plan.texels.size());
    for (const uint32_t texel : plan.texels) d.entries += lists_.count(texel);
    d.palette = static_cast<uint32_t>(out_.palette.size());
    d.palette_count = static_cast<uint32_t>(plan.palette.size());
    out_.palette.insert(out_.palette.end(), plan.palette.begin(), plan.palette.end());
    add_receivers(plan, d);
    if (plan.kind == Class::b) {
        add_blocks(plan, d);
    } else {
        add_entries(plan, d);
        add_counts(plan, d);
    }
    out_.dispatches.push_back(d);
    count_dispatch(plan, d, 4 * (out_.data.size() - before) + 2 * plan.palette.size() + sizeof d);
}

void Builder::count_dispatch(const PlannedDispatch& plan, const terms::Dispatch& d, uint64_t bytes) {
    ClassSummary& c = summary_.classes[static_cast<size_t>(plan.kind)];
    c.dispatches++;
    c.receivers += d.receivers;
    c.entries += d.entries;
    c.bytes += bytes;
    const uint64_t entry_bytes = 4 * d.words + (plan.kind == Class::u || plan.kind == Class::b ? 0 : 1);
    const double shared = static_cast<double>(bytes - entry_bytes * d.entries) / d.receivers;
    for (const uint32_t texel : plan.texels) {
        const uint32_t count = lists_.count(texel);
        const double own = static_cast<double>(count * entry_bytes) + shared;
        summary_.texels.add(count, own);
        if (!texel_terms_.empty()) {
            texel_terms_[texel] = count;
            texel_bytes_[texel] = static_cast<uint32_t>(std::lround(own));
        }
        for (uint32_t e = lists_.first[texel]; e < lists_.first[texel + 1]; ++e)
            summary_.terms[lists_.term[e]].bytes += entry_bytes;
    }
}

void Builder::summarise_waste(const std::vector<PlannedDispatch>& plan) {
    uint64_t run = 0, needed = 0;
    summary_.elements.resize(content_.elements.size());
    // Calls visit once for each element that one of the terms has.
    std::vector<uint64_t> met_by(content_.elements.size(), 0);
    uint64_t caller = 0;
    const auto each_element = [&](std::span<const uint16_t> of_terms, const auto& visit) {
        ++caller;
        for (const uint16_t term : of_terms)
            for (const uint32_t element : content_.terms[term].elements)
                if (std::exchange(met_by[element], caller) != caller) visit(element);
    };
    for (const PlannedDispatch& d : plan) {
        each_element(d.palette, [&](uint32_t) { run += d.texels.size(); });
        for (const uint32_t texel : d.texels)
            each_element({&lists_.term[lists_.first[texel]], lists_.count(texel)}, [&](uint32_t element) {
                ++summary_.elements[element].texels;
                ++needed;
            });
    }
    for (size_t t = 0; t < summary_.terms.size(); ++t)
        for (const uint32_t element : content_.terms[t].elements)
            summary_.elements[element].bytes += summary_.terms[t].bytes;
    summary_.wasted_updates = needed > 0 ? static_cast<double>(run) / static_cast<double>(needed) : 1.0;
}

template <class T>
std::span<const uint8_t> bytes_of(const std::vector<T>& values) {
    return {reinterpret_cast<const uint8_t*>(values.data()), values.size() * sizeof(T)};
}

std::vector<uint8_t> assemble(const Sections& s) {
    terms::Header header{};
    std::memcpy(header.magic, terms::kMagic, sizeof header.magic);
    header.version = terms::kVersion;
    header.section_count = terms::kSectionCount;
    header.file_size = sizeof header;
    const std::span<const uint8_t> sections[terms::kSectionCount] = {
        bytes_of(s.strings),    bytes_of(s.elements), bytes_of(s.pages), bytes_of(s.terms),
        bytes_of(s.dispatches), bytes_of(s.palette),  bytes_of(s.data)};
    for (size_t i = 0; i < terms::kSectionCount; ++i) {
        constexpr uint64_t a = terms::kSectionAlignment;
        header.sections[i] = {(header.file_size + a - 1) / a * a, sections[i].size()};
        header.file_size = header.sections[i].offset + header.sections[i].size;
    }
    std::vector<uint8_t> bytes(header.file_size);
    for (size_t i = 0; i < terms::kSectionCount; ++i)
        std::copy(sections[i].begin(), sections[i].end(), bytes.begin() + static_cast<long>(header.sections[i].offset));
    std::memcpy(bytes.data(), &header, sizeof header);
    header.checksum = terms::terms_checksum(bytes);
    std::memcpy(bytes.data(), &header, sizeof header);
    return bytes;
}

TermsFile Builder::build(std::span<const PageChecksums> checksums) {
    add_names();
    add_pages(checksums);
    add_terms();
    const std::vector<PlannedDispatch> plan = plan_dispatches(content_.pages, lists_);
    for (const PlannedDispatch& d : plan) add_dispatch(d);
    if (out_.palette.size() % 2 != 0) out_.palette.push_back(0); // whole words, for graphics cards
    summarise_waste(plan);
    TermsFile file{assemble(out_), std::move(summary_), std::move(texel_terms_), std::move(texel_bytes_)};
    file.summary.bytes = file.bytes.size();
    return file;
}

} // namespace

TermsFile make_terms_file(const PackageContent& content, std::span<const PageChecksums> pages) {
    check_content(content);
    const RoundedContent rounded(content);
    return Builder(rounded.content()).build(pages);
}

} // namespace ajar
