// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Light as a game gets it: a bake's package, opened by the run-time library.

#include <span>

#include "stage.h"

namespace hard {

/// Irradiance of a page, W/m^2, with each element at a weight; throws where the package cannot be read.
kit::Layer stored_light(const kit::Bake& bake, std::span<const float> weights, uint32_t page);

} // namespace hard
