// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "pass/cut_light.h"
#include "scene/snapshot.h"

namespace ajar {

/// Light that stays as it is at the start because too many doors and toggles change it at once, as the report has it
/// ("cut" in schemas/report.schema.json).
nlohmann::ordered_json cut_json(const Snapshot& scene, const CutLight& cut);

/// Names the doors and toggles that a fair share of the light does not follow; none where little is cut.
std::vector<Warning> cut_warnings(const Snapshot& scene, const CutLight& cut, uint32_t combinations);

} // namespace ajar
