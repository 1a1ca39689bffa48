// SPDX-License-Identifier: GPL-3.0-or-later
#include "package/weight_polynomial.h"

#include <map>

namespace ajar {

std::vector<WeightTerm> in_weights(std::span<const PackageElement> elements,
                                   const std::vector<std::vector<uint32_t>>& products) {
    std::map<std::vector<uint32_t>, std::vector<WeightTerm::Part>> found;
    found[{}].push_back({WeightTerm::kBase, 1.0f});
    for (uint32_t t = 0; t < products.size(); ++t) {
        std::vector<std::pair<std::vector<uint32_t>, float>> factors{{{}, 1.0f}};
        for (const uint32_t e : products[t]) {
            const float at_zero = elements[e].variable(0.0f), slope = elements[e].variable(1.0f) - at_zero;
            const size_t count = factors.size();
            for (size_t i = 0; i < count; ++i) {
                auto with = factors[i];
                with.first.push_back(e), with.second *= slope;
                factors[i].second *= at_zero;
                factors.push_back(std::move(with));
            }
            std::erase_if(factors, [](const auto& f) { return f.second == 0.0f; });
        }
        for (auto& [product, factor] : factors) found[product].push_back({t, factor});
    }
    std::vector<WeightTerm> out;
    for (auto& [product, parts] : found) out.push_back({product, std::move(parts)});
    return out;
}

} // namespace ajar
