// SPDX-License-Identifier: GPL-3.0-or-later
#include "sampling/alias_table.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ajar {
namespace {

/// Share of evenly spaced numbers that pick each index.
std::vector<double> shares(const AliasTable& table, size_t count) {
    constexpr uint32_t kSteps = 1u << 20;
    std::vector<double> out(count, 0.0);
    for (uint32_t i = 0; i < kSteps; ++i) out[table.pick((static_cast<float>(i) + 0.5f) / kSteps)] += 1.0 / kSteps;
    return out;
}

TEST(AliasTable, PicksInProportionToTheWeights) {
    const std::vector<float> weights{1.0f, 0.0f, 5.5f, 0.25f, 3.0f, 1e-3f, 0.0f};
    double sum = 0.0;
    for (const float w : weights) sum += w;
    const AliasTable table(weights);
    const std::vector<double> found = shares(table, weights.size());
    for (uint32_t i = 0; i < weights.size(); ++i) {
        EXPECT_NEAR(found[i], weights[i] / sum, 2e-5) << i;
        EXPECT_NEAR(table.chance(i), weights[i] / sum, 1e-6) << i;
    }
    EXPECT_EQ(found[1], 0.0);
}

TEST(AliasTable, EqualWeightsAndOneAlone) {
    for (const size_t count : {1u, 3u, 64u}) {
        const AliasTable table(std::vector<float>(count, 7.0f));
        for (const double share : shares(table, count)) EXPECT_NEAR(share, 1.0 / double(count), 2e-5) << count;
    }
}

TEST(AliasTable, EndsOfTheRangeAreIndices) {
    const AliasTable table({1e-30f, 1e30f});
    EXPECT_EQ(table.pick(0x1.fffffep-1f), 1u);
    EXPECT_LE(table.pick(0.0f), 1u);
}

TEST(AliasTable, NothingToPick) {
    EXPECT_TRUE(AliasTable().empty());
    EXPECT_TRUE(AliasTable(std::vector<float>{}).empty());
    EXPECT_TRUE(AliasTable({0.0f, 0.0f}).empty());
}

} // namespace
} // namespace ajar
