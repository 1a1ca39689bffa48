// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/element.h"

namespace ajar {

/// A state of all elements that a bake is judged in.
struct CheckedState {
    std::string name;
    std::vector<float> weights; ///< per element
};

/// The start, everything on, all light sets on with every door and toggle at the end that is far from its start, and
/// four by chance: light sets anywhere between off and on; doors and toggles at either end in two of them, anywhere
/// between in the others. None comes twice in a row. Without elements there is the start alone.
std::vector<CheckedState> states_to_check(const std::vector<Element>& elements, uint64_t seed);

/// Texels of each state, so that all states together look at as many as are wished for.
uint32_t points_of_state(uint32_t wished, size_t states);

} // namespace ajar
