// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "receiver/seams.h"

namespace ajar {

/// Moves texels as little as possible so that both sides of each seam show the same value:
/// minimises sum (a.x - b.x)^2 + lambda sum (x - x0)^2 by conjugate gradients, per channel.
/// value and usable cover all page texels; seam points that touch an unusable texel are skipped.
/// Returns the number of seam points used.
uint64_t stitch_seams(const std::vector<SeamPoint>& seams, const std::vector<uint8_t>& usable, std::vector<Vec3>& value);

} // namespace ajar
