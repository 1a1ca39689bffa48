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
    EXPECT_EQ(goal.shortage, 0.0f);
}

TEST(GatherPace, NoiseGivesWayBeforeFirstRaysDo) {
    RayPlan first = kFirstRays;
    NoiseGoal goal = kGoal;
    const double all = rays_per_receiver(first, goal) * kReceivers * 1e-6;
    EXPECT_TRUE(GatherPace(pilot(), kPilot, kTiles, kReceivers).begin(0.5 * all, 1e-6, first, goal));
    EXPECT_GT(goal.shortage, 0.0f);
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
    EXPECT_GT(goal.shortage, 0.0f);
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

/// Half of the places are quiet, some much noisier than others.
std::vector<MeasuredNoise> mixed_pilot(size_t tiles) {
    std::vector<MeasuredNoise> out;
    for (size_t k = 0; k < tiles * kPilotParts; ++k) {
        const float error = k / kPilotParts % 2 == 0 ? 0.1f : 0.2f * static_cast<float>(1 + k / kPilotParts);
        out.push_back({1.0f, 0.5f * error * error, 0.5f * error * error});
    }
    return out;
}

struct Spent {
    double rays = 0.0, variance = 0.0;
};
Spent spent(const std::vector<MeasuredNoise>& pilot, const std::vector<TilePlan>& plan) {
    Spent sum;
    for (size_t i = 0; i < plan.size(); ++i) {
        const MeasuredNoise& n = pilot[i * kPilotParts];
        sum.rays += 64.0 * mean_rays(plan[i]);
        sum.variance += 32.0 * (n.gather_variance / plan[i][0].gather + n.direct_variance / plan[i][0].direct);
    }
    return sum;
}

TEST(GatherPace, ShortTimeIsSpentWhereItLowersTheMeanError) {
    constexpr size_t kTileCount = 12;
    const std::vector<MeasuredNoise> noise = mixed_pilot(kTileCount);
    const std::vector<double> receivers(kTileCount, 64.0);
    NoiseGoal goal{0.01f, 0.0f, {1u << 20, 1u << 20}, true, {}}, even = goal;
    std::vector<TilePlan> wanted = plan_tiles(noise, kPilot, goal), plan = wanted;
    const TilePace pace(noise, kPilot, receivers, goal, wanted);
    EXPECT_TRUE(pace.fit(0, spent(noise, wanted).rays / 20.0, plan));
    const Spent own = spent(noise, plan);
    EXPECT_LE(own.rays, spent(noise, wanted).rays / 20.0);
    for (even.target = goal.target; spent(noise, plan_tiles(noise, kPilot, even)).rays > own.rays;)
        even.target *= 1.01f;
    EXPECT_LT(own.variance, 0.8 * spent(noise, plan_tiles(noise, kPilot, even)).variance);
}

TEST(GatherPace, TilesThatAreDoneKeepTheirRays) {
    const std::vector<double> receivers(32, 64.0);
    const std::vector<MeasuredNoise> noise = mixed_pilot(32);
    TilePlan most;
    most.fill({1024, 1024});
    std::vector<TilePlan> wanted(32, most), plan = wanted;
    const TilePace pace(noise, kPilot, receivers, kGoal, wanted);
    EXPECT_FALSE(pace.fit(0, 1e9, plan));
    EXPECT_TRUE(pace.fit(8, 1e4, plan));
    const Rounds rounds{32};
    for (size_t i = 0; i < 32; ++i) {
        if (rounds.of(i) < 8) {
            EXPECT_EQ(plan[i][2].gather, 1024u);
        } else {
            EXPECT_LE(plan[i][2].gather, 64u);
        }
    }
    EXPECT_FALSE(pace.fit(8, 1e9, plan)); // time came back
    EXPECT_EQ(plan[31][2].gather, 1024u);
}

} // namespace
} // namespace ajar
