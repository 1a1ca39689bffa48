// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "reference/random.h"
#include "scene/light.h"

namespace ajar {

/// Lamps to choose one from. Every vertex of every path asks for the strength of all of them, so what that takes
/// lies in arrays of its own.
class LampTable {
public:
    struct Choice {
        uint32_t number = 0; ///< as given to add()
        float weight = 0.0f; ///< of the lamp's light set
        float chance = 1.0f;
    };

    /// weight: of the lamp's light set.
    void add(uint32_t number, const Light& lamp, float weight);
    bool empty() const { return choices_.empty(); }
    /// A lamp, by roughly the light that each sends to p, unshadowed, on a surface with normal n; a share of the
    /// choices goes to all alike.
    Choice choose(const Vec3& p, const Vec3& n, Pcg& random) const;

private:
    std::vector<Choice> choices_;
    std::vector<float> strength_, extent_; ///< W/sr, or W/m^2 of suns; half the lamp's size, m
    std::vector<float> x_, y_, z_;         ///< position, m; of suns the direction towards them
    std::vector<float> is_sun_;            ///< 1 or 0
};

} // namespace ajar
