// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <utility>

#include "scene/snapshot.h"

namespace ajar {

/// Column and row of a texel, which has this number over all pages, on its page.
inline std::pair<int, int> place_of(const Page& page, uint64_t texel) {
    const auto local = static_cast<uint32_t>(texel - page.first_texel);
    return {local % page.width, local / page.width};
}

/// Those of edge * edge texels from column x and row y on that a page has.
struct TexelSquare {
    uint32_t x0, y0, x1, y1;

    TexelSquare(const Page& page, int x, int y, int edge)
        : x0(static_cast<uint32_t>(std::max(x, 0))),
          y0(static_cast<uint32_t>(std::max(y, 0))),
          x1(std::min(static_cast<uint32_t>(x + edge), page.width)),
          y1(std::min(static_cast<uint32_t>(y + edge), page.height)) {}

    /// visit(number over all pages), row by row.
    template <class Visit>
    void each(const Page& page, const Visit& visit) const {
        for (uint32_t y = y0; y < y1; ++y)
            for (uint32_t x = x0; x < x1; ++x) visit(page.first_texel + y * page.width + x);
    }
};

} // namespace ajar
