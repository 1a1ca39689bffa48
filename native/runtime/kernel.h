// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "terms_format.h"

namespace ajar::runtime {

/// RGB weight of a term, its scale included, and whether it is on at all.
struct TermWeight {
    float r, g, b;
    float on; ///< 1 or 0
};

/// Where a dispatch writes: a page, top row first.
struct Target {
    uint32_t width;
    uint32_t* irradiance;
    uint32_t* direction;
};

/// Sums base and terms of all receivers of a checked dispatch and stores them. data is the data
/// section, palette the dispatch's, weights those of all terms. A receiver whose terms are all off
/// gets the words of its base as they are.
void run_dispatch(const terms::Dispatch& dispatch, const uint32_t* data, const uint16_t* palette,
                  const TermWeight* weights, const Target& target);
/// The same for class B, which run_dispatch does not take.
void run_block_dispatch(const terms::Dispatch& dispatch, const uint32_t* data, const uint16_t* palette,
                        const TermWeight* weights, const Target& target);

} // namespace ajar::runtime
