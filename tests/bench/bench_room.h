// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene_kit.h"

namespace bench {

/// A hall of 16 x 10 x 4 m with shelves of boxes and balls, a glowing panel and lamps; about 30,000
/// triangles, always the same. Committed.
void fill_room(kit::Scene& scene, int lamps);

} // namespace bench
