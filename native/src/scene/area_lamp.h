// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/light.h"

namespace ajar {

/// Samples an area lamp from p with two numbers in [0,1): with a spread, only what p is lit by.
LightSample sample_area_lamp(const Light& lamp, const Vec3& p, const Vec2& u);

/// Roughly the unshadowed irradiance luminance of an area lamp near p on a surface with unit normal n; 0 only if
/// no part of the lamp can light the surface within reach (m) of p.
float area_lamp_importance(const Light& lamp, const Vec3& p, const Vec3& n, float reach);

} // namespace ajar
