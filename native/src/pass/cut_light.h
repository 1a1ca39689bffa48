// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <map>

#include "transport/term_sums.h"

namespace ajar {

/// Light that depends on more doors and toggles at once than a term holds: it stays as it is at the start. Irradiance
/// summed over receivers, W/m^2, magnitudes.
struct CutLight {
    double all = 0.0;                      ///< light that it is a part of
    std::map<uint32_t, double> of_element; ///< that does not follow an element
    uint32_t most_elements = 0;            ///< of a term, anywhere

    /// What was cut, and what met doors or toggles; the rest of the light is to be added to all. scale: from the unit
    /// of sums to irradiance.
    void add(const TermSums& sums, double scale) {
        all += sums.met() * scale;
        for (const auto& [element, light] : sums.cuts()) of_element[element] += light * scale;
    }
    /// Light that passes at the start is both in what met doors or toggles and in the terms without them.
    void count_once(const TermSums& sums, double scale) { all -= sums.started() * scale; }
    void add(const CutLight& other) {
        all += other.all;
        for (const auto& [element, light] : other.of_element) of_element[element] += light;
        most_elements = std::max(most_elements, other.most_elements);
    }
    double share() const {
        double sum = 0.0;
        for (const auto& [element, light] : of_element) sum += light;
        return share_of(sum);
    }
    double share_of(double light) const { return all > 0.0 ? light / all : 0.0; }
};

} // namespace ajar
