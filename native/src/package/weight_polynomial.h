// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Light as a polynomial in the elements' weights. A bake expands it in their distances from the start, so that what it
// leaves out is 0 there; callers that sum terms, and layouts that hold one object at a time, want the weights
// themselves. Both are the same polynomial: a variable is linear in its weight, x = x(0) + (x(1) - x(0)) w.

#include <span>

#include "package/manifest.h"

namespace ajar {

/// A product of weights and the baked light that it multiplies.
struct WeightTerm {
    static constexpr uint32_t kBase = 0xffffffffu;
    struct Part {
        uint32_t term; ///< index of a baked term, or kBase: what the pages hold
        float factor;
    };
    std::vector<uint32_t> elements; ///< ascending; none: light with all weights at 0
    std::vector<Part> parts;
};

/// The polynomial in weights of base and terms; products: the elements of each term, ascending. The product of none
/// comes first, and is always there.
std::vector<WeightTerm> in_weights(std::span<const PackageElement> elements,
                                   const std::vector<std::vector<uint32_t>>& products);

} // namespace ajar
