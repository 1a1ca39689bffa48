// SPDX-License-Identifier: GPL-3.0-or-later
#include "pass/term_merge.h"

#include <algorithm>

namespace ajar {

Vec3 ReceiverRows::total(const TermTable& table, uint32_t r) const {
    Vec3 sum(0.0f);
    for (const TermColor* e = begin(r); e != end(r); ++e) sum += e->color * table.all_on(e->term);
    return sum;
}

Vec3 ReceiverRows::of(uint32_t r, uint32_t term) const {
    for (const TermColor* e = begin(r); e != end(r); ++e)
        if (e->term == term) return e->color;
    return Vec3(0.0f);
}

std::vector<Term> union_of_terms(const std::vector<const TermSums*>& sums) {
    std::vector<Term> terms;
    for (const TermSums* s : sums)
        for (uint32_t i = 0; i < s->slots(); ++i) terms.push_back(s->term(i));
    std::sort(terms.begin(), terms.end());
    terms.erase(std::unique(terms.begin(), terms.end()), terms.end());
    return terms;
}

TermIndex::TermIndex(const TermSums& sums, const std::vector<Term>& terms)
    : sums_(&sums), slot_(terms.size(), TermSums::kNone), term_(sums.slots()) {
    for (uint32_t slot = 0; slot < sums.slots(); ++slot) {
        const auto at = std::lower_bound(terms.begin(), terms.end(), sums.term(slot)) - terms.begin();
        term_[slot] = static_cast<uint32_t>(at);
        slot_[static_cast<size_t>(at)] = slot;
    }
}

/// Rows of some receivers that follow each other.
struct RowMaker::Part {
    std::vector<uint32_t> count; ///< entries of each row
    std::vector<TermColor> entries;
};

ReceiverRows RowMaker::join(std::vector<Part>& parts) const {
    ReceiverRows rows;
    std::vector<size_t> first_row, first_entry;
    size_t row = 0, entry = 0;
    for (const Part& p : parts) {
        first_row.push_back(row), first_entry.push_back(entry);
        row += p.count.size(), entry += p.entries.size();
    }
    rows.first.resize(row + 1);
    rows.entries.resize(entry);
    rows.first[row] = entry;
    pool_.for_each(
        parts.size(), progress_,
        [&](size_t i) {
            std::copy(parts[i].entries.begin(), parts[i].entries.end(),
                      rows.entries.begin() + static_cast<ptrdiff_t>(first_entry[i]));
            uint64_t next = first_entry[i];
            for (size_t k = 0; k < parts[i].count.size(); ++k) {
                rows.first[first_row[i] + k] = next;
                next += parts[i].count[k];
            }
            parts[i] = {};
        },
        false);
    return rows;
}

ReceiverRows RowMaker::receiver_rows(const Make& make) const {
    ReceiverRows rows = make_rows(receivers_.count(), [&](uint64_t row, std::vector<TermColor>& out) {
        const auto r = static_cast<uint32_t>(row);
        if (receivers_.coarse_from[r] == r) make(r, out);
    });
    rows.row_of = receivers_.coarse_from.data();
    return rows;
}

ReceiverRows RowMaker::make_rows(uint64_t count,
                                 const std::function<void(uint64_t, std::vector<TermColor>&)>& make) const {
    constexpr uint64_t kPartRows = 1024;
    std::vector<Part> parts((count + kPartRows - 1) / kPartRows);
    pool_.for_each(
        parts.size(), progress_,
        [&](size_t i) {
            for (uint64_t r = i * kPartRows; r < std::min(count, (i + 1) * kPartRows); ++r) {
                const size_t before = parts[i].entries.size();
                make(r, parts[i].entries);
                parts[i].count.push_back(static_cast<uint32_t>(parts[i].entries.size() - before));
            }
        },
        false);
    return join(parts);
}

ReceiverRows RowMaker::merge_tiles(std::vector<TileRows>& tiles, TermTable& table) const {
    std::vector<Term> met;
    for (const TileRows& t : tiles) met.insert(met.end(), t.terms.begin(), t.terms.end());
    table.add(std::move(met));
    std::vector<Part> parts(tiles.size());
    pool_.for_each(
        tiles.size(), progress_,
        [&](size_t i) {
            TileRows& t = tiles[i];
            for (TermColor& e : t.entries) e.term = table.find(t.terms[e.term]);
            auto begin = t.entries.begin();
            for (const uint32_t count : t.count) {
                std::sort(begin, begin + count, [](const TermColor& a, const TermColor& b) { return a.term < b.term; });
                begin += count;
            }
            parts[i] = {std::move(t.count), std::move(t.entries)};
            t = {};
        },
        false);
    ReceiverRows rows = join(parts);
    rows.row_of = receivers_.coarse_from.data();
    return rows;
}

ReceiverRows RowMaker::add_rows(const ReceiverRows& a, const ReceiverRows& b) const {
    return receiver_rows([&](uint32_t r, std::vector<TermColor>& sum) {
        const TermColor *i = a.begin(r), *j = b.begin(r);
        while (i != a.end(r) || j != b.end(r)) {
            const bool left = j == b.end(r) || (i != a.end(r) && i->term <= j->term),
                       right = i == a.end(r) || (j != b.end(r) && j->term <= i->term);
            sum.push_back({left ? i->term : j->term, (left ? i->color : Vec3(0.0f)) + (right ? j->color : Vec3(0.0f))});
            i += left;
            j += right;
        }
    });
}

TermRows RowMaker::radiance_rows(const ReceiverRows& irradiance, uint64_t texels) const {
    TermRows rows;
    rows.flags.assign(texels, 0);
    ReceiverRows radiance = make_rows(texels, [&](uint64_t t, std::vector<TermColor>& out) {
        const uint32_t r = receivers_.of_texel[t];
        if (r == kNoReceiver) return;
        rows.flags[t] = receivers_.cut[r] != 0 ? kTexelCut : 0;
        const Vec3 reflected = receivers_.albedo[r] * kInvPi;
        for (const TermColor* e = irradiance.begin(r); e != irradiance.end(r); ++e)
            out.push_back({e->term, e->color * reflected});
    });
    rows.first = std::move(radiance.first);
    rows.entries = std::move(radiance.entries);
    return rows;
}

} // namespace ajar
