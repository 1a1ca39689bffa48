// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/work_clock.h"

namespace ajar {

inline constexpr uint32_t kNoElement = 0xffffffffu;

enum class ElementKind { light_set, door, toggle };

/// Something that changes at run time, with one weight: strength of a light set, openness of a
/// door, presence of a toggle.
struct Element {
    std::string name;
    ElementKind kind = ElementKind::light_set;
    float weight = 1.0f;  ///< at the start
    bool combines = true; ///< may share a term with other elements
    bool bounces = true;  ///< door: the closed leaf reflects light

    bool is_switch() const { return kind != ElementKind::light_set; }

    /// The element's variable in the polynomial of light, at a weight. Of a light set it is the weight. Of a door or
    /// toggle it is the distance from the state at the start, so that products which a bake leaves out are 0 there:
    ///     x = 1 - w where it starts at 1, else x = w - start.
    float variable(float w) const { return is_switch() ? (weight == 1.0f ? 1.0f - w : w - weight) : w; }
};

/// When a switchable surface is there: while element is at state 1 or at state 0.
struct Presence {
    uint32_t element = kNoElement;
    bool state = true;

    Presence opposite() const { return {element, !state}; }
    bool operator==(const Presence&) const = default;
};

/// The presence P of a surface, w or 1 - w, in the element's variable x. Weights are idempotent (w * w = w), so
///     P = constant + linear x,    x P = kept x + freed.
struct PresenceFactors {
    float constant, linear, kept, freed;
};
inline PresenceFactors presence_factors(const Element& e, bool state) {
    const float start = e.weight, slope = (state ? 1.0f : -1.0f) * (start == 1.0f ? -1.0f : 1.0f);
    return {state ? start : 1.0f - start, slope, state ? 1.0f - start : start, slope * start * (1.0f - start)};
}

/// What keeping the light of these elements apart counts as: the first kind of three that there is.
Effect bookkeeping_effect(const std::vector<Element>& elements);

} // namespace ajar
