// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "api/job.h"

namespace ajar {

using MemoryParts = std::vector<std::pair<const char*, uint64_t>>;
/// Bytes that each part of a finished bake still holds, by name; what a scene does not call for has 0.
MemoryParts memory_parts(const Snapshot& scene, const JobOutput& output);
/// The same before a bake, from the output of its trial.
MemoryParts predicted_memory_parts(const Snapshot& scene, const JobOutput& trial, const ajar_settings& settings);

} // namespace ajar
