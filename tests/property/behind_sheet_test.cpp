// SPDX-License-Identifier: GPL-3.0-or-later
// Walls without thickness have places on both sides: a floor keeps its own light right up to their backs.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "room_kit.h"

namespace {

constexpr uint32_t kSize = 32;   ///< texels of a floor of 4 m
constexpr float kTexel = 0.125f; ///< m
constexpr float kHeight = 2.0f;  ///< m
constexpr float kLong = 1000.0f; ///< m, half the length of what counts as endless
constexpr uint32_t kMiddle = 16; ///< the row and the first column with x > 0

/// A black floor, and a black tent without thickness on it whose wall at x = wall shows its back to larger x; below
/// the tent it is dark.
struct Tent {
    kit::Scene scene;
    uint32_t black = scene.diffuse({0, 0, 0});

    Tent(float wall, bool roof) {
        scene.instance(scene.mesh(kit::plane(4.0f, 0.0f)), black, scene.page(kSize, kSize), "floor");
        kit::MeshData m;
        m.quad({wall, -kLong, 0}, {wall, -kLong, kHeight}, {wall, kLong, kHeight}, {wall, kLong, 0}, {0, 0}, {1, 1});
        if (roof)
            m.quad({-3, kLong, 0}, {wall, kLong, kHeight}, {wall, -kLong, kHeight}, {-3, -kLong, 0}, {0, 0}, {1, 1});
        scene.instance(scene.mesh(m), black, AJAR_NONE, "tent");
    }
    kit::Layer irradiance() const { return kit::Bake(scene, kit::settings(0, 1024)).layer(AJAR_LAYER_IRRADIANCE); }
};

/// Of a floor under a sky of radiance 1, d behind an endless black wall, as a share of pi: by the wall's form factor
/// (1 - d / sqrt(d^2 + h^2)) / 2.
double sky_behind_wall(double d) { return 0.5 * (1.0 + d / std::hypot(d, double{kHeight})); }

TEST(BehindSheet, FloorHoldsTheLightOfItsOwnSide) {
    Tent tent(0.0f, true);
    tent.scene.sky({1, 1, 1});
    tent.scene.commit();
    const kit::Layer e = tent.irradiance();
    for (uint32_t x = 0; x < 4; ++x) {
        EXPECT_NEAR(e.at(kMiddle + x, kMiddle) / std::numbers::pi, sky_behind_wall(kTexel * (x + 0.5)), 0.01) << x;
        EXPECT_LT(e.at(kMiddle - 1 - x, kMiddle), 1e-3f) << "in the tent, " << x;
    }
}

TEST(BehindSheet, TexelAcrossItHoldsTheSideThatPeopleLookAtUnlessThatIsSmall) {
    for (const float share : {0.12f, 0.4f, 0.6f, 0.88f}) { // of column kMiddle before the wall
        const float wall = share * kTexel;
        Tent tent(wall, true);
        tent.scene.sky({1, 1, 1});
        tent.scene.commit();
        const kit::Layer e = tent.irradiance();
        const double behind = sky_behind_wall(0.5 * kTexel - wall), expected = share < 0.25f ? behind : 0.0;
        for (uint32_t y = 12; y < 20; ++y) EXPECT_NEAR(e.at(kMiddle, y) / std::numbers::pi, expected, 0.02) << share;
        EXPECT_NEAR(e.at(kMiddle + 1, kMiddle) / std::numbers::pi, sky_behind_wall(1.5 * kTexel - wall), 0.01) << share;
    }
}

TEST(BehindSheet, FloorHoldsTheLightOfALampOnItsSide) {
    Tent tent(0.0f, false);
    constexpr float kFar = 1.5f, kUp = 1.0f, kWatts = 100.0f; // of the lamp
    tent.scene.point_light({kFar, 0.0625f, kUp}, kWatts);
    tent.scene.commit();
    const kit::Layer e = tent.irradiance();
    for (uint32_t x = 0; x < 4; ++x) {
        const double d = kFar - kTexel * (x + 0.5), square = d * d + kUp * kUp;
        const double expected = kWatts / (4.0 * std::numbers::pi) * kUp / std::pow(square, 1.5);
        EXPECT_NEAR(e.at(kMiddle + x, kMiddle) / expected, 1.0, 0.01) << x;
        EXPECT_EQ(e.at(kMiddle - 1 - x, kMiddle), 0.0f) << "in its shadow, " << x;
    }
}

TEST(BehindSheet, FloorUnderACrateWithoutBottomIsAsBrightAsBeforeIt) {
    kit::Scene scene;
    scene.sky({1, 1, 1});
    const uint32_t black = scene.diffuse({0, 0, 0});
    scene.instance(scene.mesh(kit::plane(4.0f, 0.0f)), black, scene.page(kSize, kSize), "floor");
    constexpr float kHalf = 0.53f, kTop = 0.3f; // m: columns 11 and 20 lie mostly before the walls
    kit::MeshData m;
    m.quad({-kHalf, -kHalf, kTop}, {kHalf, -kHalf, kTop}, {kHalf, kHalf, kTop}, {-kHalf, kHalf, kTop}, {0, 0}, {1, 1});
    const kit::Float2 corner[] = {{-kHalf, -kHalf}, {kHalf, -kHalf}, {kHalf, kHalf}, {-kHalf, kHalf}};
    for (int i = 0; i < 4; ++i) {
        const kit::Float2 a = corner[i], b = corner[(i + 1) % 4];
        m.quad({a[0], a[1], 0}, {b[0], b[1], 0}, {b[0], b[1], kTop}, {a[0], a[1], kTop}, {0, 0}, {1, 1});
    }
    scene.instance(scene.mesh(m), black, AJAR_NONE, "crate");
    scene.commit();
    const kit::Layer e = kit::Bake(scene, kit::settings(0, 1024)).layer(AJAR_LAYER_IRRADIANCE);
    for (uint32_t y = 14; y < 18; ++y)
        for (const uint32_t x : {12u, 19u}) { // dark, but bilinear lookups beside the crate read it
            const double before = e.at(x == 12 ? 11 : 20, y);
            EXPECT_GT(e.at(x, y), 0.7 * before) << x << ' ' << y;
            EXPECT_LT(e.at(x, y), 1.1 * before) << x << ' ' << y;
        }
}

} // namespace
