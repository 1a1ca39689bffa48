// SPDX-License-Identifier: GPL-3.0-or-later
#include "pass/term_merge.h"

#include <algorithm>

namespace ajar {

Vec3 ReceiverRows::total(uint32_t r) const {
    Vec3 sum(0.0f);
    for (const TermColor* e = begin(r); e != end(r); ++e) sum += e->color;
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

void sort_unique(std::vector<uint32_t>& values) {
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
}

ReceiverRows merge_tiles(std::vector<TileRows>& tiles, TermTable& table) {
    std::vector<Term> met;
    size_t entries = 0;
    for (const TileRows& t : tiles) {
        met.insert(met.end(), t.terms.begin(), t.terms.end());
        entries += t.entries.size();
    }
    table.add(std::move(met));
    ReceiverRows rows;
    rows.entries.reserve(entries);
    for (TileRows& t : tiles) {
        std::vector<uint32_t> number(t.terms.size());
        for (size_t i = 0; i < number.size(); ++i) number[i] = table.find(t.terms[i]);
        size_t next = 0;
        for (const uint32_t count : t.count) {
            const size_t begin = rows.entries.size();
            for (uint32_t k = 0; k < count; ++k, ++next)
                rows.entries.push_back({number[t.entries[next].term], t.entries[next].color});
            std::sort(rows.entries.begin() + static_cast<ptrdiff_t>(begin), rows.entries.end(),
                      [](const TermColor& a, const TermColor& b) { return a.term < b.term; });
            rows.first.push_back(rows.entries.size());
        }
        t = {};
    }
    return rows;
}

ReceiverRows add_rows(const ReceiverRows& a, const ReceiverRows& b) {
    ReceiverRows sum;
    sum.entries.reserve(a.entries.size() + b.entries.size() / 4);
    for (uint32_t r = 0; r + 1 < a.first.size(); ++r) {
        const TermColor *i = a.begin(r), *j = b.begin(r);
        while (i != a.end(r) || j != b.end(r)) {
            const bool left = j == b.end(r) || (i != a.end(r) && i->term <= j->term),
                       right = i == a.end(r) || (j != b.end(r) && j->term <= i->term);
            sum.entries.push_back(
                {left ? i->term : j->term, (left ? i->color : Vec3(0.0f)) + (right ? j->color : Vec3(0.0f))});
            i += left;
            j += right;
        }
        sum.first.push_back(sum.entries.size());
    }
    return sum;
}

TermRows radiance_rows(const ReceiverRows& irradiance, const LightmapReceivers& receivers, uint64_t texels) {
    TermRows rows;
    rows.flags.assign(texels, 0);
    rows.first.assign(texels + 1, 0);
    rows.entries.reserve(irradiance.entries.size());
    for (uint64_t t = 0; t < texels; ++t) {
        const uint32_t r = receivers.of_texel[t];
        if (r != kNoReceiver) {
            rows.flags[t] = receivers.cut[r] != 0 ? kTexelCut : 0;
            const Vec3 reflected = receivers.albedo[r] * kInvPi;
            for (const TermColor* e = irradiance.begin(r); e != irradiance.end(r); ++e)
                rows.entries.push_back({e->term, e->color * reflected});
        }
        rows.first[t + 1] = rows.entries.size();
    }
    return rows;
}

} // namespace ajar
