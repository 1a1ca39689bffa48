// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>

namespace ajar {

/// Texels that have terms, by how many they have (their overlap) and what they take in terms.bin.
struct TexelSummary {
    static constexpr uint32_t kBins = 17; ///< 65536 terms, the most of a package, are in the last

    uint64_t texels = 0, terms = 0;
    uint64_t histogram[kBins] = {}; ///< bin i: texels with more than 2^(i - 1) and at most 2^i terms
    uint32_t most_terms = 0;
    double bytes = 0.0, most_bytes = 0.0;

    /// A texel with at least one term.
    void add(uint32_t terms_there, double bytes_there) {
        ++texels;
        ++histogram[std::bit_width(terms_there - 1)];
        terms += terms_there;
        bytes += bytes_there;
        most_terms = std::max(most_terms, terms_there);
        most_bytes = std::max(most_bytes, bytes_there);
    }
    double mean(double sum) const { return texels > 0 ? sum / static_cast<double>(texels) : 0.0; }
};

/// Highest and mean overlap and its histogram, as manifest and report state them.
nlohmann::ordered_json overlap_json(const TexelSummary& summary);

} // namespace ajar
