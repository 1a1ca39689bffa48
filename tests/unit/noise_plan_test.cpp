// SPDX-License-Identifier: GPL-3.0-or-later
// How many rays a noise target or a time limit buys.
#include "pass/noise_plan.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ajar {
namespace {

constexpr RayPlan kFirst = {64, 64};
constexpr NoiseGoal kGoal = {0.05f, 0.0f, {1024, 1024}, true, {}};

/// Noise of light 1 whose relative standard error is error, the given part of its variance from gather rays.
MeasuredNoise noise(float error, float gather_part = 0.5f) {
    return {1.0f, error * error * gather_part, error * error * (1.0f - gather_part)};
}

TEST(NoisePlan, QuietLightNeedsNothing) {
    const RayPlan more = missing_rays(noise(0.049f), kFirst, kGoal);
    EXPECT_EQ(more.gather, 0u);
    EXPECT_EQ(more.direct, 0u);
}

TEST(NoisePlan, BothAnswersTogetherReachTheTarget) {
    for (const float error : {0.06f, 0.1f, 0.15f})
        for (const float part : {0.1f, 0.5f, 0.9f}) {
            const MeasuredNoise n = noise(error, part);
            const RayPlan more = missing_rays(n, kFirst, kGoal);
            const double second = n.gather_variance * 64.0 / more.gather + n.direct_variance * 64.0 / more.direct,
                         share = share_of_more(n, kFirst, more, kGoal),
                         both = share * share * second + (1.0 - share) * (1.0 - share) * error * error;
            EXPECT_LE(std::sqrt(both), 0.05 * 1.0001) << error << " " << part;
            EXPECT_GE(std::sqrt(both), 0.03) << error << " " << part; // counts are rounded up
            EXPECT_EQ(more.gather > more.direct, part > 0.5f);
        }
}

TEST(NoisePlan, DarkLightMayBeNoisy) {
    NoiseGoal goal = kGoal;
    goal.dark = 10.0f;
    EXPECT_EQ(missing_rays(noise(0.4f), kFirst, goal).gather, 0u);
}

TEST(NoisePlan, CountsStayUnderTheCapAndFillStrata) {
    for (const float error : {0.06f, 0.2f, 1.0f, 100.0f}) {
        const RayPlan more = missing_rays(noise(error), kFirst, kGoal);
        EXPECT_LE(kFirst.gather + more.gather, kGoal.most.gather);
        EXPECT_LE(kFirst.direct + more.direct, kGoal.most.direct);
        EXPECT_TRUE(more.gather % 256 == 0 || (more.gather < 256 && (more.gather & (more.gather - 1)) == 0));
    }
}

TEST(NoisePlan, NothingIsAddedToWhatTheCapAllows) {
    NoiseGoal goal = kGoal;
    goal.most = kFirst;
    EXPECT_EQ(missing_rays(noise(1.0f), kFirst, goal).gather, 0u);
}

TEST(NoisePlan, PartsOfTilesGetWhatTheyNeed) {
    NoiseGoal goal = kGoal;
    std::vector<MeasuredNoise> pilot(3 * kPilotParts, noise(0.01f));
    for (uint32_t k = 0; k < kPilotParts; ++k) pilot[kPilotParts + k] = noise(0.2f);
    pilot[2 * kPilotParts] = noise(0.8f);
    const std::vector<TilePlan> plan = plan_tiles(pilot, {32, 32}, goal);
    EXPECT_EQ(plan[0][0].gather, 64u);
    EXPECT_EQ(plan[0][0].direct, 16u);
    EXPECT_EQ(plan[1][3].gather, 512u); // a variance of 16 times the budget with 32 rays
    EXPECT_EQ(plan[2][0].gather, 1024u);
    EXPECT_EQ(plan[2][1].gather, 1024u); // half of its variance is the tile's
    EXPECT_EQ(mean_rays(plan[1]), 1024.0);
    EXPECT_EQ(ring_rays(plan[1]).gather, 128u);
    goal.model.gather_calibration = goal.model.direct_calibration = 0.25f;
    EXPECT_EQ(plan_tiles(pilot, {32, 32}, goal)[1][0].gather, 128u);
}

TEST(NoisePlan, TheRingKeepsSomeOfFewRays) {
    for (uint32_t rays = 1; rays < 40; ++rays) {
        TilePlan plan;
        plan.fill({rays, rays});
        const RayPlan ring = ring_rays(plan);
        EXPECT_GE(ring.direct, 1u) << rays;
        EXPECT_LE(ring.direct, rays);
        EXPECT_EQ(ring.gather & (ring.gather - 1), 0u) << "strata fill powers of two";
    }
    EXPECT_EQ(ring_rays(RayPlan{}).gather, 0u);
}

TEST(NoisePlan, PartsOfATileAreWholePacketsAndMissNone) {
    for (const uint32_t count : {0u, 1u, 8u, 9u, 17u, 100u, 256u}) {
        EXPECT_EQ(part_begin(count, 0), 0u);
        EXPECT_EQ(part_begin(count, kPilotParts), count);
        for (uint32_t k = 0; k < kPilotParts; ++k) {
            EXPECT_LE(part_begin(count, k), part_begin(count, k + 1));
            EXPECT_TRUE(part_begin(count, k) == count || part_begin(count, k) % 8 == 0);
            const Tile pilot = pilot_part({40, count}, k);
            EXPECT_LE(pilot.first + pilot.count, 40 + count);
            EXPECT_GE(pilot.count, std::min(count, 1u));
        }
        for (uint32_t local = 0; local < count; ++local) {
            EXPECT_LE(part_begin(count, part_of(count, local)), local);
            EXPECT_GT(part_begin(count, part_of(count, local) + 1), local);
        }
    }
}

TEST(NoisePlan, TheModelLearnsHowNoiseFalls) {
    std::vector<NoiseTrial> trials;
    for (int i = 0; i < 20; ++i) {
        NoiseTrial t{noise(0.4f), noise(0.4f), {}, {}};
        t.many.gather_variance *= std::pow(8.0f, -1.3f);
        t.many.direct_variance *= std::pow(8.0f, -0.7f); // rare bright samples; not believed
        t.strata = t.many;
        t.twin = {0.0f, 0.5f * t.strata.gather_variance, 0.1f * t.strata.direct_variance};
        if (i % 10 == 0) t.twin.gather_variance *= 50.0f; // rare bright samples
        trials.push_back(t);
    }
    const NoiseModel model = fit_noise_model(trials, {32, 32}, {256, 256});
    EXPECT_NEAR(model.gather_power, 1.3f, 1e-4f);
    EXPECT_EQ(model.direct_power, 1.0f);
    EXPECT_NEAR(model.gather_calibration, 0.5f / 0.8f, 1e-4f);
    EXPECT_NEAR(model.direct_calibration, 0.1f / 0.8f, 1e-4f);
    EXPECT_EQ(fit_noise_model({}, {32, 32}, {256, 256}).gather_calibration, 1.0f);
}

} // namespace
} // namespace ajar
