// SPDX-License-Identifier: GPL-3.0-or-later
// The entry that libFuzzer calls; tests/abi/fuzz_test.cpp makes calls of the same kind without it.
#include <tbb/global_control.h>

#include <cstdio>
#include <cstdlib>

#include "engine_fuzz.h"
#include "memory_folder.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    // Threads would make coverage a matter of chance.
    static const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    static const MemoryFolder folder;
    ByteSource bytes(data, size);
    EngineFuzz fuzz(bytes, folder.path());
    for (int call = 0; call < 64 && !bytes.ended(); ++call) {
        const std::string broken = fuzz.step();
        if (broken.empty()) continue;
        std::fprintf(stderr, "call %d gave %s\n", call, broken.c_str());
        std::abort();
    }
    return 0;
}
