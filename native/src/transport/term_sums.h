// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "receiver/lightmap.h"
#include "sampling/sh.h"
#include "transport/term_table.h"

namespace ajar {

/// Running sums of one tile for every term that reaches it. A slot is made when its term first
/// arrives; a sample costs one cache line per term it carries.
class TermSums {
public:
    /// One term at one receiver.
    struct alignas(64) Block {
        float sh[kShCount] = {}; ///< luminance of incident radiance
        float irradiance[3] = {};
        float last = 0.0f; ///< luminance of the last sample that brought light
        float last_sample = -1.0f;
        double squares = 0.0; ///< sum of squared differences inside pairs of samples

        // (a - b)^2 in parts: samples without light for the term need no visit.
        void book(uint32_t sample, float value) {
            squares += double(value) * value;
            if ((sample & 1) != 0 && last_sample == static_cast<float>(sample - 1)) squares -= 2.0 * value * last;
            last = value;
            last_sample = static_cast<float>(sample);
        }
        Vec3 color() const { return {irradiance[0], irradiance[1], irradiance[2]}; }
    };

    explicit TermSums(const TermTable& table)
        : table_(table),
          slot_of_id_(table.count(), kNone),
          slots_at_(kTileReceivers),
          total_(kTileReceivers),
          cosine_sum_(kTileReceivers, 0.0f),
          inside_(kTileReceivers, 0.0f) {}

    uint32_t slots() const { return static_cast<uint32_t>(terms_.size()); }
    const Term& term(uint32_t slot) const { return terms_[slot]; }
    const Block& block(uint32_t slot, uint32_t lane) const { return blocks_[slot][lane]; }
    /// Slots that brought light to a lane, in the order of their coming.
    const std::vector<uint32_t>& slots_at(uint32_t lane) const { return slots_at_[lane]; }
    uint32_t slot_of(uint32_t term_id) {
        uint32_t& s = slot_of_id_[term_id];
        if (s == kNone) s = make_slot(table_[term_id]);
        return s;
    }
    uint32_t slot_of(const Term& term) {
        Recent& recent = recent_[TermHash()(term) % kRecent];
        if (recent.slot == kNone || recent.term != term) recent = {term, look_up(term)};
        return recent.slot;
    }
    /// Collects what one sample brings; end_sample() books it.
    void arrive(uint32_t slot, const Vec3& light) {
        if (mark_[slot] < pending_.size() && pending_[mark_[slot]].slot == slot) {
            pending_[mark_[slot]].light += light;
            return;
        }
        mark_[slot] = static_cast<uint32_t>(pending_.size());
        pending_.push_back({slot, light});
    }
    /// Books the pending light of a sample from direction w (local), scaled to flux density facing w.
    void end_sample(uint32_t lane, uint32_t sample, const Vec3& w, float scale);

    /// Every sample, also one without light, adds cosine / density: pi per sample on average.
    void add_cosine(uint32_t lane, float value) { cosine_sum_[lane] += value; }
    void add_inside(uint32_t lane) { inside_[lane] += 1.0f; }
    float cosine_sum(uint32_t lane) const { return cosine_sum_[lane]; }
    float inside(uint32_t lane) const { return inside_[lane]; }
    /// Squares of the luminance of all terms together: everything open, present and lit.
    double total_squares(uint32_t lane) const { return std::max(0.0, total_[lane].squares); }

    static constexpr uint32_t kNone = 0xffffffffu;

private:
    struct Pending {
        uint32_t slot;
        Vec3 light;
    };
    /// A product of a condition and a term that was asked for lately: few of them come again and again.
    struct Recent {
        Term term;
        uint32_t slot = kNone;
    };
    static constexpr size_t kRecent = 1024;

    uint32_t look_up(const Term& term) {
        const uint32_t id = table_.find(term);
        if (id != TermTable::kUnknown) return slot_of(id);
        const auto [it, made] = slot_of_new_.try_emplace(term, slots());
        if (made) make_slot(term);
        return it->second;
    }
    uint32_t make_slot(const Term& term) {
        terms_.push_back(term);
        blocks_.emplace_back(kTileReceivers);
        mark_.push_back(kNone);
        return slots() - 1;
    }

    const TermTable& table_;
    std::vector<uint32_t> slot_of_id_;
    std::unordered_map<Term, uint32_t, TermHash> slot_of_new_;
    std::vector<Term> terms_;
    std::vector<std::vector<Block>> blocks_;
    std::vector<std::vector<uint32_t>> slots_at_;
    std::vector<Block> total_;
    std::vector<float> cosine_sum_, inside_;
    std::vector<uint32_t> mark_;
    std::vector<Pending> pending_;
    std::vector<Recent> recent_{kRecent};
};

inline void TermSums::end_sample(uint32_t lane, uint32_t sample, const Vec3& w, float scale) {
    if (pending_.empty()) return;
    float y[kShCount], total = 0.0f;
    sh_basis(w.x, w.y, w.z, y);
    for (const Pending& p : pending_) {
        Block& b = blocks_[p.slot][lane];
        const Vec3 facing = p.light * scale;
        const float l = luminance(facing), along = l * w.z;
        if (!std::isfinite(l)) continue;
        if (b.last_sample < 0.0f) slots_at_[lane].push_back(p.slot);
        for (int i = 0; i < kShCount; ++i) b.sh[i] += y[i] * l;
        for (int c = 0; c < 3; ++c) b.irradiance[c] += facing[c] * w.z;
        b.book(sample, along);
        total += along;
    }
    total_[lane].book(sample, total);
    pending_.clear();
}

} // namespace ajar
