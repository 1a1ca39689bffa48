// SPDX-License-Identifier: GPL-3.0-or-later
// A gather against the clock.
#include "pass/gather_pace.h"

#include <gtest/gtest.h>

namespace ajar {
namespace {

constexpr NoiseGoal kGoal = {0.05f, 0.0f, {1024, 1024}, true, {}};
constexpr RayPlan kPilot = {32, 32};
constexpr uint32_t kReceivers = 25600;
const std::vector<Tile> kTiles = {{0, 256}};

/// Relative standard error of 30% with the pilot's rays.
std::vector<MeasuredNoise> pilot() { return std::vector<MeasuredNoise>(kPilotParts, {1.0f, 0.045f, 0.045f}); }

double rays_per_receiver(const RayPlan& first, const NoiseGoal& goal) {
    return predict_rays(pilot(), kPilot, kTiles, first, goal) / 256.0;
}

TEST(GatherPace, NothingChangesWhileTimeSuffices) {
    GatherPace pace(pilot(), kPilot, kTiles, kReceivers);
    RayPlan first = kFirstRays;
    NoiseGoal goal = kGoal;
    const double seconds = rays_per_receiver(first, goal) * kReceivers * 1e-6;
    EXPECT_FALSE(pace.begin(1.1 * seconds, 1e-6, first, goal));
    EXPECT_FALSE(pace.follow(kReceivers / 4, 0.25 * seconds, 0.85 * seconds, first, goal));
    EXPECT_EQ(goal.target, kGoal.target);
}

TEST(GatherPace, NoiseGivesWayBeforeFirstRaysDo) {
    RayPlan first = kFirstRays;
    NoiseGoal goal = kGoal;
    const double all = rays_per_receiver(first, goal) * kReceivers * 1e-6;
    EXPECT_TRUE(GatherPace(pilot(), kPilot, kTiles, kReceivers).begin(0.5 * all, 1e-6, first, goal));
    EXPECT_GT(goal.target, kGoal.target);
    EXPECT_EQ(first.gather, kFirstRays.gather);
    EXPECT_LE(rays_per_receiver(first, goal) * kReceivers * 1e-6, 0.5 * all);
    goal = kGoal;
    EXPECT_TRUE(GatherPace(pilot(), kPilot, kTiles, kReceivers).begin(kReceivers * 40e-6, 1e-6, first, goal));
    EXPECT_LE(first.gather + first.direct, 40u);
    goal = kGoal;
    EXPECT_TRUE(GatherPace(pilot(), kPilot, kTiles, kReceivers).begin(0.0, 1e-6, first, goal));
    EXPECT_EQ(first.gather, 8u); // no fewer than the fewest
}

TEST(GatherPace, FixedCountsBecomeTheBestThatTimeAllows) {
    GatherPace pace(pilot(), kPilot, kTiles, kReceivers);
    RayPlan first = kGoal.most;
    NoiseGoal goal = kGoal;
    goal.target = 0.0f;
    EXPECT_TRUE(pace.begin(kReceivers * 500e-6, 1e-6, first, goal));
    EXPECT_EQ(first.gather, kFirstRays.gather);
    EXPECT_GT(goal.target, 0.0f);
    EXPECT_LE(rays_per_receiver(first, goal), 500.0);
}

TEST(GatherPace, AGatherSlowerThanThePilotEndsInTime) {
    for (const double slowness : {0.6, 1.0, 1.8}) {
        GatherPace pace(pilot(), kPilot, kTiles, kReceivers);
        RayPlan first = kFirstRays;
        NoiseGoal goal = kGoal;
        const double limit = 0.6 * rays_per_receiver(first, goal) * kReceivers * 1e-6;
        pace.begin(limit, 1e-6, first, goal);
        double now = 0.0;
        for (int round = 0; round < 16; ++round) {
            const double taken = slowness * 1e-6 * rays_per_receiver(first, goal) * (kReceivers / 16.0);
            now += taken;
            pace.follow(kReceivers / 16, taken, limit - now, first, goal);
        }
        EXPECT_LT(now, limit) << slowness;
        EXPECT_GT(now, 0.75 * limit) << slowness; // ray counts are rounded
    }
}

} // namespace
} // namespace ajar
