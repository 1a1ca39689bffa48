// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "sampling/sh.h"
#include "transport/term_table.h"

namespace ajar {

/// Light of one term at one receiver.
struct TermLight {
    uint32_t term = 0;           ///< index into TermResult::terms
    Vec3 irradiance{0.0f};       ///< W/m^2 along the shading normal; may be negative
    float sh[kShCount] = {};     ///< luminance of incident radiance, tangent frame
    float standard_error = 0.0f; ///< of the irradiance's luminance, W/m^2
};

/// Products of elements that receivers do not keep which more than kStoredTerms terms reach.
struct CrowdedOut {
    uint64_t receivers = 0;
    double light = 0.0, of = 0.0; ///< sums of luminance: of that, of all terms

    void add(const CrowdedOut& other) { receivers += other.receivers, light += other.light, of += other.of; }
    /// Share of all terms' luminance.
    double share() const { return of > 0.0 ? light / of : 0.0; }
};

/// Light of all terms but the base, as sparse rows over the receivers.
struct TermResult {
    std::vector<Term> terms;     ///< ascending
    std::vector<uint64_t> first; ///< [receivers + 1] into light; empty without elements
    std::vector<TermLight> light;
    std::vector<float> discarded; ///< per term: share of its light at receivers that do not keep it
    CrowdedOut crowded_out;
    double order_discarded = 0.0; ///< W/m^2, mean over receivers, of terms with more elements than the plan allows
};

} // namespace ajar
