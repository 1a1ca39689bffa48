// SPDX-License-Identifier: GPL-3.0-or-later
// Shading normals that lean from their surface. Directions below the surface bring no light, so an even sky of
// radiance 1 gives pi (1 + cos) / 2 at an angle between the two: half of the light of the hemisphere plus that part
// of the other half which the leaning plane leaves (algorithms.md 12).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "scene_kit.h"

namespace {

using std::numbers::pi;

/// A card of 1 m in the plane y = 0 that faces -y, all its normals turned up by an angle.
kit::MeshData card(double angle) {
    kit::MeshData m;
    m.quad({-0.5f, 0, -0.5f}, {0.5f, 0, -0.5f}, {0.5f, 0, 0.5f}, {-0.5f, 0, 0.5f}, {0, 0}, {1, 1});
    m.normals.assign(6, {0.0f, static_cast<float>(-std::cos(angle)), static_cast<float>(std::sin(angle))});
    return m;
}

double mean(const kit::Layer& e) {
    double sum = 0.0;
    for (uint32_t y = 0; y < e.height; ++y)
        for (uint32_t x = 0; x < e.width; ++x) sum += e.at(x, y);
    return sum / (e.width * e.height);
}

/// Mean by brute force.
double traced_mean(const kit::Scene& scene, uint32_t bounces) {
    double sum = 0.0;
    const auto points = kit::trace(scene, kit::reference_settings(bounces, 16, 64));
    for (const ajar_reference_point& p : points) sum += p.irradiance[0];
    return sum / static_cast<double>(points.size());
}

TEST(ShadingNormal, EvenSkyOnACardThatLeans) {
    for (const double degrees : {0.0, 20.0, 60.0, 90.0}) {
        const double angle = degrees / 180.0 * pi, expected = 0.5 * pi * (1.0 + std::cos(angle));
        kit::Scene scene;
        scene.instance(scene.mesh(card(angle)), scene.diffuse({0.9f, 0.9f, 0.9f}), scene.page(8, 8));
        scene.sky({1, 1, 1});
        scene.commit();
        const kit::Layer e = kit::Bake(scene, kit::settings(2, 1024)).layer(AJAR_LAYER_IRRADIANCE);
        EXPECT_NEAR(mean(e) / expected, 1.0, 0.005) << degrees << " degrees";
        EXPECT_NEAR(traced_mean(scene, 2) / expected, 1.0, 0.01) << "brute force, " << degrees << " degrees";
    }
}

/// Light from behind a surface does not come through it where its normals face that way.
TEST(ShadingNormal, LampsBehindTheSurfaceDoNotLightIt) {
    kit::Scene scene;
    scene.instance(scene.mesh(card(pi / 2)), scene.diffuse({0.5f, 0.5f, 0.5f}), scene.page(8, 8));
    scene.point_light({0.0f, 0.4f, 2.0f}, 100.0f);
    scene.commit();
    EXPECT_EQ(mean(kit::Bake(scene, kit::settings(1)).layer(AJAR_LAYER_IRRADIANCE)), 0.0);
}

/// Light that a small tile gets, baked and by brute force, by way of a card of 1 m without a lightmap whose normals
/// lean up by an angle. A lamp far away, whose own light is not stored, shines on the card from (0, -0.6, 0.8).
std::array<double, 2> by_way_of_card(double angle, bool back) {
    kit::MeshData leaf = card(angle);
    if (back) {
        for (size_t i = 0; i < leaf.corners.size(); i += 3) {
            std::swap(leaf.corners[i + 1], leaf.corners[i + 2]);
            std::swap(leaf.uv[i + 1], leaf.uv[i + 2]);
        }
        for (kit::Float3& n : leaf.normals) n = {-n[0], -n[1], -n[2]};
    }
    kit::MeshData tile;
    tile.quad({0.01f, -1, -0.01f}, {-0.01f, -1, -0.01f}, {-0.01f, -1, 0.01f}, {0.01f, -1, 0.01f}, {0, 0}, {1, 1});
    kit::Scene scene;
    scene.instance(scene.mesh(tile), scene.diffuse({0, 0, 0}), scene.page(4, 4));
    scene.instance(scene.mesh(leaf), scene.diffuse({0.5f, 0.5f, 0.5f}), AJAR_NONE);
    scene.point_light({0.0f, -600.0f, 800.0f}, 1e8f, 0.0f, true);
    scene.commit();
    return {mean(kit::Bake(scene, kit::settings(1, 1024)).layer(AJAR_LAYER_IRRADIANCE)), traced_mean(scene, 1)};
}

/// What surfaces without a lightmap, and backs, send on goes by their shading normals: 60 degrees make cos 60 0.6 +
/// sin 60 0.8 out of the 0.6 of the flat card. The same rays meet both.
TEST(ShadingNormal, SurfacesWithoutLightmapReflectByTheirs) {
    const double expected = (0.5 * 0.6 + std::sqrt(0.75) * 0.8) / 0.6;
    for (const bool back : {false, true}) {
        const auto flat = by_way_of_card(0.0, back), leaning = by_way_of_card(pi / 3, back);
        EXPECT_GT(flat[0], 0.0);
        EXPECT_NEAR(leaning[0] / flat[0] / expected, 1.0, 0.005) << (back ? "back" : "front");
        EXPECT_NEAR(leaning[1] / flat[1] / expected, 1.0, 0.005) << "brute force, " << (back ? "back" : "front");
    }
}

/// Every other point of a smooth cube sees no more of the sky than its own plane leaves.
TEST(ShadingNormal, SmoothCubeUnderAnEvenSky) {
    kit::MeshData cube = kit::box({-1, -1, -1}, {1, 1, 1}, false);
    for (const uint32_t c : cube.corners) {
        const kit::Float3& p = cube.positions[c];
        const float length = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        cube.normals.push_back({p[0] / length, p[1] / length, p[2] / length});
    }
    kit::Scene scene;
    scene.instance(scene.mesh(cube), scene.diffuse({0.9f, 0.9f, 0.9f}), scene.page(96, 64));
    scene.sky({1, 1, 1});
    scene.commit();
    const kit::Bake bake(scene, kit::settings(2, 1024));
    const kit::Layer e = bake.layer(AJAR_LAYER_IRRADIANCE);
    double got = 0.0, expected = 0.0;
    constexpr int kCell = 32;
    for (int y = 2; y < kCell - 2; ++y) // the first face's cell, without its border
        for (int x = 2; x < kCell - 2; ++x) {
            const double u = ((x + 0.5) / kCell - 0.02 * 3) / (1.0 - 0.12) * 2 - 1,
                         v = ((y + 0.5) / kCell - 0.02 * 2) / (1.0 - 0.08) * 2 - 1;
            got += e.at(static_cast<uint32_t>(x), static_cast<uint32_t>(y));
            expected += 0.5 * pi * (1.0 + 1.0 / std::sqrt(1.0 + u * u + v * v));
        }
    EXPECT_NEAR(got / expected, 1.0, 0.01);
}

/// A lamp close to a texel with a leaning normal, against the sum over 64 x 64 places of the texel.
TEST(ShadingNormal, LampCloseToALeaningTexel) {
    constexpr double kAngle = pi / 4, kHeight = 0.05, kTexel = 0.125;
    kit::Scene scene;
    scene.instance(scene.mesh(card(kAngle)), scene.diffuse({0.5f, 0.5f, 0.5f}), scene.page(8, 8));
    scene.point_light({0.03f, -static_cast<float>(kHeight), 0.09f}, 100.0f);
    scene.commit();
    const kit::Layer e = kit::Bake(scene, kit::settings(0)).layer(AJAR_LAYER_IRRADIANCE);
    constexpr int kPlaces = 64;
    for (const uint32_t y : {3u, 4u}) {
        double sum = 0.0;
        for (int i = 0; i < kPlaces * kPlaces; ++i) {
            const double x = kTexel * (i % kPlaces + 0.5) / kPlaces,
                         z = kTexel * (y - 4.0 + (i / kPlaces + 0.5) / kPlaces);
            const double dx = 0.03 - x, dz = 0.09 - z, d2 = dx * dx + dz * dz + kHeight * kHeight;
            const double along = kHeight * std::cos(kAngle) + dz * std::sin(kAngle);
            sum += std::max(0.0, along) / (d2 * std::sqrt(d2));
        }
        const double expected = 100.0 / (4.0 * pi) * sum / (kPlaces * kPlaces);
        EXPECT_NEAR(e.at(4, y) / expected, 1.0, 0.05) << "row " << y;
    }
}

} // namespace
