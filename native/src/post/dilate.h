// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "scene/snapshot.h"

namespace ajar {

/// For every texel of all pages the texel it takes its value from: itself where known is not 0,
/// else the nearest known one of its page within radius, else itself. Whole texels are copied,
/// never mixed, so packed data stays decodable (algorithms.md 1.6, 9.9).
std::vector<uint32_t> nearest_known(const std::vector<Page>& pages, const std::vector<uint8_t>& known, uint32_t radius);

} // namespace ajar
