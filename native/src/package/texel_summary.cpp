// SPDX-License-Identifier: GPL-3.0-or-later
#include "package/texel_summary.h"

#include <nlohmann/json.hpp>

namespace ajar {

nlohmann::ordered_json overlap_json(const TexelSummary& summary) {
    nlohmann::ordered_json histogram = nlohmann::ordered_json::array();
    for (uint32_t bin = 0; summary.most_terms > 0 && bin <= std::bit_width(summary.most_terms - 1); ++bin)
        histogram.push_back({{"up_to", 1u << bin}, {"texels", summary.histogram[bin]}});
    return {{"max", summary.most_terms},
            {"mean", summary.mean(static_cast<double>(summary.terms))},
            {"histogram", histogram}};
}

} // namespace ajar
