// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <unordered_map>
#include <vector>

#include "base/math.h"
#include "scene/term.h"

namespace ajar {

/// Numbers the terms that the bake has met. Grows between passes only, in the order of the terms,
/// so numbers do not depend on threads. Term 0 is the base.
class TermTable {
public:
    /// elements: those that terms name; they must outlive the table.
    explicit TermTable(const std::vector<Element>& elements) : elements_(elements) { add({Term()}); }

    uint32_t count() const { return static_cast<uint32_t>(terms_.size()); }
    const Term& operator[](uint32_t id) const { return terms_[id]; }
    /// Number of a term, or kUnknown.
    uint32_t find(const Term& term) const {
        const auto it = ids_.find(term);
        return it == ids_.end() ? kUnknown : it->second;
    }
    /// Takes in terms that are new; known ones keep their number.
    void add(std::vector<Term> terms) {
        std::sort(terms.begin(), terms.end());
        for (const Term& t : terms)
            if (ids_.try_emplace(t, count()).second) {
                terms_.push_back(t);
                all_on_.push_back(all_on(t));
            }
    }
    /// What a term brings while all weights are 1: everything open, present and lit.
    float all_on(const Term& term) const { return all_on_factor(elements_, term); }
    float all_on(uint32_t id) const { return all_on_[id]; }
    static constexpr uint32_t kUnknown = 0xffffffffu;

private:
    const std::vector<Element>& elements_;
    std::vector<Term> terms_;
    std::vector<float> all_on_;
    std::unordered_map<Term, uint32_t, TermHash> ids_;
};

/// A colour for one term.
struct TermColor {
    uint32_t term; ///< number in the TermTable
    Vec3 color;
};

/// Sparse rows, one per page texel: the radiance of each term there.
struct TermRows {
    std::vector<uint64_t> first; ///< [texels + 1]
    std::vector<TermColor> entries;
    std::vector<uint8_t> flags; ///< [texels] TexelFlag

    const TermColor* begin(uint32_t texel) const { return entries.data() + first[texel]; }
    const TermColor* end(uint32_t texel) const { return entries.data() + first[texel + 1]; }
};

/// What a lookup must know of a texel beside its light.
enum TexelFlag : uint8_t {
    kTexelBright = 1, ///< emitter samples aim at it too
    kTexelCut = 2     ///< a wall runs through it: its light belongs to one side only
};

} // namespace ajar
