// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pass/cut_light.h"
#include "sampling/sh.h"

namespace ajar {

/// Light of one term at one receiver.
struct TermLight {
    uint32_t term = 0;           ///< index into TermResult::terms
    Vec3 irradiance{0.0f};       ///< W/m^2 along the shading normal; may be negative
    float sh[kShCount] = {};     ///< luminance of incident radiance, tangent frame
    float standard_error = 0.0f; ///< of the irradiance's luminance, W/m^2
};

/// Light of all terms but the base, as sparse rows over the receivers.
struct TermResult {
    std::vector<Term> terms;     ///< ascending
    std::vector<uint64_t> first; ///< [receivers + 1] into light; empty without elements
    std::vector<TermLight> light;
    std::vector<float> discarded; ///< per term: share of its light at receivers that do not keep it
    double all_discarded = 0.0;   ///< the same of all terms together
    CutLight cut;
};

} // namespace ajar
