// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

namespace ajar {

/// Bytes that programs can still have without swapping; 0 where the system does not tell.
uint64_t available_memory();

/// What data that grows with a scene's light may take. Safe from any thread.
class MemoryBudget {
public:
    /// gigabytes: the most; 0: what is available now. what: grows; culprit: of errors.
    MemoryBudget(float gigabytes, std::string what, std::string culprit);
    /// Counts bytes more. Throws Error(AJAR_ERROR_MEMORY) once they are too many.
    void take(uint64_t bytes);
    /// Counts from zero again.
    void reset() { taken_ = 0; }

private:
    uint64_t limit_; ///< bytes; 0: none
    std::string what_, culprit_;
    std::atomic<uint64_t> taken_{0};
};

} // namespace ajar
