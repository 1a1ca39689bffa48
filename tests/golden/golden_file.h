// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Golden data as a text file: one line per region, so that changes can be read.

#include <string>
#include <vector>

#include "golden_measure.h"

namespace golden {

/// Bakes that a test averages, to see smaller changes; golden noise comes from groups of as many.
constexpr uint32_t kGroup = 16;
constexpr double kLeastNoise = 1e-12; ///< variance that counts as none

struct GoldenData {
    uint32_t fine_bakes = 0, tested_bakes = 0; ///< behind the means, and behind the noise
    /// Mean and variance of chi_square over the tested bakes: blocks share bounced light, so their
    /// deviations are no independent numbers.
    double chi_mean = 0.0, chi_variance = 0.0;
    std::vector<RegionLight> regions;
};

/// Joins the means of fine bakes with the noise of tested ones, all of them and in groups of kGroup: a
/// texel's noise is the geometric mean over groups. Throws std::runtime_error if they have different
/// regions.
GoldenData join(const Measurement& fine, const Measurement& tested, const std::vector<Measurement>& groups);

void write_golden(const GoldenData& data, const std::string& path);
/// Throws std::runtime_error if the file is missing or broken.
GoldenData read_golden(const std::string& path);

} // namespace golden
