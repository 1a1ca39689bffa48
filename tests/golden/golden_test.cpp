// SPDX-License-Identifier: GPL-3.0-or-later
// Light and noise of small scenes against golden data: a change that moves either must be seen.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "golden_file.h"

namespace {

using golden::GoldenData;
using golden::RegionLight;

constexpr double kFalseAlarm = 1e-4; ///< chance that the right light with new random numbers fails one check

std::vector<RegionLight> bake(const golden::GoldenScene& scene) {
    golden::Measurement measurement(scene);
    for (uint32_t i = 0; i < golden::kGroup; ++i) measurement.add(golden::bake(scene, scene.tested, 2 * i + 1));
    return measurement.regions();
}

void expect_same_regions(const GoldenData& golden, const std::vector<RegionLight>& baked) {
    ASSERT_EQ(golden.regions.size(), baked.size()) << "terms or covered texels changed";
    for (size_t i = 0; i < baked.size(); ++i) {
        ASSERT_EQ(golden.regions[i].region.text(), baked[i].region.text());
        ASSERT_EQ(golden.regions[i].texels, baked[i].texels) << baked[i].region.text();
    }
}

/// The deviation that is the least likely by chance, over all regions and colours.
void expect_no_outlier(const GoldenData& golden, const std::vector<RegionLight>& baked) {
    const double faint = golden::faint_light(golden.regions);
    double worst = 0.0;
    std::string where;
    for (size_t i = 0; i < baked.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const RegionLight& g = golden.regions[i];
            const double deviation = golden::expected_deviation(g, c, golden::kGroup, faint);
            const double z = (baked[i].mean[c] - g.mean[c]) / deviation;
            if (std::abs(z) <= worst) continue;
            worst = std::abs(z);
            where = g.region.text() + " channel " + std::to_string(c) + ": " + std::to_string(baked[i].mean[c]) +
                    " instead of " + std::to_string(g.mean[c]) + " +- " + std::to_string(deviation);
        }
    const double tests = 3.0 * static_cast<double>(baked.size());
    std::printf("  worst deviation %.2f sigma of %.0f, %s\n", worst, tests, where.c_str());
    EXPECT_GE(kit::student_tail(worst, golden.tested_bakes - 1), kit::sidak(kFalseAlarm, tests)) << where;
}

/// All deviations together: many that are too large, though none stands out. The sum is held
/// against a chi-square distribution stretched to the golden mean and variance.
void expect_likely_sum(const GoldenData& golden, const std::vector<RegionLight>& baked) {
    std::vector<golden::Color> light;
    for (const RegionLight& r : baked) light.push_back(r.mean);
    const double sum = chi_square(golden.regions, light, golden::kGroup),
                 stretch = 0.5 * golden.chi_variance / golden.chi_mean;
    const double chance = kit::chi_square_tail(sum / stretch, golden.chi_mean / stretch);
    std::printf("  sum of squares %.1f, mean %.1f +- %.1f, chance %.3g\n", sum, golden.chi_mean,
                std::sqrt(golden.chi_variance), chance);
    EXPECT_GE(chance, kFalseAlarm);
}

/// Variance of texels relative to the golden one, over the blocks that have noise to speak of. On a
/// logarithmic scale, as one rare bright sample may multiply that of its block.
void expect_golden_noise(const GoldenData& golden, const std::vector<RegionLight>& baked, double most) {
    const double least = 3.0 * golden::faint_light(golden.regions);
    double sum = 0.0, blocks = 0.0;
    for (size_t i = 0; i < baked.size(); ++i) {
        const double before = golden.regions[i].noise;
        if (golden.regions[i].region.whole || before < least * least) continue;
        sum += std::log(std::max(baked[i].noise, golden::kLeastNoise) / before);
        blocks += 1.0;
    }
    ASSERT_GT(blocks, 0.0);
    const double factor = std::exp(sum / blocks);
    std::printf("  variance of texels %.3f times the golden one\n", factor);
    EXPECT_LT(factor, most) << "noisier than before";
    EXPECT_GT(factor, 1.0 / most) << "less noise: make the golden data anew, or these checks grow lax";
}

class Golden : public testing::TestWithParam<std::string> {};

TEST_P(Golden, LightAndNoise) {
    const GoldenData golden = golden::read_golden(AJAR_SOURCE_DIR "/tests/golden/data/" + GetParam() + ".txt");
    const auto scene = golden::make_scene(GetParam());
    const std::vector<RegionLight> baked = bake(*scene);
    ASSERT_NO_FATAL_FAILURE(expect_same_regions(golden, baked));
    expect_no_outlier(golden, baked);
    expect_likely_sum(golden, baked);
    expect_golden_noise(golden, baked, scene->noise_factor);
}

INSTANTIATE_TEST_SUITE_P(, Golden, testing::ValuesIn(golden::scene_names()),
                         [](const auto& info) { return info.param; });

} // namespace
