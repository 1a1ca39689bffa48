// SPDX-License-Identifier: GPL-3.0-or-later
// Light that changes within a texel: the texel's mean keeps its flux.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "scene_kit.h"

namespace {

using std::numbers::pi;

ajar_light_desc lamp(uint32_t type, float watts) {
    ajar_light_desc d;
    ajar_light_desc_init(&d);
    d.name = "lamp";
    d.type = type;
    d.role = AJAR_ROLE_STATIC;
    d.energy = watts;
    return d;
}

/// Flux on a black floor of 2 m with this many texels in a row, under a lamp that shines straight down from height.
double flux_below(const ajar_light_desc& d, double height, uint32_t texels, uint32_t seed = 0) {
    kit::Scene scene;
    scene.instance(scene.mesh(kit::plane(2.0f, 0.0f)), scene.diffuse({0, 0, 0}), scene.page(texels, texels));
    scene.light(d, kit::translation(0.137, -0.211, height).data());
    scene.commit();
    ajar_settings s = kit::settings(0);
    s.seed = seed;
    s.positions_per_texel = 4;
    const kit::Layer e = kit::Bake(scene, s).layer(AJAR_LAYER_IRRADIANCE);
    double sum = 0.0;
    for (uint32_t y = 0; y < texels; ++y)
        for (uint32_t x = 0; x < texels; ++x) sum += e.at(x, y);
    return sum * 4.0 / (static_cast<double>(texels) * texels);
}

TEST(NearLight, SmallAreaLampsKeepTheirFlux) {
    // All that a lamp of 1 cm or less sends down arrives: Blender's area lamps send pi / 4 of their watts.
    for (const double height : {0.03, 0.01, 0.001}) {
        ajar_light_desc d = lamp(AJAR_LIGHT_AREA_RECTANGLE, 100.0f);
        d.size_x = d.size_y = 0.01f;
        EXPECT_NEAR(flux_below(d, height, 32) / (25.0 * pi), 1.0, 0.02) << height;
    }
}

TEST(NearLight, LampsWiderThanATexelKeepTheirFlux) {
    for (const double height : {0.03, 0.003}) {
        ajar_light_desc d = lamp(AJAR_LIGHT_AREA_RECTANGLE, 100.0f);
        d.size_x = d.size_y = 0.2f;
        EXPECT_NEAR(flux_below(d, height, 32) / (25.0 * pi), 1.0, 0.02) << height;
        d.type = AJAR_LIGHT_AREA_ELLIPSE;
        EXPECT_NEAR(flux_below(d, height, 32) / (25.0 * pi), 1.0, 0.02) << height;
    }
}

/// Flux on a disk of the floor's area below a point lamp of intensity 1: the lamp is a disk that faces each point, the
/// part of it below the floor's plane does not count.
double flux_below_ball(double radius, double height) {
    constexpr int kSteps = 400, kRings = 60, kTurns = 60;
    const double outer = 2.0 / std::sqrt(pi), first = std::asinh(outer / height) / kSteps;
    double flux = 0.0;
    for (int i = 0; i < kSteps; ++i) {
        const double t = (i + 0.5) * first, out = height * std::sinh(t), width = height * std::cosh(t) * first;
        const double far = std::hypot(out, height), up = height / far, rim = far / std::hypot(far, radius);
        double mean = 0.0; // of the cosine over the solid angle of the lamp
        for (int k = 0; k < kRings * kTurns; ++k) {
            const double z = 1.0 - (k / kTurns + 0.5) / kRings * (1.0 - rim), angle = 2.0 * pi * (k % kTurns) / kTurns;
            mean += std::max(0.0, z * up + std::sqrt(1.0 - z * z) * std::cos(angle) * out / far) / (kRings * kTurns);
        }
        flux += 2.0 * pi * out * width * mean * 2.0 * (1.0 - rim) / (radius * radius);
    }
    return flux;
}

TEST(NearLight, PointLampsOfSomeSizeKeepTheirFlux) {
    for (const double height : {0.1, 0.01, 0.001}) {
        ajar_light_desc d = lamp(AJAR_LIGHT_POINT, 100.0f);
        d.radius = 0.01f;
        double mean = 0.0;
        for (uint32_t seed = 0; seed < 4; ++seed) mean += 0.25 * flux_below(d, height, 128, seed);
        EXPECT_NEAR(mean / (flux_below_ball(0.01, height) * 25.0 / pi), 1.0, 0.03) << height;
    }
}

TEST(NearLight, NarrowBeamsKeepTheirFlux) {
    for (const float spread : {0.3f, 0.03f, 0.0f}) {
        ajar_light_desc d = lamp(AJAR_LIGHT_AREA_RECTANGLE, 100.0f);
        d.size_x = d.size_y = 0.2f;
        d.spread = spread;
        double mean = 0.0;
        for (uint32_t seed = 0; seed < 4; ++seed) mean += 0.25 * flux_below(d, 1.0, 32, seed) / (25.0 * pi);
        EXPECT_NEAR(mean, 1.0, 0.015) << spread;
    }
}

TEST(NearLight, ShadowEdgesLieWhereTheyAreWithinATexel) {
    // A sun straight above a sheet whose edge runs through a row of texels.
    for (const float share : {0.1f, 0.28f, 0.6f, 0.9f}) {
        constexpr uint32_t kSize = 8;
        kit::Scene scene;
        scene.instance(scene.mesh(kit::plane(2.0f, 0.0f)), scene.diffuse({0, 0, 0}), scene.page(kSize, kSize));
        kit::MeshData sheet;
        const float edge = -0.25f + 0.25f * share;
        sheet.quad({-2, -2, 1}, {edge, -2, 1}, {edge, 2, 1}, {-2, 2, 1}, {0, 0}, {1, 1});
        scene.instance(scene.mesh(sheet), scene.diffuse({0, 0, 0}), AJAR_NONE);
        scene.light(lamp(AJAR_LIGHT_SUN, 1.0f), kit::translation(0, 0, 5).data());
        scene.commit();
        const kit::Layer e = kit::Bake(scene, kit::settings(0)).layer(AJAR_LAYER_IRRADIANCE);
        double mean = 0.0;
        for (uint32_t y = 0; y < kSize; ++y) {
            EXPECT_NEAR(e.at(2, y), 0.0, 1e-6);
            EXPECT_NEAR(e.at(4, y), 1.0, 1e-3);
            mean += e.at(3, y) / kSize;
        }
        EXPECT_NEAR(mean, 1.0 - share, 0.02);
    }
}

TEST(NearLight, WideSunsLoseWhatCyclesSunsLose) {
    // The disk's mean cosine, 2 (sqrt(1 + t^2) - 1) / t^2 with t the tangent of half the angle; Blender 3.4.1's Cycles
    // bakes .984, .935, .702 and .132 for .5, 1, 2 and 3 rad.
    for (const auto& [angle, cycles] : {std::pair{0.5f, 0.984}, {1.0f, 0.935}, {2.0f, 0.702}, {3.0f, 0.132}}) {
        kit::Scene scene;
        scene.instance(scene.mesh(kit::plane(2.0f, 0.0f)), scene.diffuse({0, 0, 0}), scene.page(8, 8));
        ajar_light_desc d = lamp(AJAR_LIGHT_SUN, 1.0f);
        d.sun_angle = angle;
        scene.light(d, kit::translation(0, 0, 5).data());
        scene.commit();
        const kit::Layer e = kit::Bake(scene, kit::settings(0)).layer(AJAR_LAYER_IRRADIANCE);
        double mean = 0.0;
        for (size_t i = 0; i < e.data.size(); ++i) mean += e.data[i] / static_cast<double>(e.data.size());
        EXPECT_NEAR(mean, cycles, 0.004) << angle;
    }
}

TEST(NearLight, DimAndBrightScenesWarnOfTheirUnit) {
    for (const float watts : {1e-8f, 1.0f, 1e8f}) {
        kit::Scene scene("the scene");
        scene.instance(scene.mesh(kit::plane(2.0f, 0.0f)), scene.diffuse({0, 0, 0}), scene.page(8, 8));
        scene.light(lamp(AJAR_LIGHT_SUN, watts), kit::translation(0, 0, 5).data());
        scene.commit();
        const std::string report = kit::Bake(scene, kit::settings(0)).report();
        EXPECT_EQ(report.find("stores irradiance in units of") != std::string::npos, watts != 1.0f) << report;
        EXPECT_NE(report.find("\"range_clamped\": 0"), std::string::npos) << report;
    }
}

} // namespace
