// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "package/manifest.h"

namespace ajar {

/// A term as terms.bin stores it. Scale is the power of two that brings its brightest channel into
/// [2^14, 2^15), so that any intensity uses the packed formats' full range.
struct StoredTerm {
    bool is_signed = false;
    float scale = 1.0f;
    uint32_t texels = 0; ///< that keep it
};

/// The power of two that brings the largest magnitude into [2^14, 2^15); 1 for 0.
float storage_scale(float largest);

/// The terms of every texel: an entry names a term and its place in the term's arrays. Entries of a
/// texel ascend by term.
struct TermLists {
    std::vector<StoredTerm> terms;
    std::vector<uint32_t> first; ///< [texels + 1] first entry of each texel
    std::vector<uint16_t> term;
    std::vector<uint32_t> source;
    uint32_t count(uint32_t texel) const { return first[texel + 1] - first[texel]; }
};

/// Payload words of one entry: {irradiance, direction, 0} in the unsigned layout, {r | g << 16, b,
/// direction} in the signed one. Irradiance is divided by the term's scale.
std::array<uint32_t, 3> entry_words(const PackageTerm& term, const StoredTerm& stored, size_t index,
                                    bool signed_layout);

/// Throws Error(AJAR_ERROR_ARGUMENT) for elements, pages and terms that are malformed.
void check_content(const PackageContent& content);

/// Gathers what each texel keeps. Entries that are black once packed are left out. Throws Error(AJAR_ERROR_ARGUMENT)
/// for terms that are malformed.
TermLists collect_terms(const PackageContent& content);

} // namespace ajar
