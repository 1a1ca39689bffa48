// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "api/self_check.h"

namespace ajar {

/// What the check found, for the manifest: the worst state in front, then all of them, or why there is none.
nlohmann::json check_json(const SelfCheck& check);

/// The same with the light from bounce to bounce and the time it took, for the report.
nlohmann::json check_report_json(const SelfCheck& check);

} // namespace ajar
