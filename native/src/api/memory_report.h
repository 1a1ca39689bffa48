// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "api/job.h"

namespace ajar {

/// Bytes that each part of a finished bake still holds, by name; what a scene does not call for has 0.
std::vector<std::pair<const char*, uint64_t>> memory_parts(const Snapshot& scene, const JobOutput& output);

} // namespace ajar
