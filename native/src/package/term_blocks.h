// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "package/term_lists.h"
#include "runtime/terms_format.h"

namespace ajar {

/// The lists of a dispatch's receivers as class B stores them (terms_format.h).
struct TermBlocks {
    std::vector<terms::BlockStart> starts; ///< one more than there are blocks
    std::vector<uint32_t> slots;
    std::vector<uint32_t> entries; ///< of the lists, in the order in which they are stored
};

/// texels: the receivers in their order. palette: terms, ascending, with all of theirs.
TermBlocks make_blocks(const TermLists& lists, std::span<const uint32_t> texels, std::span<const uint16_t> palette);

} // namespace ajar
