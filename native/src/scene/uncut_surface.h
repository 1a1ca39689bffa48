// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/material.h"

namespace ajar {

/// Material::sample with reflectance up to 1, as the material says, where that stops at kMaxReflectance.
SurfaceSample sample_uncut(const Material& material, const Snapshot& scene, const MeshPoint& at);

} // namespace ajar
