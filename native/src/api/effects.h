// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "api/job.h"

namespace ajar {

/// Every effect that Ajar knows: simulated or skipped, why, and its share of the time. Of a trial: what its bake will
/// do. seconds: of each stage, taken or predicted.
nlohmann::json effects_json(const Job& job, const JobOutput& output,
                            const std::array<double, AJAR_STAGE_COUNT>& seconds);

} // namespace ajar
