// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "receiver/chart_pack.h"

namespace ajar {

/// Something to place. Items of one group (the charts of one object) share a page.
struct PackItem {
    const Footprint* shape = nullptr;  ///< owned by the caller
    const Footprint* turned = nullptr; ///< null if the item may not turn
    uint32_t group = 0;
};

struct ItemPlace {
    uint32_t page = 0;
    Placement at;
};

struct PageSize {
    uint32_t width = 0, height = 0;
};

struct PagePlan {
    std::vector<PageSize> pages;  ///< edges are multiples of 4
    std::vector<ItemPlace> items; ///< as many as the items given
    std::vector<uint32_t> failed; ///< groups too large for an empty page; not placed
};

/// Packs all groups into as few pages of at most max_edge texels as it can; the last page is
/// shrunk to what it holds. The result depends on nothing but the arguments.
PagePlan plan_pages(const std::vector<PackItem>& items, uint32_t group_count, uint32_t max_edge, uint32_t padding);

} // namespace ajar
