// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/light.h"

namespace ajar {

/// Whether an area lamp is at least size (m) wide and long, and within reach (m) of p: what lies under it is lit by
/// whatever part is above it, so that points spread evenly over the lamp are mostly too far away.
bool is_wide_lamp(const Light& lamp, const Vec3& p, float size, float reach);

/// Samples an area lamp without limited spread by the solid angle under which p sees its bounds (Ureña et al. 2013).
LightSample sample_wide_lamp(const Light& lamp, const Vec3& p, const Vec2& u);

} // namespace ajar
