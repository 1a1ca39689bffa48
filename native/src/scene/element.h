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
};

/// What keeping the light of these elements apart counts as: the first kind of three that there is.
Effect bookkeeping_effect(const std::vector<Element>& elements);

} // namespace ajar
