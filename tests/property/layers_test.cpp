// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces that let light through: any number of them, and those in the plane of a wall.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scene_kit.h"

namespace {

using std::numbers::pi;

uint32_t glass(kit::Scene& scene, float transmittance) {
    ajar_closure c;
    ajar_closure_init(&c);
    c.type = AJAR_CLOSURE_TRANSPARENT;
    for (float& v : c.color.value) v = transmittance;
    return scene.material({c});
}

/// A floor of 1 m under panes of 200 m, 1 cm apart: next to no light gets past their edges.
void pile(kit::Scene& scene, int count, float transmittance) {
    scene.instance(scene.mesh(kit::plane(1.0f, 0.0f)), scene.diffuse({0, 0, 0}), scene.page(4, 4));
    const uint32_t material = glass(scene, transmittance);
    for (int i = 0; i < count; ++i)
        scene.instance(scene.mesh(kit::plane(200.0f, 1.0f + 0.01f * static_cast<float>(i), false)), material, AJAR_NONE,
                       "pane");
}

double mean(const kit::Layer& e) {
    double sum = 0.0;
    for (uint32_t y = 0; y < e.height; ++y)
        for (uint32_t x = 0; x < e.width; ++x) sum += e.at(x, y) / (e.width * e.height);
    return sum;
}

double brute_force(const kit::Scene& scene) {
    const auto points = kit::trace(scene, kit::reference_settings(0, 8, 32));
    double sum = 0.0;
    for (const ajar_reference_point& p : points) sum += p.irradiance[0] / static_cast<double>(points.size());
    return sum;
}

TEST(Layers, SkyAndLampThroughHundredsOfClearPanes) {
    kit::Scene scene;
    pile(scene, 300, 1.0f);
    scene.sky({1, 1, 1});
    scene.point_light({0, 0, 50}, 1000.0f);
    scene.commit();
    const double expected = pi + 1000.0 / (4.0 * pi) / 2500.0;
    EXPECT_NEAR(mean(kit::Bake(scene, kit::settings(1, 64)).layer(AJAR_LAYER_IRRADIANCE)) / expected, 1.0, 0.002);
    EXPECT_NEAR(brute_force(scene) / expected, 1.0, 0.02);
}

TEST(Layers, SkyThroughManyDimPanes) {
    kit::Scene scene;
    pile(scene, 50, 0.95f);
    scene.sky({1, 1, 1});
    scene.commit();
    const double expected = pi * std::pow(0.95, 50); // 0.077 of the sky
    // 16 texels of 4096 rays; after the 16th pane rays go on by chance, worth .95^16 each: 1 % of noise.
    EXPECT_NEAR(mean(kit::Bake(scene, kit::settings(0, 4096)).layer(AJAR_LAYER_IRRADIANCE)) / expected, 1.0, 0.04);
}

/// A closed room under a bright sky, a clear pane in the plane of each of two walls, all turned.
TEST(Layers, PanesInTheWallsPlaneDoNotOpenARoom) {
    for (const double angle : {0.0, 0.7}) {
        const double c = std::cos(angle), s = std::sin(angle);
        const std::array<double, 12> turned = {c, -s, 0, 11.3, s * c, c * c, -s, -7.1, s * s, s * c, c, 3.3};
        kit::Scene scene;
        ajar_closure diffuse;
        ajar_closure_init(&diffuse);
        const uint32_t wall = scene.material({diffuse}, true);
        scene.instance(scene.mesh(kit::box({-2, -2, 0}, {2, 2, 3}, true)), wall, scene.page(48, 48), "room",
                       turned.data());
        kit::MeshData panes;
        panes.quad({-2, -0.5f, 1}, {-2, 0.5f, 1}, {-2, 0.5f, 2}, {-2, -0.5f, 2}, {0, 0}, {1, 1});
        panes.quad({-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0}, {0.5f, 0.5f, 0}, {-0.5f, 0.5f, 0}, {0, 0}, {1, 1});
        scene.instance(scene.mesh(panes), glass(scene, 1.0f), AJAR_NONE, "panes", turned.data());
        scene.sky({100, 100, 100});
        scene.commit();
        const kit::Layer e = kit::Bake(scene, kit::settings(1, 256)).layer(AJAR_LAYER_IRRADIANCE);
        for (const float v : e.data) ASSERT_EQ(v, 0.0f) << "turned by " << angle;
        EXPECT_EQ(brute_force(scene), 0.0) << "turned by " << angle;
    }
}

} // namespace
