// SPDX-License-Identifier: GPL-3.0-or-later
// Light by way of surfaces without a lightmap, against closed forms: the mean is right for any number of rays.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scene_kit.h"

namespace {

using std::numbers::pi;

double mean(const kit::Layer& e) {
    double sum = 0.0;
    for (uint32_t y = 0; y < e.height; ++y)
        for (uint32_t x = 0; x < e.width; ++x) sum += e.at(x, y) / (e.width * e.height);
    return sum;
}

/// Closed box that glows with radiance 1 and reflects rho of what meets it: pi / (1 - rho) everywhere.
TEST(Unmapped, FurnaceOfOccluders) {
    for (const float rho : {0.5f, 0.95f}) {
        kit::Scene scene;
        scene.instance(scene.mesh(kit::plane(0.01f, 0.5f)), scene.diffuse({0, 0, 0}), scene.page(8, 8));
        scene.instance(scene.mesh(kit::box({-1, -1, 0}, {1, 1, 2}, true)), scene.emitter({1, 1, 1}, {rho, rho, rho}),
                       AJAR_NONE);
        scene.commit();
        const double expected = pi / (1.0 - double(rho));
        // A chain brings as much as it has surfaces, a geometric number: the noise of 262144 is 0.2 %.
        EXPECT_NEAR(mean(kit::Bake(scene, kit::settings(1, 4096)).layer(AJAR_LAYER_IRRADIANCE)) / expected, 1.0, 0.008)
            << rho;
    }
}

constexpr double kCeiling = 2.5, kHalf = 2.0, kReflectance = 0.6, kWatts = 100.0;

/// Irradiance at the middle of the floor by way of the ceiling, of a lamp at (0.5, 0.3) some way under it.
double from_ceiling(double below) {
    // In polar coordinates around the foot of the lamp, with the radius as below * tan: even where the light is.
    const auto row = [&](double x, double y) {
        const double dx = x - 0.5, dy = y - 0.3, lamp2 = dx * dx + dy * dy + below * below;
        const double far2 = x * x + y * y + kCeiling * kCeiling;
        return below / (lamp2 * std::sqrt(lamp2)) * kCeiling * kCeiling / (far2 * far2);
    };
    constexpr int kRings = 4000, kAngles = 720;
    double sum = 0.0;
    for (int i = 0; i < kRings; ++i) {
        const double angle = (i + 0.5) / kRings * 0.5 * pi, radius = below * std::tan(angle);
        if (radius > 4.0) break;
        const double step = below / std::pow(std::cos(angle), 2) * 0.5 * pi / kRings;
        for (int k = 0; k < kAngles; ++k) {
            const double a = 2.0 * pi * (k + 0.5) / kAngles, x = 0.5 + radius * std::cos(a),
                         y = 0.3 + radius * std::sin(a);
            if (std::abs(x) < kHalf && std::abs(y) < kHalf) sum += row(x, y) * radius * step * 2.0 * pi / kAngles;
        }
    }
    return kReflectance / pi * kWatts / (4.0 * pi) * sum;
}

/// A lamp whose own light is not stored, under a ceiling without lightmap, over a black floor.
kit::Layer under_ceiling(double below, uint32_t rays, uint32_t seed = 0) {
    kit::Scene scene;
    scene.instance(scene.mesh(kit::plane(0.05f, 0.0f)), scene.diffuse({0, 0, 0}), scene.page(16, 16));
    scene.instance(scene.mesh(kit::plane(2 * static_cast<float>(kHalf), static_cast<float>(kCeiling), false)),
                   scene.diffuse({0.6f, 0.6f, 0.6f}), AJAR_NONE, "ceiling");
    scene.point_light({0.5f, 0.3f, static_cast<float>(kCeiling - below)}, static_cast<float>(kWatts), 0.0f, true);
    scene.commit();
    ajar_settings s = kit::settings(1, rays);
    s.seed = seed;
    return kit::Bake(scene, s).layer(AJAR_LAYER_IRRADIANCE);
}

TEST(Unmapped, LampCloseUnderACeiling) {
    for (const double below : {0.02, 0.05, 0.2, 1.0})
        for (const uint32_t rays : {64u, 1024u}) {
            const double expected = from_ceiling(below);
            EXPECT_NEAR(mean(under_ceiling(below, rays)) / expected, 1.0, 0.02) << below << " m, " << rays << " rays";
        }
}

TEST(Unmapped, LampCloseUnderACeilingMakesNoFireflies) {
    for (const double below : {0.02, 0.05, 0.2}) {
        const double expected = from_ceiling(below);
        double squares = 0.0;
        const kit::Layer e = under_ceiling(below, 256);
        for (uint32_t y = 0; y < e.height; ++y)
            for (uint32_t x = 0; x < e.width; ++x) squares += std::pow(e.at(x, y) / expected - 1.0, 2) / 256.0;
        EXPECT_LT(std::sqrt(squares), 0.25) << below << " m";
    }
}

} // namespace
