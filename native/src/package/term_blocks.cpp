// SPDX-License-Identifier: GPL-3.0-or-later
#include "package/term_blocks.h"

#include <algorithm>
#include <tuple>

namespace ajar {
namespace {

/// A term of a receiver of a block.
struct BlockEntry {
    uint16_t term;
    uint32_t lane, entry;

    bool operator<(const BlockEntry& other) const { return std::tie(term, lane) < std::tie(other.term, other.lane); }
};

void add_block(const TermLists& lists, std::span<const uint32_t> texels, std::span<const uint16_t> palette,
               std::vector<BlockEntry>& scratch, TermBlocks& out) {
    scratch.clear();
    for (uint32_t lane = 0; lane < texels.size(); ++lane)
        for (uint32_t e = lists.first[texels[lane]]; e < lists.first[texels[lane] + 1]; ++e)
            scratch.push_back({lists.term[e], lane, e});
    std::sort(scratch.begin(), scratch.end());
    auto place = palette.begin();
    for (size_t i = 0; i < scratch.size();) {
        const uint16_t term = scratch[i].term;
        uint32_t mask = 0;
        for (; i < scratch.size() && scratch[i].term == term; ++i) {
            mask |= 1u << scratch[i].lane;
            out.entries.push_back(scratch[i].entry);
        }
        place = std::lower_bound(place, palette.end(), term);
        out.slots.push_back(terms::make_slot(static_cast<uint32_t>(place - palette.begin()), mask));
    }
}

} // namespace

TermBlocks make_blocks(const TermLists& lists, std::span<const uint32_t> texels, std::span<const uint16_t> palette) {
    TermBlocks out;
    std::vector<BlockEntry> scratch;
    const auto mark = [&] {
        out.starts.push_back({static_cast<uint32_t>(out.slots.size()), static_cast<uint32_t>(out.entries.size())});
    };
    for (size_t first = 0; first < texels.size(); first += terms::kBlock) {
        mark();
        add_block(lists, texels.subspan(first, std::min<size_t>(terms::kBlock, texels.size() - first)), palette,
                  scratch, out);
    }
    mark();
    return out;
}

} // namespace ajar
