// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "package/term_lists.h"
#include "runtime/terms_format.h"

namespace ajar {

/// Receivers that are updated together (terms_format.h), still as texels over all pages.
struct PlannedDispatch {
    terms::Class kind = terms::Class::u;
    uint32_t k = 0; ///< terms of each receiver, the most of any in classes V8, V16 and B
    bool is_signed = false;
    uint32_t page = 0;
    std::vector<uint16_t> palette; ///< ascending
    std::vector<uint32_t> texels;  ///< in Morton order
};

/// Groups the texels that have terms. A list of 1 to 8 terms that more than kUniqueReceivers texels
/// of a page share gets dispatches of its own (class U); rarer lists are put together so that a
/// change of one element updates few receivers in vain. Texels with more than 16 terms share
/// dispatches with their neighbours (class B). The same content gives the same plan.
std::vector<PlannedDispatch> plan_dispatches(const std::vector<PackagePage>& pages, const TermLists& lists);

inline constexpr uint32_t kUniqueReceivers = 128;
inline constexpr uint32_t kSharedReceivers = 4096; ///< most receivers of a dispatch of classes Q, V8, V16 and B

/// Page and place on it of a texel counted over all pages, bottom row first.
struct TexelPlace {
    uint32_t page, x, y;
};
TexelPlace place_of(const std::vector<PackagePage>& pages, uint32_t texel);

} // namespace ajar
