// SPDX-License-Identifier: GPL-3.0-or-later
#include "package/fill_terms.h"

#include <numeric>

namespace ajar {
namespace {

/// The texels that copy each texel.
struct Copies {
    std::vector<uint32_t> first, texel;

    explicit Copies(const std::vector<uint32_t>& source) : first(source.size() + 1, 0) {
        for (size_t i = 0; i < source.size(); ++i) first[source[i] + 1] += source[i] != i;
        std::partial_sum(first.begin(), first.end(), first.begin());
        texel.resize(first.back());
        std::vector<uint32_t> next(first.begin(), first.end() - 1);
        for (size_t i = 0; i < source.size(); ++i)
            if (source[i] != i) texel[next[source[i]]++] = static_cast<uint32_t>(i);
    }
};

void fill_term(const std::vector<uint32_t>& source, const Copies& copies, BakedTerm& term) {
    std::vector<std::pair<uint32_t, uint32_t>> kept; // texel, place in the term's arrays
    for (uint32_t i = 0; i < term.texel.size(); ++i) {
        const uint32_t t = term.texel[i];
        if (source[t] != t) continue; // what it holds itself gives way to its source's
        kept.emplace_back(t, i);
        for (uint32_t c = copies.first[t]; c < copies.first[t + 1]; ++c) kept.emplace_back(copies.texel[c], i);
    }
    std::sort(kept.begin(), kept.end());
    BakedTerm filled{term.elements, term.is_signed, term.relative_error, term.discarded, {}, {}, {}};
    for (const auto& [texel, place] : kept) {
        filled.texel.push_back(texel);
        filled.irradiance.push_back(term.irradiance[place]);
        filled.packed_direction.push_back(term.packed_direction[place]);
    }
    term = std::move(filled);
}

} // namespace

void fill_terms(const std::vector<uint32_t>& source, std::vector<BakedTerm>& terms) {
    if (terms.empty()) return;
    const Copies copies(source);
    for (BakedTerm& term : terms) fill_term(source, copies, term);
}

} // namespace ajar
