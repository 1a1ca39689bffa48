// SPDX-License-Identifier: GPL-3.0-or-later
// Random calls with a fixed seed: whatever the arguments, a known code comes back and nothing
// crashes. What the calls are is in tests/fuzz, where libFuzzer makes them too.
#include <gtest/gtest.h>

#include "../fuzz/engine_fuzz.h"
#include "../fuzz/memory_folder.h"

namespace {

TEST(Fuzz, RandomCallsGiveCodes) {
    constexpr uint32_t kSeeds = 40, kCalls = 500;
    const MemoryFolder folder;
    for (uint32_t seed = 1; seed <= kSeeds; ++seed) {
        SCOPED_TRACE(seed);
        ByteSource bytes(seed);
        EngineFuzz fuzz(bytes, folder.path());
        for (uint32_t i = 0; i < kCalls; ++i) ASSERT_EQ(fuzz.step(), "");
    }
}

} // namespace
