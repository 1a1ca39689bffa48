// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Terms and conditions: which products of elements light depends on. Light is linear in the lamps, so a term holds
// one light set at most. Weights of doors and toggles are idempotent (w * w = w) at the states that count, 0 and 1,
// so a product holds each once, as its variable x (Element::variable), which is 0 at the start.

#include <array>
#include <cstddef>
#include <vector>

#include "ajar/ajar.h"
#include "scene/element.h"

namespace ajar {

inline constexpr uint32_t kTermSwitches = AJAR_MAX_TERM_ELEMENTS - 1; ///< doors and toggles of a term beside a set

/// A product of elements: an optional light set and up to kTermSwitches doors and toggles.
class Term {
public:
    Term() = default;
    /// set is an element id or kNoElement.
    explicit Term(uint32_t set) : key_{set == kNoElement ? 0 : uint64_t{set + 1} << 48, 0} {}

    uint32_t set() const { return static_cast<uint32_t>(key_[0] >> 48) - 1; } ///< kNoElement if none
    /// Switch i of count(), ascending.
    uint32_t element(uint32_t i) const {
        const uint64_t ids = i < kFirstIds ? key_[0] >> (16 * i) : key_[1] >> (16 * (i - kFirstIds));
        return static_cast<uint32_t>(ids & 0xffff) - 1;
    }
    uint32_t switch_count() const {
        uint32_t n = 0;
        while (n < kTermSwitches && element(n) != kNoElement) ++n;
        return n;
    }
    uint32_t order() const { return switch_count() + (set() != kNoElement); }
    bool is_base() const { return (key_[0] | key_[1]) == 0; }
    bool contains(uint32_t element_id) const {
        for (uint32_t i = 0; i < switch_count(); ++i)
            if (element(i) == element_id) return true;
        return false;
    }
    /// Multiplies by the variable of a door or toggle; false if the term is full.
    bool multiply(uint32_t element_id) {
        if (contains(element_id)) return true;
        std::array<uint64_t, kTermSwitches + 1> ids{};
        uint32_t n = switch_count();
        if (n == kTermSwitches) return false;
        for (uint32_t i = 0; i < n; ++i) ids[i] = element(i) + 1;
        for (ids[n] = element_id + 1; n > 0 && ids[n - 1] > ids[n]; --n) std::swap(ids[n - 1], ids[n]);
        key_ = {key_[0] & 0xffff000000000000ull, 0};
        for (uint32_t i = 0; i < kTermSwitches; ++i)
            key_[i >= kFirstIds] |= ids[i] << (16 * (i < kFirstIds ? i : i - kFirstIds));
        return true;
    }
    /// Leaves a door or toggle out.
    Term without(uint32_t element_id) const {
        Term out(set());
        for (uint32_t i = 0; i < switch_count(); ++i)
            if (element(i) != element_id) out.multiply(element(i));
        return out;
    }
    /// The same doors and toggles with another light set, or none.
    Term of_set(uint32_t light_set) const {
        Term out(light_set);
        out.key_[0] |= key_[0] & 0xffffffffffffull;
        out.key_[1] = key_[1];
        return out;
    }
    size_t hash() const {
        const uint64_t h = (key_[0] ^ (key_[1] * 0xc2b2ae3d27d4eb4full)) * 0x9e3779b97f4a7c15ull;
        return static_cast<size_t>(h ^ (h >> 29));
    }
    bool operator==(const Term& other) const { return key_[0] == other.key_[0] && key_[1] == other.key_[1]; }
    bool operator<(const Term& other) const { return key_ < other.key_; }

private:
    static constexpr uint32_t kFirstIds = 3; ///< switches in the first word
    static_assert(kTermSwitches <= kFirstIds + 4);

    /// 16 bits for each id + 1: the set above three switches, then the other switches; ascending.
    std::array<uint64_t, 2> key_{};
};

struct TermHash {
    size_t operator()(const Term& t) const { return t.hash(); }
};

/// Elements' variables at weight 1, multiplied: what a term brings while everything is open, present and lit.
inline float all_on_factor(const std::vector<Element>& elements, const Term& term) {
    float product = 1.0f;
    for (uint32_t i = 0; i < term.switch_count(); ++i) product *= elements[term.element(i)].variable(1.0f);
    return product;
}

/// States of doors and toggles that a path needs: the product of the presences, w or 1 - w, of the switchable
/// surfaces that it meets or passes.
class Condition {
public:
    /// As many as one term holds, so that light along a path stays between none and all of it at every state.
    static constexpr uint32_t kCapacity = kTermSwitches;

    /// The path needs a surface to be there. Returns false if it needs the opposite already, so that no light takes
    /// such a path. Beyond kCapacity elements a state counts as it is at the start: light of such a path is right
    /// there, and does not follow the element.
    bool require(const std::vector<Element>& elements, const Presence& p) {
        for (uint32_t i = 0; i < count_; ++i)
            if (element_[i] == p.element) return state_[i] == p.state;
        if (count_ == kCapacity) return count_at_start(elements, p);
        element_[count_] = static_cast<uint16_t>(p.element);
        state_[count_++] = p.state;
        return true;
    }
    /// Whether a state of this element would be followed, or counts as it is at the start.
    bool follows(uint32_t element) const {
        for (uint32_t i = 0; i < count_; ++i)
            if (element_[i] == element) return true;
        return count_ < kCapacity;
    }
    /// The path goes on through a see-through surface whose element is not followed; what passes at the start is for
    /// the caller to multiply.
    void leave_at_start(uint32_t element) { not_followed_ = element; }
    /// The state is a fact for this receiver, which lies on the element's own surface: it takes
    /// part in contradictions but not in the product.
    void assume(const Presence& p) {
        element_[0] = static_cast<uint16_t>(p.element);
        state_[0] = p.state;
        count_ = assumed_ = 1;
    }
    /// Every term passes as it is.
    bool empty() const { return count_ == 0; }

    uint32_t count() const { return count_; }
    Presence operator[](uint32_t i) const { return {element_[i], state_[i]}; }
    /// Whether the first one is the receiver's own surface.
    bool has_assumed() const { return assumed_ != 0; }
    /// Product of the presences beyond kCapacity, at the start.
    float at_start() const { return at_start_; }
    /// The last of those elements; kNoElement if there are none.
    uint32_t not_followed() const { return not_followed_; }

private:
    // A path that brings nothing at the start is followed to its end all the same: what is cut is counted.
    bool count_at_start(const std::vector<Element>& elements, const Presence& p) {
        not_followed_ = p.element;
        const auto id = static_cast<uint16_t>(p.element);
        for (uint32_t i = 0; i < beyond_count_; ++i)
            if (beyond_[i] == id) return (beyond_states_ >> i & 1u) == p.state;
        const float at_start = presence_factors(elements[p.element], p.state).constant;
        at_start_ *= at_start;
        // 0 and 1 are what they are however often they come.
        if (at_start == 0.0f || at_start == 1.0f || beyond_count_ == kBeyond) return true;
        beyond_states_ = static_cast<uint8_t>(beyond_states_ | (p.state ? 1u : 0u) << beyond_count_);
        beyond_[beyond_count_++] = id;
        return true;
    }

    /// Elements beyond kCapacity, partly there at the start, that a path remembers: a second surface of the same counts
    /// once. More than these on one ray count as many times as they are met.
    static constexpr uint32_t kBeyond = 8;

    uint16_t element_[kCapacity] = {}, beyond_[kBeyond] = {};
    bool state_[kCapacity] = {};
    uint8_t count_ = 0, assumed_ = 0, beyond_count_ = 0, beyond_states_ = 0;
    float at_start_ = 1.0f;
    uint32_t not_followed_ = kNoElement;
};

} // namespace ajar
