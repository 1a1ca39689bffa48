// SPDX-License-Identifier: GPL-3.0-or-later
// The fuzzer's target under fixed mutations of the seed, for machines without libFuzzer.
#include "package_fuzz.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

namespace {

constexpr int kRuns = 20000;

std::vector<uint8_t> seed() {
    std::ifstream file(std::string(AJAR_FUZZ_SEED) + "/terms.bin", std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// One to four changes: a bit, a byte, a 32 bit number that is small, huge or a little off, a cut, a copied piece.
std::vector<uint8_t> mutate(std::vector<uint8_t> bytes, std::mt19937& random) {
    const auto below = [&](size_t n) { return std::uniform_int_distribution<size_t>(0, n - 1)(random); };
    for (size_t change = 0; change < 1 + below(4); ++change) {
        const size_t at = below(bytes.size() - 4);
        switch (below(6)) {
            case 0:
                bytes[at] ^= static_cast<uint8_t>(1u << below(8));
                break;
            case 1:
                bytes[at] = static_cast<uint8_t>(below(256));
                break;
            case 2: {
                const uint32_t values[] = {0u, 1u, 0x7fffffffu, 0x80000000u, 0xffffffffu, 0x10000u};
                std::memcpy(&bytes[at & ~size_t{3}], &values[below(6)], 4);
                break;
            }
            case 3: {
                uint32_t v;
                std::memcpy(&v, &bytes[at & ~size_t{3}], 4);
                v += static_cast<uint32_t>(below(9)) - 4u;
                std::memcpy(&bytes[at & ~size_t{3}], &v, 4);
                break;
            }
            case 4:
                bytes.resize(std::max<size_t>(bytes.size() - below(64), 16));
                break;
            default: {
                const size_t from = below(bytes.size() - 4),
                             count = std::min(below(64), bytes.size() - std::max(from, at));
                std::memmove(&bytes[at], &bytes[from], count);
            }
        }
    }
    return bytes;
}

TEST(PackageFuzz, NoMutationOfASmallPackageGetsThrough) {
    const PackageFuzz fuzz(AJAR_FUZZ_SEED);
    const std::vector<uint8_t> good = seed();
    ASSERT_TRUE(fuzz.run(good.data(), good.size()));
    std::mt19937 random(1);
    int opened = 0;
    for (int i = 0; i < kRuns; ++i) {
        const std::vector<uint8_t> bytes = mutate(good, random);
        opened += fuzz.run(bytes.data(), bytes.size()) ? 1 : 0;
    }
    // Changed light is still light; changed tables are refused. Both must happen, or little is tested.
    EXPECT_GT(opened, kRuns / 50);
    EXPECT_LT(opened, kRuns - kRuns / 50);
}

} // namespace
