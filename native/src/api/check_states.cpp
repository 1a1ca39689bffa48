// SPDX-License-Identifier: GPL-3.0-or-later
#include "api/check_states.h"

#include <algorithm>

#include "reference/random.h"

namespace ajar {

namespace {

constexpr uint64_t kStateStream = 0x57a7e5; ///< of random numbers, apart from those of points and paths
constexpr int kRandomStates = 4;

} // namespace

std::vector<CheckedState> states_to_check(const std::vector<Element>& elements, uint64_t seed) {
    CheckedState start{"start", {}}, all_on{"all on", std::vector<float>(elements.size(), 1.0f)},
        all_changed{"all changed", {}};
    for (const Element& e : elements) {
        start.weights.push_back(e.weight);
        all_changed.weights.push_back(e.is_switch() && e.weight >= 0.5f ? 0.0f : 1.0f);
    }
    std::vector<CheckedState> out{start};
    if (elements.empty()) return out;
    for (const CheckedState& state : {all_on, all_changed})
        if (state.weights != start.weights && state.weights != out.back().weights) out.push_back(state);
    Pcg random(seed, kStateStream);
    for (int i = 0; i < kRandomStates; ++i) {
        CheckedState state{"random " + std::to_string(i + 1), {}};
        for (const Element& e : elements) {
            const float w = random.uniform();
            state.weights.push_back(e.is_switch() && i < kRandomStates / 2 ? (w < 0.5f ? 0.0f : 1.0f) : w);
        }
        out.push_back(std::move(state));
    }
    return out;
}

uint32_t points_of_state(uint32_t wished, size_t states) {
    return std::max(1u, wished / static_cast<uint32_t>(std::max<size_t>(states, 1)));
}

} // namespace ajar
