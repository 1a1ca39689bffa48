// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ajar_runtime.h"

namespace ajar::runtime {

/// Adds factor * patch to the map it belongs to (ajar_runtime_add_patch). Throws Error for a patch
/// outside its atlas or map and for factors that are not finite; the map is then unchanged.
void add_patch(const ajar_runtime_patch& patch, const uint16_t* atlas, uint32_t atlas_width, uint32_t atlas_height,
               const float factor[3], float* light, uint32_t width, uint32_t height);

} // namespace ajar::runtime
