// SPDX-License-Identifier: GPL-3.0-or-later
// The entry that libFuzzer calls; the test beside it runs the same without it.
#include "package_fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static const PackageFuzz fuzz(AJAR_FUZZ_SEED);
    fuzz.run(data, size);
    return 0;
}
