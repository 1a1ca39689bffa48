// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>

#include "base/lanes.h"
#include "receiver/lightmap.h"
#include "sampling/sh.h"
#include "transport/term_table.h"

namespace ajar {

/// Running sums of one tile for every term that reaches it. A slot is made when its term is first
/// asked for, its sums where it arrives; a sample costs one cache line per term it carries.
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
    /// TermTable::all_on of a slot's term.
    float all_on(uint32_t slot) const { return all_on_[slot]; }
    const Term& term(uint32_t slot) const { return terms_[slot]; }
    /// Null where the term has not arrived at the lane or its neighbours.
    const Block* block(uint32_t slot, uint32_t lane) const {
        const Block* group = groups_[slot][lane / kLanes];
        return group != nullptr ? group + lane % kLanes : nullptr;
    }
    /// Slots that brought light to a lane, in the order of their coming.
    const std::vector<uint32_t>& slots_at(uint32_t lane) const { return slots_at_[lane]; }
    uint32_t slot_of(uint32_t term_id) {
        uint32_t& s = slot_of_id_[term_id];
        if (s == kNone) s = make_slot(table_[term_id]);
        return s;
    }
    /// Slot of the term of a light set alone, or of the base for kNoElement.
    uint32_t slot_of_set(uint32_t set) {
        const size_t i = static_cast<uint32_t>(set + 1); // kNoElement becomes 0
        if (i >= slot_of_set_.size()) slot_of_set_.resize(i + 1, kNone);
        if (slot_of_set_[i] == kNone) slot_of_set_[i] = slot_of(Term(set));
        return slot_of_set_[i];
    }
    uint32_t slot_of(const Term& term) {
        Recent& recent = recent_[TermHash()(term) % kRecent];
        if (recent.slot == kNone || recent.term != term) recent = {term, look_up(term)};
        return recent.slot;
    }
    /// Slot of the product of a slot's term and the variable of a door or toggle: the same where the term has it
    /// already, kCut where it would have too many elements, kNone where keeps(product) is false. Worked out once.
    /// order: most elements of a term.
    template <class Keeps>
    uint32_t times(uint32_t slot, uint32_t element, uint32_t order, const Keeps& keeps) {
        if (element >= products_.size()) products_.resize(element + 1);
        std::vector<uint32_t>& row = products_[element];
        if (slot >= row.size()) row.resize(slots() + slots() / 2, kNotAsked);
        if (row[slot] == kNotAsked) {
            Term product = terms_[slot];
            row[slot] = !product.multiply(element) || product.order() > order ? kCut
                        : keeps(product)                                      ? slot_of(product)
                                                                              : kNone;
        }
        return row[slot];
    }
    /// Counts light of one sample that no term has room for, and the door or toggle that it does not follow.
    void cut(uint32_t element, const Vec3& light) { pending_cuts_.push_back({element, std::abs(luminance(light))}); }
    /// Counts light of one sample that depends on doors or toggles. at_start: share of it that passes them at the start
    /// and so is in a term without them too.
    void meet(const Vec3& light, float at_start) {
        const float amount = std::abs(luminance(light));
        pending_met_ += amount;
        pending_started_ += amount * at_start;
    }
    /// Irradiance that was cut so, per element, in the unit of the blocks, summed over the lanes.
    const std::unordered_map<uint32_t, double>& cuts() const { return cuts_; }
    /// Collects what one sample brings; end_sample() books it.
    void arrive(uint32_t slot, const Vec3& light) {
        if (mark_[slot] < pending_.size() && pending_[mark_[slot]].slot == slot) {
            pending_[mark_[slot]].light += light;
            return;
        }
        mark_[slot] = static_cast<uint32_t>(pending_.size());
        pending_.push_back({slot, light});
    }
    /// The same for every entry of a row, times scale.
    void arrive(const TermColor* begin, const TermColor* end, const Vec3& scale) {
        if (!pending_.empty()) {
            for (; begin != end; ++begin) arrive(slot_of(begin->term), begin->color * scale);
            return;
        }
        // A row names each term once.
        pending_.resize(static_cast<size_t>(end - begin));
        for (uint32_t i = 0; i < pending_.size(); ++i) {
            const uint32_t slot = slot_of(begin[i].term);
            mark_[slot] = i;
            pending_[i] = {slot, begin[i].color * scale};
        }
    }
    /// Books the pending light of a sample from direction w (local), scaled to flux density facing w.
    void end_sample(uint32_t lane, uint32_t sample, const Vec3& w, float scale);

    /// Irradiance that met doors or toggles, which cuts() are a part of; unit as there.
    double met() const { return met_; }
    /// The part of met() that unswitched() has as well.
    double started() const { return started_; }
    /// Irradiance of terms without doors and toggles, magnitudes; unit as cuts().
    double unswitched() const {
        double sum = 0.0;
        for (uint32_t slot = 0; slot < slots(); ++slot) {
            if (terms_[slot].switch_count() != 0) continue;
            for (const Block* group : groups_[slot])
                for (uint32_t lane = 0; group != nullptr && lane < kLanes; ++lane)
                    sum += std::abs(luminance(group[lane].color()));
        }
        return sum;
    }

    /// Every sample, also one without light, adds cosine / density: pi per sample on average.
    void add_cosine(uint32_t lane, float value) { cosine_sum_[lane] += value; }
    void add_inside(uint32_t lane) { inside_[lane] += 1.0f; }
    float cosine_sum(uint32_t lane) const { return cosine_sum_[lane]; }
    float inside(uint32_t lane) const { return inside_[lane]; }
    /// Squares of the luminance of all terms together while everything is open, present and lit.
    double total_squares(uint32_t lane) const { return std::max(0.0, total_[lane].squares); }

    static constexpr uint32_t kNone = 0xffffffffu, kCut = kNone - 1;

private:
    static constexpr uint32_t kNotAsked = kNone - 2;
    static constexpr uint32_t kGroups = kTileReceivers / kLanes, kChunkGroups = 64;

    struct Pending {
        uint32_t slot;
        Vec3 light;
    };
    struct PendingCut {
        uint32_t element;
        float light;
    };
    /// A term without a number that was asked for lately: few of them come again and again.
    struct Recent {
        Term term;
        uint32_t slot = kNone;
    };
    static constexpr size_t kRecent = 1024;

    /// Luminance of what one sample brings while everything is open, present and lit.
    float pending_all_on() const {
        float sum = 0.0f;
        for (const Pending& p : pending_)
            if (const float l = luminance(p.light); std::isfinite(l)) sum += l * all_on_[p.slot];
        return sum;
    }
    uint32_t look_up(const Term& term) {
        const uint32_t id = table_.find(term);
        if (id != TermTable::kUnknown) return slot_of(id);
        const auto [it, made] = slot_of_new_.try_emplace(term, slots());
        if (made) make_slot(term);
        return it->second;
    }
    uint32_t make_slot(const Term& term) {
        terms_.push_back(term);
        all_on_.push_back(table_.all_on(term));
        all_are_all_on_ = all_are_all_on_ && all_on_.back() == 1.0f;
        groups_.emplace_back();
        mark_.push_back(kNone);
        return slots() - 1;
    }
    Block& block_at(uint32_t slot, uint32_t lane) {
        Block*& group = groups_[slot][lane / kLanes];
        if (group == nullptr) group = make_group();
        return group[lane % kLanes];
    }
    Block* make_group() {
        if (next_group_ % kChunkGroups == 0) chunks_.push_back(std::make_unique<Block[]>(kChunkGroups * kLanes));
        return &chunks_.back()[next_group_++ % kChunkGroups * kLanes];
    }

    const TermTable& table_;
    std::vector<uint32_t> slot_of_id_;
    std::unordered_map<Term, uint32_t, TermHash> slot_of_new_;
    std::vector<uint32_t> slot_of_set_; ///< by set + 1
    std::vector<Term> terms_;
    std::vector<float> all_on_;                       ///< per slot: TermTable::all_on
    bool all_are_all_on_ = true;                      ///< every slot's is 1
    std::vector<std::array<Block*, kGroups>> groups_; ///< per slot, the sums of eight lanes; null where it never came
    std::vector<std::unique_ptr<Block[]>> chunks_;
    uint32_t next_group_ = 0;
    std::vector<std::vector<uint32_t>> products_; ///< per element and slot
    std::vector<std::vector<uint32_t>> slots_at_;
    std::vector<Block> total_;
    std::vector<float> cosine_sum_, inside_;
    std::vector<uint32_t> mark_;
    std::vector<Pending> pending_;
    std::vector<PendingCut> pending_cuts_;
    float pending_met_ = 0.0f, pending_started_ = 0.0f;
    double met_ = 0.0, started_ = 0.0;
    std::unordered_map<uint32_t, double> cuts_;
    std::vector<Recent> recent_{kRecent};
};

inline void TermSums::end_sample(uint32_t lane, uint32_t sample, const Vec3& w, float scale) {
    if (pending_met_ != 0.0f) {
        met_ += double{pending_met_} * scale * w.z;
        started_ += double{pending_started_} * scale * w.z;
        for (const PendingCut& c : pending_cuts_) cuts_[c.element] += double{c.light} * scale * w.z;
        pending_met_ = pending_started_ = 0.0f;
        pending_cuts_.clear();
    }
    if (pending_.empty()) return;
    static_assert(kShCount == kLanes + 1);
    alignas(32) float y[kShCount];
    float total = 0.0f;
    sh_basis(w.x, w.y, w.z, y);
    const Lanes basis = lanes(y);
    for (const Pending& p : pending_) {
        Block& b = block_at(p.slot, lane);
        const Vec3 facing = p.light * scale;
        const float l = luminance(facing), along = l * w.z;
        if (!std::isfinite(l)) continue;
        if (b.last_sample < 0.0f) slots_at_[lane].push_back(p.slot);
        lanes(b.sh) += basis * l;
        b.sh[kLanes] += y[kLanes] * l;
        for (int c = 0; c < 3; ++c) b.irradiance[c] += facing[c] * w.z;
        b.book(sample, along);
        total += along;
    }
    total_[lane].book(sample, all_are_all_on_ ? total : pending_all_on() * scale * w.z);
    pending_.clear();
}

} // namespace ajar
