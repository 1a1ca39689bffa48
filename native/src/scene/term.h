// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Terms and conditions: which products of elements light depends on. Weights of doors and toggles
// are idempotent (w * w = w) at the states that count, 0 and 1, so every product is a set of
// distinct elements; light is linear in the lamps, so a term holds one light set at most.

#include <array>
#include <cstddef>
#include <functional>

#include "ajar/ajar.h"
#include "scene/element.h"

namespace ajar {

inline constexpr uint32_t kStoredTerms = 16; ///< of a receiver, beside the base: what the package has room for
inline constexpr uint32_t kTermSwitches = 3; ///< doors and toggles a term can hold beside a set

/// A product of elements: an optional light set and up to kTermSwitches doors and toggles.
class Term {
public:
    Term() = default;
    /// set is an element id or kNoElement.
    explicit Term(uint32_t set) : key_(set == kNoElement ? 0 : uint64_t{set + 1} << 48) {}

    uint32_t set() const { return static_cast<uint32_t>(key_ >> 48) - 1; } ///< kNoElement if none
    /// Switch i of count(), ascending.
    uint32_t element(uint32_t i) const { return static_cast<uint32_t>((key_ >> (16 * i)) & 0xffff) - 1; }
    uint32_t switch_count() const {
        uint32_t n = 0;
        while (n < kTermSwitches && element(n) != kNoElement) ++n;
        return n;
    }
    uint32_t order() const { return switch_count() + (set() != kNoElement); }
    bool is_base() const { return key_ == 0; }
    bool contains(uint32_t element_id) const {
        for (uint32_t i = 0; i < switch_count(); ++i)
            if (element(i) == element_id) return true;
        return false;
    }
    /// Multiplies by the weight of a door or toggle; false if the term is full.
    bool multiply(uint32_t element_id) {
        if (contains(element_id)) return true;
        std::array<uint64_t, kTermSwitches + 1> ids{};
        uint32_t n = switch_count();
        if (n == kTermSwitches) return false;
        for (uint32_t i = 0; i < n; ++i) ids[i] = element(i) + 1;
        for (ids[n] = element_id + 1; n > 0 && ids[n - 1] > ids[n]; --n) std::swap(ids[n - 1], ids[n]);
        key_ = (key_ & 0xffff000000000000ull) | ids[0] | (ids[1] << 16) | (ids[2] << 32);
        return true;
    }
    /// Replaces a door's or toggle's weight by 1.
    Term without(uint32_t element_id) const {
        Term out(set());
        for (uint32_t i = 0; i < switch_count(); ++i)
            if (element(i) != element_id) out.multiply(element(i));
        return out;
    }
    /// The same doors and toggles with another light set, or none.
    Term of_set(uint32_t light_set) const {
        Term out(light_set);
        out.key_ |= key_ & 0xffffffffffffull;
        return out;
    }
    uint64_t key() const { return key_; }
    bool operator==(const Term&) const = default;
    bool operator<(const Term& other) const { return key_ < other.key_; }

private:
    uint64_t key_ = 0; ///< set + 1 above three switches + 1, ascending, 16 bits each
};

struct TermHash {
    size_t operator()(const Term& t) const {
        const uint64_t h = t.key() * 0x9e3779b97f4a7c15ull;
        return static_cast<size_t>(h ^ (h >> 29));
    }
};

/// States of doors and toggles that a path needs: the product of w (there at 1) and 1 - w (there at
/// 0) over the switchable surfaces it meets or passes (design: "trace once").
class Condition {
public:
    static constexpr uint32_t kCapacity = 8;

    /// The path needs element at state 1 or 0. Returns false if it needs the opposite already: no
    /// light takes such a path.
    bool require(uint32_t element, bool state) {
        for (uint32_t i = 0; i < count_; ++i)
            if (element_[i] == element) return state_[i] == state;
        if (count_ == kCapacity) {
            return false;
        }
        element_[count_] = static_cast<uint16_t>(element);
        state_[count_++] = state;
        return true;
    }
    /// The state is a fact for this receiver, which lies on the element's own surface: it takes
    /// part in contradictions but not in the product.
    void assume(uint32_t element, bool state) {
        require(element, state);
        assumed_ = 1;
    }
    /// Every term passes as it is.
    bool empty() const { return count_ == 0; }

    uint32_t count() const { return count_; }
    uint32_t element(uint32_t i) const { return element_[i]; }
    bool state(uint32_t i) const { return state_[i]; }
    /// Whether the first one is the receiver's own surface.
    bool has_assumed() const { return assumed_ != 0; }

private:
    uint16_t element_[kCapacity] = {};
    bool state_[kCapacity] = {};
    uint8_t count_ = 0, assumed_ = 0;
};

} // namespace ajar
