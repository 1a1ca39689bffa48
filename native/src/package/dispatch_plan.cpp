// SPDX-License-Identifier: GPL-3.0-or-later
#include "package/dispatch_plan.h"

#include <algorithm>
#include <map>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace ajar {
namespace {

using terms::Class;

/// What one more dispatch costs, in receivers updated in vain: clustering opens a new one only
/// where joining another would waste more.
constexpr uint64_t kDispatchCost = 256;
/// Dispatches that may still take receivers; older ones are closed, which bounds the search.
constexpr size_t kOpenDispatches = 64;

/// Receivers of a piece for class B: a work group of a graphics card.
constexpr size_t kPieceReceivers = 64;

/// Texels of a page with the same list of terms, or neighbours and the terms of all their lists.
struct Combination {
    uint32_t page = 0;
    bool is_signed = false;
    std::vector<uint16_t> terms;
    std::vector<uint32_t> texels;
};

uint32_t spread_bits(uint32_t v) { // of 16 bits to the even places
    v = (v | (v << 8)) & 0x00ff00ffu;
    v = (v | (v << 4)) & 0x0f0f0f0fu;
    v = (v | (v << 2)) & 0x33333333u;
    return (v | (v << 1)) & 0x55555555u;
}

void sort_morton(const std::vector<PackagePage>& pages, std::vector<uint32_t>& texels) {
    std::vector<std::pair<uint32_t, uint32_t>> keyed;
    for (const uint32_t texel : texels) {
        const TexelPlace p = place_of(pages, texel);
        keyed.emplace_back(spread_bits(p.x) | (spread_bits(p.y) << 1), texel);
    }
    std::sort(keyed.begin(), keyed.end());
    for (size_t i = 0; i < texels.size(); ++i) texels[i] = keyed[i].second;
}

std::vector<Combination> find_combinations(const std::vector<PackagePage>& pages, const TermLists& lists) {
    std::vector<Combination> found;
    uint32_t texel = 0;
    for (uint32_t page = 0; page < pages.size(); ++page) {
        std::unordered_map<std::u16string, size_t> known;
        for (const uint32_t end = texel + pages[page].width * pages[page].height; texel < end; ++texel) {
            if (lists.count(texel) == 0 || lists.count(texel) > terms::kMaxListed) continue;
            std::u16string key(lists.term.begin() + lists.first[texel], lists.term.begin() + lists.first[texel + 1]);
            const auto [it, fresh] = known.emplace(std::move(key), found.size());
            if (fresh) found.push_back({page, false, {it->first.begin(), it->first.end()}, {}});
            found[it->second].texels.push_back(texel);
        }
    }
    for (Combination& c : found)
        c.is_signed = std::any_of(c.terms.begin(), c.terms.end(), [&](uint16_t t) { return lists.terms[t].is_signed; });
    return found;
}

Class class_of(const Combination& c) {
    if (c.terms.size() > 8) return Class::v16;
    if (c.texels.size() > kUniqueReceivers) return Class::u;
    return c.terms.size() > 4 ? Class::v8 : Class::q;
}

/// Cuts a combination into pieces of at most `limit` texels that lie close together.
std::vector<Combination> split(const std::vector<PackagePage>& pages, Combination c, size_t limit) {
    sort_morton(pages, c.texels);
    std::vector<Combination> pieces;
    for (size_t begin = 0; begin < c.texels.size(); begin += limit) {
        const auto from = c.texels.begin() + static_cast<long>(begin);
        const auto to = c.texels.begin() + static_cast<long>(std::min(begin + limit, c.texels.size()));
        pieces.push_back({c.page, c.is_signed, c.terms, {from, to}});
    }
    return pieces;
}

/// Texels of a page with so many terms that nearly each has a list of its own, as runs of neighbours.
std::vector<Combination> find_pieces(const std::vector<PackagePage>& pages, const TermLists& lists) {
    std::vector<Combination> found;
    uint32_t texel = 0;
    for (uint32_t page = 0; page < pages.size(); ++page) {
        Combination whole[2] = {{page, false, {}, {}}, {page, true, {}, {}}};
        for (const uint32_t end = texel + pages[page].width * pages[page].height; texel < end; ++texel) {
            if (lists.count(texel) <= terms::kMaxListed) continue;
            const auto begin = lists.term.begin() + lists.first[texel];
            const bool is_signed =
                std::any_of(begin, begin + lists.count(texel), [&](uint16_t t) { return lists.terms[t].is_signed; });
            whole[is_signed].texels.push_back(texel);
        }
        for (Combination& c : whole)
            for (Combination& piece : split(pages, std::move(c), kPieceReceivers)) found.push_back(std::move(piece));
    }
    std::vector<uint8_t> has(lists.terms.size(), 0);
    for (Combination& c : found) {
        for (const uint32_t t : c.texels)
            for (uint32_t e = lists.first[t]; e < lists.first[t + 1]; ++e) has[lists.term[e]] = 1;
        for (size_t t = 0; t < has.size(); ++t)
            if (std::exchange(has[t], uint8_t{0}) != 0) c.terms.push_back(static_cast<uint16_t>(t));
    }
    return found;
}

/// Receivers updated in vain, over changes of each term alone, if c joined d; none if it cannot.
/// has: [terms] 1 for those of c.
uint64_t waste(const PlannedDispatch& d, const Combination& c, const std::vector<uint8_t>& has) {
    constexpr uint64_t kNever = ~uint64_t{0};
    if (d.texels.size() + c.texels.size() > kSharedReceivers) return kNever;
    size_t shared = 0;
    for (const uint16_t term : d.palette) shared += has[term];
    if (d.kind != Class::b && d.palette.size() + c.terms.size() - shared > terms::kMaxPalette) return kNever;
    return (c.terms.size() - shared) * d.texels.size() + (d.palette.size() - shared) * c.texels.size();
}

void join(PlannedDispatch& d, const Combination& c) {
    std::vector<uint16_t> palette;
    std::set_union(d.palette.begin(), d.palette.end(), c.terms.begin(), c.terms.end(), std::back_inserter(palette));
    d.palette = std::move(palette);
    d.texels.insert(d.texels.end(), c.texels.begin(), c.texels.end());
    d.k = std::max(d.k, static_cast<uint32_t>(c.terms.size()));
}

/// Puts combinations of one page, class and layout together, greedily, largest first
/// (algorithms.md 8.5).
std::vector<PlannedDispatch> cluster(Class kind, std::vector<Combination> pieces, size_t terms) {
    std::stable_sort(pieces.begin(), pieces.end(),
                     [](const auto& a, const auto& b) { return a.texels.size() > b.texels.size(); });
    std::vector<PlannedDispatch> dispatches;
    std::vector<uint8_t> has(terms, 0);
    for (const Combination& c : pieces) {
        for (const uint16_t term : c.terms) has[term] = 1;
        PlannedDispatch* best = nullptr;
        uint64_t least = kDispatchCost;
        const size_t oldest = dispatches.size() > kOpenDispatches ? dispatches.size() - kOpenDispatches : 0;
        for (size_t i = oldest; i < dispatches.size(); ++i) {
            const uint64_t w = waste(dispatches[i], c, has);
            if (w < least) least = w, best = &dispatches[i];
        }
        if (best == nullptr) best = &dispatches.emplace_back(PlannedDispatch{kind, 0, c.is_signed, c.page, {}, {}});
        join(*best, c);
        for (const uint16_t term : c.terms) has[term] = 0;
    }
    return dispatches;
}

uint32_t most_terms(const TermLists& lists, const std::vector<uint32_t>& texels) {
    uint32_t most = 0;
    for (const uint32_t texel : texels) most = std::max(most, lists.count(texel));
    return most;
}

/// Combinations that may share a dispatch: page, class, terms per receiver (class Q), layout.
using GroupKey = std::tuple<uint32_t, Class, size_t, bool>;

} // namespace

TexelPlace place_of(const std::vector<PackagePage>& pages, uint32_t texel) {
    uint32_t page = 0;
    for (; texel >= pages[page].width * pages[page].height; ++page) texel -= pages[page].width * pages[page].height;
    return {page, texel % pages[page].width, texel / pages[page].width};
}

std::vector<PlannedDispatch> plan_dispatches(const std::vector<PackagePage>& pages, const TermLists& lists) {
    std::map<GroupKey, std::vector<Combination>> groups;
    std::vector<PlannedDispatch> plan;
    for (Combination& c : find_combinations(pages, lists)) {
        const Class kind = class_of(c);
        const uint32_t k = static_cast<uint32_t>(c.terms.size());
        const size_t limit = kind == Class::u ? terms::kMaxEntries / k : kSharedReceivers;
        const GroupKey key{c.page, kind, kind == Class::q ? k : 0, c.is_signed};
        for (Combination& piece : split(pages, std::move(c), limit)) {
            if (kind == Class::u)
                plan.push_back({kind, k, piece.is_signed, piece.page, piece.terms, std::move(piece.texels)});
            else
                groups[key].push_back(std::move(piece));
        }
    }
    for (Combination& piece : find_pieces(pages, lists))
        groups[{piece.page, Class::b, 0, piece.is_signed}].push_back(std::move(piece));
    for (auto& [key, pieces] : groups)
        for (PlannedDispatch& d : cluster(std::get<1>(key), std::move(pieces), lists.terms.size())) {
            sort_morton(pages, d.texels);
            if (d.kind == Class::b) d.k = most_terms(lists, d.texels);
            plan.push_back(std::move(d));
        }
    return plan;
}

} // namespace ajar
