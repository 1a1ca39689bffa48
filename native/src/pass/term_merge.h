// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <functional>
#include <vector>

#include "base/parallel.h"
#include "receiver/lightmap.h"
#include "transport/term_sums.h"

namespace ajar {

/// Sparse rows of one tile, before its terms have numbers that all tiles share.
struct TileRows {
    std::vector<Term> terms;
    std::vector<uint32_t> count;    ///< [receivers of the tile] entries of each
    std::vector<TermColor> entries; ///< term = index into terms
};

/// Sparse rows over all receivers: irradiance of each term, ascending.
struct ReceiverRows {
    std::vector<uint64_t> first{0};   ///< [receivers + 1]
    std::vector<TermColor> entries;   ///< of receivers that gather coarse light themselves
    const uint32_t* row_of = nullptr; ///< [receivers] the receiver whose row each has; none before there are rows

    const TermColor* begin(uint32_t r) const { return entries.data() + first[row_of[r]]; }
    const TermColor* end(uint32_t r) const { return entries.data() + first[row_of[r] + 1]; }
    /// Of all terms while everything is open, present and lit.
    Vec3 total(const TermTable& table, uint32_t r) const;
    /// Irradiance of one term at a receiver; 0 where the row lacks it.
    Vec3 of(uint32_t r, uint32_t term) const;
};

/// The terms of several sums side by side, each once, ascending.
std::vector<Term> union_of_terms(const std::vector<const TermSums*>& sums);

/// Numbers below a limit, each once.
class NumberSet {
public:
    explicit NumberSet(size_t limit) : words_((limit + 63) / 64, 0) {}
    void add(uint32_t number) { words_[number / 64] |= uint64_t{1} << (number % 64); }
    /// Moves them out, ascending.
    void take(std::vector<uint32_t>& out) {
        for (size_t w = 0; w < words_.size(); ++w)
            for (; words_[w] != 0; words_[w] &= words_[w] - 1)
                out.push_back(static_cast<uint32_t>(64 * w) + static_cast<uint32_t>(std::countr_zero(words_[w])));
    }

private:
    std::vector<uint64_t> words_;
};

/// How the slots of some sums and a list of terms, ascending, belong together.
class TermIndex {
public:
    TermIndex(const TermSums& sums, const std::vector<Term>& terms);
    /// What a term brings to a lane; null if it arrived neither there nor near it.
    const TermSums::Block* block(size_t term, uint32_t lane) const {
        return slot_[term] != TermSums::kNone ? sums_->block(slot_[term], lane) : nullptr;
    }
    /// Adds the terms that bring light to a lane.
    void collect(uint32_t lane, NumberSet& out) const {
        for (const uint32_t slot : sums_->slots_at(lane)) out.add(term_[slot]);
    }

private:
    const TermSums* sums_;
    std::vector<uint32_t> slot_, term_; ///< of each term, of each slot
};

/// Works on rows in parallel; results do not depend on the number of threads. All throw Cancelled.
class RowMaker {
public:
    RowMaker(ThreadPool& pool, Progress& progress, const LightmapReceivers& receivers)
        : pool_(pool), progress_(progress), receivers_(receivers) {}

    /// Joins the rows of all tiles; terms that are new get their numbers in table.
    ReceiverRows merge_tiles(std::vector<TileRows>& tiles, TermTable& table) const;
    /// Entry by entry sum of two sets of rows.
    ReceiverRows add_rows(const ReceiverRows& a, const ReceiverRows& b) const;
    /// Outgoing radiance per page texel of receivers with these irradiances.
    TermRows radiance_rows(const ReceiverRows& irradiance, uint64_t texels) const;

    /// Rows of the receivers that have their own: make(r, out) appends the entries of r.
    using Make = std::function<void(uint32_t, std::vector<TermColor>&)>;
    ReceiverRows receiver_rows(const Make& make) const;

private:
    struct Part;
    ReceiverRows make_rows(uint64_t count, const std::function<void(uint64_t, std::vector<TermColor>&)>& make) const;
    ReceiverRows join(std::vector<Part>& parts) const;

    ThreadPool& pool_;
    Progress& progress_;
    const LightmapReceivers& receivers_;
};

} // namespace ajar
