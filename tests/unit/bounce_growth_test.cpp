// SPDX-License-Identifier: GPL-3.0-or-later
// How much light grows from bounce to bounce, and how sure that is.
#include "pass/bounce_growth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace ajar {
namespace {

TEST(BounceGrowth, StatesTheErrorOfItsRatio) {
    // 400 receivers of mean 1 whose next bounce is 0.9 of it with an independent error of 0.5.
    std::mt19937 random(1);
    std::normal_distribution<float> noise(0.0f, 0.5f);
    std::uniform_real_distribution<float> level(0.5f, 1.5f);
    double squares = 0.0, stated = 0.0;
    constexpr int kTrials = 400;
    for (int trial = 0; trial < kTrials; ++trial) {
        std::vector<float> before(400), after(400);
        for (size_t i = 0; i < before.size(); ++i) after[i] = 0.9f * (before[i] = level(random)) + noise(random);
        const BounceGain g = ratio_of_sums(before, after);
        squares += (g.gain - 0.9) * (g.gain - 0.9) / kTrials, stated += g.error / kTrials;
    }
    // A standard deviation of 400 trials is known to 3.5 %.
    EXPECT_NEAR(std::sqrt(squares) / stated, 1.0, 4.0 * 0.035);
    EXPECT_NEAR(stated, 0.5 / 20.0, 0.002);
}

TEST(BounceGrowth, WeighsReceiversByAreaAndLeavesOutTheRing) {
    LightmapReceivers receivers;
    receivers.texel = {0, 1, 2};
    receivers.texel_size = {2.0f, 1.0f, 1.0f};
    receivers.ring = {0, 0, 1};
    BounceGrowth growth;
    const float light[3][3] = {{1, 0, 7}, {0.2f, 2.4f, 9}, {0, 0, 0}};
    for (const auto& bounce : light) growth.add(receivers, [&](uint32_t r) { return bounce[r]; });
    ASSERT_EQ(growth.steps.size(), 2u);
    EXPECT_NEAR(growth.steps[0].gain, (4 * 0.2 + 2.4) / 4.0, 1e-6);
    EXPECT_EQ(growth.steps[1].gain, 0.0);
    growth.add(receivers, [](uint32_t) { return 1.0f; });
    EXPECT_EQ(growth.steps[2].gain, 0.0) << "nothing to compare with";
}

} // namespace
} // namespace ajar
