// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "reference/random.h"
#include "scene/light.h"

namespace ajar {

/// A point of a lamp as seen from p.
struct LampPoint {
    Vec3 direction{0.0f};  ///< unit, towards the lamp
    float distance = 0.0f; ///< m; infinite for the sun
    Vec3 light{0.0f};      ///< W/m^2 facing it, over the density of the point
};

/// Uniform point of the lamp's area, or of the part of it that lights p.
LampPoint lamp_point(const Light& lamp, const Vec3& p, Pcg& random);

} // namespace ajar
