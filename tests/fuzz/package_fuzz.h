// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "memory_folder.h"

/// Opens packages whose terms.bin is what a fuzzer made up, plays with their weights, reads their pages.
class PackageFuzz {
public:
    /// seed: folder with a valid small package. It is copied to memory where the system offers that.
    explicit PackageFuzz(const std::string& seed);

    /// One run. File size and checksum are put right first, or nothing but them would be tested. True if the
    /// package opened.
    bool run(const uint8_t* data, size_t size) const;

private:
    MemoryFolder folder_;
};
