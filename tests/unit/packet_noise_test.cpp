// SPDX-License-Identifier: GPL-3.0-or-later
// Which packets of a tile get further rays where few met the light.
#include "pass/packet_noise.h"

#include <gtest/gtest.h>

namespace ajar {
namespace {

constexpr uint32_t kRays = 64, kCount = 64; ///< per receiver; receivers

/// A tile under even light of 1 W/m^2, and one ray of receiver 13 that met light of so many more.
TileEstimate tile_with(float hit) {
    TileEstimate t{make_sums(false), make_sums(false), {kRays, 0}};
    for (uint32_t lane = 0; lane < kCount; ++lane) {
        t.gather->cosine_sum[lane] = kPi * kRays;
        const float e = 1.0f + (lane == 13 ? hit : 0.0f);
        for (auto& channel : t.gather->irradiance) channel[lane] = e * kRays;
        const double ray = double(hit) * kRays;
        t.gather->pairs[lane] = lane == 13 ? ray * ray : 1e-6;
    }
    return t;
}

NoiseGoal goal_of(float target) {
    NoiseGoal goal;
    goal.target = target;
    return goal;
}

TEST(PacketNoise, MuchRareLightIsThatOfAllPackets) {
    const TileEstimate t = tile_with(10.0f);
    const std::vector<MeasuredNoise> noise = packet_noise(t, kCount, goal_of(0.05f));
    ASSERT_EQ(noise.size(), kCount / kLanes);
    for (const MeasuredNoise& n : noise) {
        EXPECT_NEAR(n.level, 1.0f + 10.0f / kCount, 1e-4f);
        EXPECT_NEAR(n.gather_variance, 100.0f / kCount, 1e-4f);
    }
}

TEST(PacketNoise, LittleRareLightStaysWithThePacketsThatMetIt) {
    // 10 / 64 W/m^2 are less than a fifth of the level.
    const std::vector<MeasuredNoise> noise = packet_noise(tile_with(10.0f), kCount, goal_of(0.2f));
    EXPECT_NEAR(noise[1].gather_variance, 100.0f / kLanes, 1e-3f);
    EXPECT_NEAR(noise[0].gather_variance, 100.0f / kCount * 2.0f, 1e-3f) << "four packets speak for each of them";
    EXPECT_LT(noise[7].gather_variance, 1e-6f);
}

TEST(PacketNoise, ATileThatMetNoneHasTheScenes) {
    NoiseGoal goal = goal_of(0.05f);
    goal.rare = {0.5f, 0.25f};
    for (const MeasuredNoise& n : packet_noise(tile_with(0.0f), kCount, goal)) {
        EXPECT_NEAR(n.level, 1.5f, 1e-4f);
        EXPECT_NEAR(n.gather_variance, 0.25f, 1e-4f);
    }
    goal.rare.level = 0.04f;
    EXPECT_LT(packet_noise(tile_with(0.0f), kCount, goal)[0].gather_variance, 1e-6f) << "less than the noise aimed at";
}

TEST(PacketNoise, RareLightIsWhatOneReceiverHasMoreThanTheNext) {
    TileEstimate t = tile_with(10.0f);
    EXPECT_NEAR(rare_light(t, 8, 16).variance, 100.0f / kLanes, 1e-3f);
    EXPECT_NEAR(rare_light(t, 8, 16).level, 10.0f / kLanes, 1e-4f);
    EXPECT_EQ(rare_light(t, 0, 8).level, 0.0f);
    t.gather->pairs[14] = t.gather->pairs[13] * 0.5;
    EXPECT_EQ(rare_light(t, 8, 16).variance, 0.0f) << "two of eight are no chance";
    EXPECT_EQ(rare_light(t, 13, 14).variance, 0.0f) << "nothing to compare with";
}

} // namespace
} // namespace ajar
