// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "package/manifest.h"

namespace ajar {

/// Checksums of the two DDS files of a page (terms_format.h).
struct PageChecksums {
    uint64_t irradiance = 0, direction = 0;
};

/// terms.bin (native/runtime/terms_format.h) for content's elements and terms.
struct TermsFile {
    std::vector<uint8_t> bytes;
    TermsSummary summary;
    std::vector<uint32_t> texel_terms; ///< over all texels, if content.overlap_pictures; else empty
    std::vector<uint32_t> texel_bytes; ///< of terms.bin; what a dispatch holds for all its texels is shared evenly
};

/// Throws Error(AJAR_ERROR_ARGUMENT) for malformed terms. pages holds the checksums of each page.
TermsFile make_terms_file(const PackageContent& content, std::span<const PageChecksums> pages);

} // namespace ajar
