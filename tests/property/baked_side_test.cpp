// SPDX-License-Identifier: GPL-3.0-or-later
// The side that a texel is baked on is the one its normal says; backs reflect the light that falls on them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "room_kit.h"
#include "statistics.h"

namespace {

constexpr float kPi = 3.14159265f;

double valid_mean(const kit::Bake& bake, uint32_t page = 0) {
    const kit::Layer e = bake.layer(AJAR_LAYER_IRRADIANCE, page), valid = bake.layer(AJAR_LAYER_VALIDITY, page);
    kit::Sample s;
    for (uint32_t y = 0; y < e.height; ++y)
        for (uint32_t x = 0; x < e.width; ++x)
            if (valid.at(x, y) == 1.0f) s.add(e.at(x, y));
    return s.mean();
}

/// Corners of box() whose face is not skipped: 0 floor, 1 ceiling, 2 to 5 walls at y low, x high, y high, x low.
void append(kit::MeshData& to, const kit::MeshData& from, size_t skipped_face = 6) {
    for (size_t c = 0; c < from.corners.size(); ++c) {
        if (c / 6 == skipped_face) continue;
        to.corners.push_back(static_cast<uint32_t>(to.positions.size()));
        to.positions.push_back(from.positions[from.corners[c]]);
        to.uv.push_back(from.uv[c]);
    }
}

struct Room {
    float x, y, z, window;
};

/// The four rectangles {y low, z low, y high, z high} around the window in the wall x = room.x.
std::array<std::array<float, 4>, 4> around_window(const Room& r) {
    const float a = 0.5f * (r.y - r.window), b = 0.5f * (r.y + r.window), low = 0.5f * (r.z - r.window),
                high = 0.5f * (r.z + r.window);
    return {{{0, 0, a, r.z}, {b, 0, r.y, r.z}, {a, 0, b, low}, {a, high, b, r.z}}};
}

/// Walls without thickness whose normals point into the room.
kit::MeshData sheets(const Room& r) {
    kit::MeshData m;
    append(m, kit::box({0, 0, 0}, {r.x, r.y, r.z}, true, 0.0f), 3);
    for (const auto& w : around_window(r))
        m.quad({r.x, w[2], w[1]}, {r.x, w[0], w[1]}, {r.x, w[0], w[3]}, {r.x, w[2], w[3]},
               {w[0] / r.y / 3, 0.5f + w[1] / r.z / 2}, {w[2] / r.y / 3, 0.5f + w[3] / r.z / 2});
    return m;
}

/// Whether light enters by the window alone, and as much as brute force says: the baker's mean over its.
void expect_light_of_window(const Room& r, bool solid) {
    SCOPED_TRACE(testing::Message() << r.x << " x " << r.y << " x " << r.z << " m, window " << r.window << " m, "
                                    << (solid ? "solid walls" : "sheets"));
    kit::Scene scene;
    const uint32_t white = scene.diffuse({0.6f, 0.6f, 0.6f});
    scene.instance(scene.mesh(sheets(r)), white, scene.page(36, 36), "room");
    if (solid) {
        const float t = 0.3f;
        const auto wall = [&](kit::Float3 low, kit::Float3 high) {
            scene.instance(scene.mesh(kit::box(low, high, false)), white, AJAR_NONE, "wall");
        };
        wall({-t, -t, -t}, {r.x, r.y + t, -0.001f});
        wall({-t, -t, r.z + 0.001f}, {r.x, r.y + t, r.z + t});
        wall({-t, -t, 0}, {-0.001f, r.y + t, r.z});
        wall({0, -t, 0}, {r.x, -0.001f, r.z});
        wall({0, r.y + 0.001f, 0}, {r.x, r.y + t, r.z});
        for (const auto& w : around_window(r)) wall({r.x + 0.001f, w[0], w[1]}, {r.x + t, w[2], w[3]});
    }
    scene.sky({1, 1, 1});
    scene.commit();
    EXPECT_TRUE(kit::scene_warnings(scene).empty());
    ajar_settings s = kit::settings(2, 256);
    s.bounce_samples = 256;
    const kit::Bake bake(scene, s);
    const kit::Layer e = bake.layer(AJAR_LAYER_IRRADIANCE), valid = bake.layer(AJAR_LAYER_VALIDITY);
    ajar_reference_settings about = kit::reference_settings(2, 150, 8);
    about.choice = AJAR_CHOICE_TEXEL;
    double baked = 0.0, true_light = 0.0, variance = 0.0;
    for (const ajar_reference_point& p : kit::trace(scene, about)) {
        if (valid.at(p.x, p.y) != 1.0f) continue;
        baked += e.at(p.x, p.y);
        true_light += p.irradiance[0];
        variance += double{p.standard_error} * p.standard_error;
    }
    EXPECT_NEAR(baked / true_light, 1.0, 0.02 + 3.0 * std::sqrt(variance) / true_light);
    // Outside, every wall but the ground's side would have pi or about half of it.
    EXPECT_LT(valid_mean(bake), 0.5 * kPi);
}

TEST(BakedSide, RoomsWithAWindowAreLitThroughItAlone) {
    for (const Room& r : {Room{2, 2, 2, 0.5f},
                          {4, 4, 3, 0.3f},
                          {4, 4, 3, 0.8f},
                          {4, 4, 3, 2},
                          {10, 8, 4, 1},
                          {20, 20, 6, 2},
                          {30, 4, 3, 1}})
        for (const bool solid : {false, true}) expect_light_of_window(r, solid);
}

TEST(BakedSide, ClosedRoomOfSheetsUnderASkyIsBlack) {
    kit::Scene scene;
    scene.instance(scene.mesh(kit::box({-2, -2, 0}, {2, 2, 3}, true)), scene.diffuse({0.6f, 0.6f, 0.6f}),
                   scene.page(24, 16), "room");
    scene.sky({1, 1, 1});
    scene.commit();
    EXPECT_EQ(kit::mean(kit::Bake(scene, kit::settings(2)).layer(AJAR_LAYER_IRRADIANCE)), 0.0);
}

TEST(BakedSide, LampInAClosedPropLeavesItsOutsideToTheSky) {
    kit::Scene scene;
    scene.instance(scene.mesh(kit::box({-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}, false)),
                   scene.diffuse({0.6f, 0.6f, 0.6f}), scene.page(24, 16), "lantern");
    scene.point_light({0, 0, 0}, 1000.0f);
    scene.sky({1, 1, 1});
    scene.commit();
    EXPECT_TRUE(kit::scene_warnings(scene).empty());
    EXPECT_NEAR(valid_mean(kit::Bake(scene, kit::settings(2))), kPi, 1e-3); // convex: nothing of itself in sight
}

TEST(BakedSide, RugUnderABridgeIsTheSameWhicheverWayTheBridgeFaces) {
    const auto rug = [](bool up) {
        kit::Scene scene;
        const uint32_t grey = scene.diffuse({0.6f, 0.6f, 0.6f});
        scene.instance(scene.mesh(kit::plane(1.0f, 0.0f)), grey, scene.page(8, 8), "rug");
        scene.instance(scene.mesh(kit::plane(8.0f, -0.005f)), grey, scene.page(64, 64), "ground");
        kit::MeshData deck;
        deck.quad({-3, -1, 0.8f}, {3, -1, 0.8f}, {3, 1, 0.8f}, {-3, 1, 0.8f}, {0, 0}, {1, 1});
        if (!up) std::reverse(deck.corners.begin(), deck.corners.end());
        scene.instance(scene.mesh(deck), grey, AJAR_NONE, "deck");
        ajar_light_desc sun;
        ajar_light_desc_init(&sun);
        sun.type = AJAR_LIGHT_SUN;
        sun.role = AJAR_ROLE_STATIC;
        sun.energy = 3.0f;
        scene.light(sun, kit::translation(0, 0, 9).data());
        scene.sky({0.3f, 0.4f, 0.5f});
        scene.commit();
        EXPECT_TRUE(kit::scene_warnings(scene).empty());
        return kit::mean(kit::Bake(scene, kit::settings(2, 1024)).layer(AJAR_LAYER_IRRADIANCE));
    };
    EXPECT_GT(rug(true), 0.2);
    EXPECT_NEAR(rug(true) / rug(false), 1.0, 0.02);
}

/// Light on a small sheet in the middle of a closed box whose faces reflect half and may glow.
double light_in_box(bool inward, float glow, bool mapped) {
    kit::Scene scene;
    const uint32_t wall =
        glow > 0.0f ? scene.emitter({glow, glow, glow}, {0.5f, 0.5f, 0.5f}) : scene.diffuse({0.5f, 0.5f, 0.5f});
    scene.instance(scene.mesh(kit::plane(0.02f, 0.0f)), scene.diffuse({0, 0, 0}), scene.page(8, 8), "sheet");
    scene.instance(scene.mesh(kit::box({-1, -1, -1}, {1, 1, 1}, inward)), wall, mapped ? scene.page(48, 32) : AJAR_NONE,
                   "box");
    if (!(glow > 0.0f)) scene.point_light({0.3f, 0.2f, 0.5f}, 50.0f, 0.0f, true);
    scene.commit();
    ajar_settings s = kit::settings(10, 1024);
    s.bounce_samples = 256;
    return kit::mean(kit::Bake(scene, s).layer(AJAR_LAYER_IRRADIANCE));
}

TEST(BakedSide, GlowingBoxSeenFromItsBacksIsAFurnace) {
    // L = Le + 0.5 L everywhere inside, so the sheet gets 2 pi Le.
    EXPECT_NEAR(light_in_box(false, 1.0f, false) / (2.0 * kPi), 1.0, 0.01);
}

TEST(BakedSide, RoomWithOutwardNormalsBouncesAsTheSameRoomInward) {
    const double inward = light_in_box(true, 0.0f, true);
    EXPECT_GT(inward, 0.1);
    for (const bool mapped : {false, true})
        EXPECT_NEAR(light_in_box(false, 0.0f, mapped) / inward, 1.0, 0.02) << mapped;
}

TEST(BakedSide, SoItDoesWhereABallGlowsInIt) {
    const auto floor = [](bool inward) {
        kit::Scene scene;
        const uint32_t grey = scene.diffuse({0.6f, 0.6f, 0.6f});
        scene.instance(scene.mesh(kit::plane(2.0f, 0.0f)), grey, scene.page(16, 16), "floor");
        scene.instance(scene.mesh(kit::box({-1.5f, -1.5f, -0.01f}, {1.5f, 1.5f, 2}, inward)), grey, AJAR_NONE, "room");
        scene.instance(scene.mesh(kit::box({-0.1f, -0.1f, 0.9f}, {0.1f, 0.1f, 1.1f}, false)),
                       scene.emitter({10, 10, 10}), AJAR_NONE, "ball");
        scene.commit();
        return valid_mean(kit::Bake(scene, kit::settings(3, 1024)));
    };
    EXPECT_NEAR(floor(false) / floor(true), 1.0, 0.01);
}

TEST(BakedSide, GroundBesideARoomSeesItsOutsideLitByTheSky) {
    const auto ground = [](bool inward) {
        kit::Scene scene;
        const uint32_t grey = scene.diffuse({0.5f, 0.5f, 0.5f});
        scene.instance(scene.mesh(kit::plane(2.0f, 0.0f)), grey, scene.page(8, 8), "ground",
                       kit::translation(3.5, 0, 0).data());
        scene.instance(scene.mesh(kit::box({-2, -2, 0.01f}, {2, 2, 3}, inward)), grey, AJAR_NONE, "room");
        scene.sky({1, 1, 1});
        scene.commit();
        return valid_mean(kit::Bake(scene, kit::settings(3, 1024)));
    };
    EXPECT_NEAR(ground(true) / ground(false), 1.0, 0.005);
}

TEST(BakedSide, TexelsUnderAClosedCrateStayInvalidAndThoseInALitRoomDoNot) {
    const auto valid_share = [](bool lamp_inside) {
        kit::Scene scene;
        const uint32_t grey = scene.diffuse({0.5f, 0.5f, 0.5f}), page = scene.page(32, 32);
        scene.instance(scene.mesh(kit::plane(2.0f, 0.0f)), grey, page, "floor");
        scene.instance(scene.mesh(kit::box({-0.5f, -0.5f, -0.1f}, {0.5f, 0.5f, 0.15f}, false)), grey, AJAR_NONE, "box");
        scene.point_light({0, 0, lamp_inside ? 0.1f : 2.0f}, 10.0f);
        scene.commit();
        const kit::Layer v = kit::Bake(scene, kit::settings(1)).layer(AJAR_LAYER_VALIDITY);
        return std::count(v.data.begin(), v.data.end(), 1.0f) / double(v.data.size());
    };
    EXPECT_NEAR(valid_share(false), 0.81, 0.01); // a quarter is covered, but for a rim that is moved out
    EXPECT_EQ(valid_share(true), 1.0);
}

/// A lamp in a box whose normals point out of it, or into it where flipped.
struct LitBox {
    kit::Scene scene;
    explicit LitBox(uint32_t side, bool flipped = false, bool one_sided = false) {
        kit::MeshData shell = kit::box({-2, -2, 0}, {2, 2, 3}, false);
        for (size_t t = 0; flipped && t < shell.corners.size(); t += 3)
            std::swap(shell.corners[t + 1], shell.corners[t + 2]), std::swap(shell.uv[t + 1], shell.uv[t + 2]);
        scene.bake_side = side;
        ajar_closure white;
        ajar_closure_init(&white);
        white.type = AJAR_CLOSURE_DIFFUSE;
        scene.instance(scene.mesh(shell), scene.material({white}, one_sided), scene.page(48, 32), "box");
        scene.point_light({0.3f, 0.2f, 1.5f}, 50.0f);
        scene.commit();
    }
};

TEST(BakedSide, BackIsWhatFlippedNormalsAre) {
    ajar_settings settings = kit::settings(2);
    settings.keep_sh = 1;
    const kit::Bake back(LitBox(AJAR_SIDE_BACK).scene, settings),
        flipped(LitBox(AJAR_SIDE_FRONT, true).scene, settings);
    for (const uint32_t layer : {AJAR_LAYER_IRRADIANCE, AJAR_LAYER_SH}) {
        const kit::Layer a = back.layer(layer), b = flipped.layer(layer);
        for (uint32_t c = 0; c < a.channels; ++c) {
            SCOPED_TRACE(testing::Message() << layer << ' ' << c);
            const double level = kit::mean(b, 0);
            EXPECT_GT(level, 0.5);
            EXPECT_NEAR(kit::mean(a, c), kit::mean(b, c), 1e-3 * level);
        }
    }
    EXPECT_EQ(valid_mean(kit::Bake(LitBox(AJAR_SIDE_FRONT).scene, kit::settings(2))), 0.0);
}

TEST(BakedSide, CulledBackIsNotBakedAndIsNamed) {
    const LitBox culled(AJAR_SIDE_BACK, false, true);
    EXPECT_TRUE(
        kit::has_warning(kit::scene_warnings(culled.scene), "box", "12 triangles have materials with backface"));
    EXPECT_EQ(valid_mean(kit::Bake(culled.scene, kit::settings(2))), 0.0);
}

} // namespace
