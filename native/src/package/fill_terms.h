// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "package/baked_pages.h"

namespace ajar {

/// Gives each texel the terms of its source, as the pages' own texels get their source's light.
/// source[i] is the texel that texel i copies, or i. Terms stay sorted by texel.
void fill_terms(const std::vector<uint32_t>& source, std::vector<BakedTerm>& terms);

} // namespace ajar
