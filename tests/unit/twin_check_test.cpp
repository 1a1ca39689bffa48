// SPDX-License-Identifier: GPL-3.0-or-later
#include "pass/twin_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace {

using namespace ajar;

constexpr uint32_t kTiles = 4000;
constexpr float kLevel = 2.0f;

/// A bake of kTiles tiles of one receiver each, lit alike.
struct EvenBake {
    LightmapReceivers receivers;
    BakeResult result;

    EvenBake() {
        for (uint32_t i = 0; i < kTiles; ++i) receivers.tiles.push_back({i, 1});
        receivers.ring.assign(kTiles, 0);
        result.irradiance.assign(kTiles, Vec3(kLevel));
        result.inside.assign(kTiles, 0.0f);
    }

    /// Calibration if answers have relative noise gather, the bake's source that much, another of ratio times fewer
    /// rays more, and strata state the variance of stated.
    ErrorCalibration calibrate(double gather, double source, double ratio, double stated) const {
        std::mt19937 random(7);
        const auto normal = [&](double s) { return s * std::normal_distribution<>()(random); };
        TwinCheck check(receivers, result);
        for (size_t k = 0; k < check.count(); ++k) {
            const double own = normal(source), other = normal(source * std::sqrt(ratio));
            const auto answer = [&](double s) { return static_cast<float>(kLevel * (1.0 + s + normal(gather))); };
            check.compare(k, static_cast<uint32_t>(k * check.step()),
                          {answer(own), answer(own), answer(other), std::pow(stated * kLevel, 2)});
        }
        return check.finish(ratio);
    }
};

TEST(TwinCheck, CorrectsWhatStrataOverstate) {
    EXPECT_NEAR(EvenBake().calibrate(0.02, 0.0, 4.0, 0.04).factor, 0.5, 0.04);
}

TEST(TwinCheck, AddsTheNoiseOfTheSource) {
    const ErrorCalibration c = EvenBake().calibrate(0.02, 0.03, 4.0, 0.02);
    EXPECT_NEAR(c.factor, std::sqrt(0.02 * 0.02 + 0.03 * 0.03) / 0.02, 0.12);
    EXPECT_GT(c.spread, 0.005f);
    EXPECT_LT(c.spread, 0.1f);
}

TEST(TwinCheck, LeavesOutWhatIsNotValid) {
    EvenBake bake;
    bake.receivers.ring.assign(kTiles, 1);
    EXPECT_EQ(bake.calibrate(0.02, 0.0, 4.0, 0.04).factor, 1.0f);
    bake.receivers.ring.assign(kTiles, 0);
    bake.result.inside.assign(kTiles, 1.0f);
    EXPECT_EQ(bake.calibrate(0.02, 0.0, 4.0, 0.04).factor, 1.0f);
}

TEST(TwinCheck, LooksAtReceiversOnCharts) {
    LightmapReceivers receivers;
    constexpr uint32_t kTile = 100, kOnCharts = 21;
    for (uint32_t i = 0; i < 64; ++i) receivers.tiles.push_back({i * kTile, i == 0 ? 0 : kTile});
    for (uint32_t r = 0; r < 64 * kTile; ++r) {
        receivers.ring.push_back(r % kTile >= kOnCharts);
        receivers.coarse_from.push_back(r);
    }
    std::vector<bool> seen(kOnCharts, false);
    for (size_t i = 1; i < receivers.tiles.size(); ++i) {
        const Tile part = TwinCheck::part(receivers, i);
        ASSERT_GT(part.count, 0u);
        for (uint32_t r = part.first; r < part.first + part.count; ++r) {
            ASSERT_LT(r - receivers.tiles[i].first, kOnCharts);
            seen[r - receivers.tiles[i].first] = true;
        }
    }
    EXPECT_EQ(std::count(seen.begin(), seen.end(), true), kOnCharts);
    EXPECT_EQ(TwinCheck::part(receivers, 0).count, 0u);
}

TEST(TwinCheck, FewBrightSamplesAreAWideSpread) {
    const EvenBake bake;
    TwinCheck check(bake.receivers, bake.result);
    for (size_t k = 0; k < check.count(); ++k) {
        const float second = k == 5 ? 100.0f * kLevel : kLevel * (k % 2 != 0 ? 1.01f : 0.99f);
        check.compare(k, static_cast<uint32_t>(k * check.step()), {kLevel, second, second, 1e-4});
    }
    EXPECT_GT(check.finish(1.0).spread, 0.4f);
}

} // namespace
