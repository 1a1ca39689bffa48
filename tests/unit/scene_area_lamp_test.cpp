// SPDX-License-Identifier: GPL-3.0-or-later
// Area lamps with a spread: what samples of them add up to, against closed forms.
#include <gtest/gtest.h>

#include <random>

#include "scene/light.h"

namespace ajar {
namespace {

using Random = std::mt19937;

float unit(Random& random) { return static_cast<float>(random() >> 8) * 0x1p-24f; }

/// 2 m by 1 m at a height of 3 m, shining down with a radiance of 1. skew: how far its y edge leans, m.
Light lamp(Light::Type type, float spread, float skew = 0.0f) {
    ajar_light_desc d{};
    d.type = type == Light::Type::rectangle ? AJAR_LIGHT_AREA_RECTANGLE : AJAR_LIGHT_AREA_ELLIPSE;
    d.role = AJAR_ROLE_STATIC;
    d.size_x = 2.0f;
    d.size_y = 1.0f;
    d.spread = spread;
    const float shape = type == Light::Type::rectangle ? 1.0f : 0.25f * kPi;
    d.energy = 4.0f * 2.0f * shape;
    for (float& c : d.color) c = 1.0f;
    const double transform[12] = {1, skew, 0, 0, 0, 1, 0, 0, 0, 0, 1, 3};
    Affine m;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 4; ++j) m.m[4 * i + j] = transform[4 * i + j];
    return make_light(d, "lamp", m);
}

struct Mean {
    double sum = 0.0, squares = 0.0;
    int count = 0, dark = 0;
    void add(double x) {
        sum += x, squares += x * x, ++count;
        dark += x == 0.0;
    }
    double mean() const { return sum / count; }
    double error() const { return std::sqrt(std::max(squares / count - mean() * mean(), 0.0) / count); }
};

/// Irradiance at p on a floor from n samples.
Mean irradiance(const Light& l, const Vec3& p, int n, Random& random) {
    Mean out;
    for (int i = 0; i < n; ++i) {
        const LightSample s = l.sample(p, {unit(random), unit(random)});
        out.add(s.weight.x * std::max(0.0f, s.direction.z));
    }
    return out;
}

TEST(AreaLamp, AllOfABeamArrivesWhereTheLampIsWider) {
    // The cone over the spread holds pi times the radiance whatever its angle; cos^4 from middle to rim is what varies.
    Random random(3);
    for (const float spread : {0.3f, 0.1f, 0.03f, 0.0175f}) {
        for (const auto type : {Light::Type::rectangle, Light::Type::ellipse}) {
            const Mean e = irradiance(lamp(type, spread), {0.1f, -0.05f, 0}, 4000, random);
            EXPECT_EQ(e.dark, 0) << spread;
            EXPECT_NEAR(e.mean(), kPi, 0.002 * kPi + 4 * e.error()) << spread;
            EXPECT_LT(e.error() * std::sqrt(4000.0), 0.05 * kPi) << spread;
        }
    }
}

TEST(AreaLamp, SpreadKeepsTheFlux) {
    Random random(5);
    for (const float skew : {0.0f, 0.4f})
        for (const auto type : {Light::Type::rectangle, Light::Type::ellipse})
            for (const float spread : {1.5f, 0.5f, 0.1f, 0.02f}) {
                const Light l = lamp(type, spread, skew);
                // Where the lamp or its beam can be, over a floor 3 m below.
                const float beam = 3.0f * std::tan(0.5f * spread), x = 1.2f + beam, y = 0.5f + beam;
                Mean flux;
                for (int i = 0; i < 200000; ++i) {
                    const Vec3 p(x * (2 * unit(random) - 1), y * (2 * unit(random) - 1), 0.0f);
                    const LightSample s = l.sample(p, {unit(random), unit(random)});
                    flux.add(s.weight.x * std::max(0.0f, s.direction.z) * 4.0f * x * y);
                    ASSERT_TRUE(s.weight.x == 0.0f || l.importance(p, {0, 0, 1}) > 0.0f);
                }
                EXPECT_NEAR(flux.mean() / (kPi * l.area), 1.0, 4 * flux.error() / (kPi * l.area)) << spread << skew;
                EXPECT_LT(flux.error(), 0.01 * kPi * l.area);
            }
}

TEST(AreaLamp, EdgeOfABeamIsShadedAsByTheWholeLamp) {
    // Midpoint rule over the lamp, where the spread is wide enough for it.
    Random random(7);
    const Light l = lamp(Light::Type::rectangle, 0.6f);
    for (const Vec3 p : {Vec3(1.0f, 0.5f, 0), Vec3(1.5f, 0.2f, 0), Vec3(0.3f, -1.2f, 0), Vec3(-0.9f, 0.0f, 2.5f)}) {
        constexpr int kSteps = 1000;
        double truth = 0.0;
        for (int i = 0; i < kSteps * kSteps; ++i) {
            const Vec3 q((i % kSteps + 0.5f) * 2 / kSteps - 1, (i / kSteps + 0.5f) / kSteps - 0.5f, 3.0f);
            const Vec3 to = q - p;
            const double square = glm::dot(to, to), tangent = std::hypot(to.x, to.y) / to.z;
            truth += std::max(0.0, std::tan(0.3) - tangent) / (std::tan(0.3) - 0.3) * to.z * to.z / (square * square);
        }
        truth *= 2.0 / (double{kSteps} * kSteps);
        const Mean e = irradiance(l, p, 100000, random);
        EXPECT_NEAR(e.mean(), truth, 4 * e.error() + 1e-4 * truth) << p.x;
        EXPECT_GT(l.importance(p, {0, 0, 1}), 0.2 * truth);
        EXPECT_LT(l.importance(p, {0, 0, 1}), 5.0 * truth);
    }
}

TEST(AreaLamp, BesideABeamNothingCountsUnlessWithinReach) {
    const Light l = lamp(Light::Type::rectangle, 0.02f);
    EXPECT_EQ(l.importance({1.1f, 0, 0}, {0, 0, 1}), 0.0f);
    EXPECT_GT(l.importance({1.1f, 0, 0}, {0, 0, 1}, 0.1f), 0.0f);
    EXPECT_EQ(l.importance({0, 0, 3.5f}, {0, 0, 1}), 0.0f);
}

} // namespace
} // namespace ajar
