// SPDX-License-Identifier: GPL-3.0-or-later
// Rays that a tile aims at a box.
#include <gtest/gtest.h>

#include "base/owen_sobol.h"
#include "snapshot_kit.h"
#include "transport/tile_aims.h"

namespace ajar {
namespace {

constexpr uint32_t kReceivers = 8, kAimed = 6;

/// A tile on a floor, and far over it a box with nothing in between.
struct Field {
    SnapshotKit kit;
    const Snapshot* scene;
    std::unique_ptr<Tracer> tracer;
    LightmapReceivers receivers;
    AimBox box;

    Field() {
        kit.object(parallelogram({-10, -10, 0}, {20, 0, 0}, {0, 20, 0}), kit.material(Vec3(0.5f)));
        scene = &kit.commit();
        tracer = std::make_unique<Tracer>(*scene);
        receivers.tiles = {{0, kReceivers}};
        for (uint32_t r = 0; r < kReceivers; ++r) {
            receivers.texel.push_back(r);
            receivers.frame.push_back(Frame{});
            receivers.positions.push_back(Vec3(DVec3(0.2 * r, 0.1, 0.001) - scene->origin));
        }
        box = {0, DVec3(1.0, 2.0, 6.0) - scene->origin};
        box.half = {0.5, 0.05, 1.0};
    }
    TileAims aims(float light) const {
        TileAims out(receivers, receivers.tiles[0]);
        out.add(
            *tracer, box,
            [&](const Ray&, const Hit&) {
                return TileAims::Arrival{light, 1e6f * light};
            },
            kAimed, 0.01f, 1);
        return out;
    }
};

TEST(TileAims, AreAsDenseAsTheyAreMany) {
    const Field field;
    const TileAims aims = field.aims(100.0f);
    ASSERT_EQ(aims.count(), 1u);
    EXPECT_EQ(aims.rays(0), kAimed);
    for (uint32_t r = kReceivers; r-- > 0;) {
        const Vec3& p = field.receivers.origins(r)[0];
        const float expected = static_cast<float>(kAimed) / field.box.view_from(p).solid_angle;
        for (uint32_t i = 0; i < 64; ++i) {
            Vec3 w;
            ASSERT_TRUE(aims.sample(0, r, 0, owen_sobol(i, 3), w));
            EXPECT_FLOAT_EQ(aims.density(r, 0, w), expected) << "receiver " << r;
            EXPECT_EQ(aims.density(r, 0, -w), 0.0f) << "away from the box";
        }
    }
}

TEST(TileAims, TakeABoxThatSomebodyElseChose) {
    const Field field;
    TileAims aims(field.receivers, field.receivers.tiles[0]);
    aims.add(field.box, kAimed);
    ASSERT_EQ(aims.count(), 1u);
    EXPECT_EQ(aims.box(0).center, field.box.center);
    Vec3 w;
    ASSERT_TRUE(aims.sample(0, 3, 0, Vec2(0.5f), w));
    EXPECT_GT(aims.density(3, 0, w), 0.0f);
}

TEST(TileAims, LeaveOutBoxesThatBringLittle) {
    const Field field;
    EXPECT_TRUE(field.aims(1e-4f).empty());
}

} // namespace
} // namespace ajar
