// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/memory.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>

#include "base/error.h"

namespace ajar {

namespace {

constexpr double kGigabyte = 1e9;

} // namespace

uint64_t available_memory() {
    std::ifstream file("/proc/meminfo");
    uint64_t kilobytes;
    for (std::string name; file >> name; file.ignore(std::numeric_limits<std::streamsize>::max(), '\n'))
        if (name == "MemAvailable:" && file >> kilobytes) return kilobytes * 1024;
    return 0;
}

MemoryBudget::MemoryBudget(float gigabytes, std::string what, std::string culprit)
    : limit_(gigabytes > 0.0f ? static_cast<uint64_t>(std::ceil(double{gigabytes} * kGigabyte)) : available_memory()),
      what_(std::move(what)),
      culprit_(std::move(culprit)) {}

void MemoryBudget::take(uint64_t bytes) {
    if ((taken_ += bytes) <= limit_ || limit_ == 0) return;
    char size[32];
    std::snprintf(size, sizeof size, "%.2g GB", static_cast<double>(limit_) / kGigabyte);
    throw Error(AJAR_ERROR_MEMORY,
                what_ + " need more than " + size +
                    " of memory; bake fewer combinations, a higher keep threshold or fewer texels per metre",
                culprit_);
}

} // namespace ajar
