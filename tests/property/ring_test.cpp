// SPDX-License-Identifier: GPL-3.0-or-later
// Texels around charts, which only bilinear lookups touch: they hold the light of their chart at a part of its rays.
#include <gtest/gtest.h>

#include <cmath>

#include "scene_kit.h"

namespace {

constexpr uint32_t kWidth = 96, kHeight = 64; ///< of the page
constexpr float kMargin = 2.25f / kHeight;    ///< all edges of charts end between a texel's border and its centre
constexpr int kTile = 16, kPacket = 8;

/// A room that glows, all of whose light is the same everywhere: no noise asks for further rays.
struct EvenRoom {
    kit::Scene scene;

    explicit EvenRoom(bool has_set) {
        const uint32_t page = scene.page(kWidth, kHeight);
        if (has_set) scene.current_set = scene.element(AJAR_ELEMENT_LIGHT_SET, "glow");
        scene.instance(scene.mesh(kit::box({0, 0, 0}, {3, 4, 2}, true, kMargin)),
                       scene.emitter({1, 1, 1}, {0.5f, 0.5f, 0.5f}), page, "room");
        scene.commit();
    }
};

/// Whether the square of a texel lies off all charts of kit::box().
bool is_ring(uint32_t x, uint32_t y) {
    const auto off = [](float low, float high, float cell) {
        const float from = std::floor(low / cell) * cell;
        return high <= from + kMargin || low >= from + cell - kMargin;
    };
    const auto left = static_cast<float>(x), low = static_cast<float>(y);
    return off(left / kWidth, (left + 1.0f) / kWidth, 1.0f / 3.0f) ||
           off(low / kHeight, (low + 1.0f) / kHeight, 1.0f / 2.0f);
}

struct Counts {
    int charts = 0, ring = 0; ///< texels with light
    int full_ring = 0;        ///< of the ring with as many rays as charts
};

Counts count(const kit::Layer& samples, float full, float part) {
    Counts n;
    for (uint32_t y = 0; y < kHeight; ++y)
        for (uint32_t x = 0; x < kWidth; ++x) {
            const float s = samples.at(x, y);
            if (s == 0.0f) continue;
            EXPECT_TRUE(s == full || (s == part && is_ring(x, y))) << x << " " << y << ": " << s;
            (is_ring(x, y) ? n.ring : n.charts) += 1;
            n.full_ring += is_ring(x, y) && s == full;
        }
    return n;
}

class Ring : public testing::TestWithParam<bool> {};

TEST_P(Ring, GetsAPartOfTheRaysThatFollowTheNoise) {
    const EvenRoom room(GetParam());
    ajar_settings s = kit::settings(3, 1024);
    s.noise_target = 0.5f;
    const Counts n = count(kit::Bake(room.scene, s).layer(AJAR_LAYER_SAMPLES), 64.0f, 16.0f);
    EXPECT_GT(n.charts, 2000);
    EXPECT_GT(n.ring, 300);
    // A packet with texels of a chart has the rays of the chart.
    constexpr int kTiles = static_cast<int>(kWidth * kHeight) / (kTile * kTile);
    EXPECT_LT(n.full_ring, kTiles * kPacket);
}

TEST_P(Ring, GetsTheRaysThatWereAskedFor) {
    const EvenRoom room(GetParam());
    const Counts n = count(kit::Bake(room.scene, kit::settings(3, 64)).layer(AJAR_LAYER_SAMPLES), 64.0f, 64.0f);
    EXPECT_EQ(n.ring, n.full_ring);
}

TEST_P(Ring, HoldsTheLightOfItsChart) {
    const EvenRoom room(GetParam());
    ajar_settings s = kit::settings(3, 1024);
    s.noise_target = 0.5f;
    const kit::Bake bake(room.scene, s);
    const kit::Layer light = GetParam() ? bake.term(1, kWidth, kHeight) : bake.layer(AJAR_LAYER_IRRADIANCE),
                     samples = bake.layer(AJAR_LAYER_SAMPLES);
    const double expected = 3.14159265 * (1.0 + 0.5 + 0.25 + 0.125);
    for (uint32_t y = 0; y < kHeight; ++y)
        for (uint32_t x = 0; x < kWidth; ++x) {
            if (samples.at(x, y) == 0.0f) continue;
            EXPECT_NEAR(light.at(x, y) / expected, 1.0, 1e-3) << x << " " << y;
        }
}

TEST(RingOfABakeWithElements, SeesLampsHoweverFewItsSamplesAre) {
    kit::Scene scene;
    const uint32_t page = scene.page(kWidth, kHeight);
    scene.instance(scene.mesh(kit::box({0, 0, 0}, {3, 4, 2}, true, kMargin)), scene.diffuse({0.5f, 0.5f, 0.5f}), page);
    scene.current_set = scene.element(AJAR_ELEMENT_LIGHT_SET, "lamp");
    scene.point_light({1.5f, 2.0f, 1.0f}, 100.0f);
    scene.commit();
    ajar_settings s = kit::settings(0, 64);
    s.noise_target = 0.05f;
    s.direct_samples = 1;
    const kit::Bake bake(scene, s);
    const kit::Layer light = bake.term(1, kWidth, kHeight), valid = bake.layer(AJAR_LAYER_VALIDITY);
    int ring = 0;
    for (uint32_t y = 0; y < kHeight; ++y)
        for (uint32_t x = 0; x < kWidth; ++x) {
            if (valid.at(x, y) < 0.7f) continue;
            EXPECT_GT(light.at(x, y), 0.1f) << x << " " << y;
            ring += is_ring(x, y);
        }
    EXPECT_GT(ring, 300);
}

TEST(RingOfAPlainBake, TakesReflectedLightOfItsChart) {
    const EvenRoom room(false);
    ajar_settings s = kit::settings(2, 64);
    s.keep_bounces = 1;
    const kit::Bake bake(room.scene, s);
    const kit::Layer samples = bake.layer(AJAR_LAYER_SAMPLES);
    for (uint32_t bounce = 0; bounce < 2; ++bounce) {
        const kit::Layer light = bake.layer(AJAR_LAYER_BOUNCE + bounce);
        for (uint32_t y = 0; y < kHeight; ++y)
            for (uint32_t x = 0; x < kWidth; ++x) {
                if (samples.at(x, y) == 0.0f) continue;
                EXPECT_NEAR(light.at(x, y) / (3.14159265 * std::pow(0.5, bounce)), 1.0, 1e-3) << x << " " << y;
            }
    }
}

INSTANTIATE_TEST_SUITE_P(WithoutAndWithElements, Ring, testing::Bool(),
                         [](const auto& test) { return test.param ? "elements" : "plain"; });

} // namespace
