// SPDX-License-Identifier: GPL-3.0-or-later
// Which boxes a tile sees.
#include <gtest/gtest.h>

#include "snapshot_kit.h"
#include "transport/boxes_in_sight.h"

namespace ajar {
namespace {

/// Two tiles of floor either side of a wall at x = 0, and a box on each side.
struct Halls {
    SnapshotKit kit;
    const Snapshot* scene;
    std::unique_ptr<Tracer> tracer;
    LightmapReceivers receivers;

    Halls() {
        const uint32_t grey = kit.material(Vec3(0.5f));
        kit.object(parallelogram({-10, -10, 0}, {20, 0, 0}, {0, 20, 0}), grey);
        kit.object(parallelogram({0, -10, 0}, {0, 20, 0}, {0, 0, 6}), grey);
        scene = &kit.commit();
        tracer = std::make_unique<Tracer>(*scene);
        receivers.tiles = {{0, 8}, {8, 8}};
        for (uint32_t r = 0; r < 16; ++r) {
            receivers.texel.push_back(r);
            receivers.frame.push_back(Frame{});
            receivers.positions.push_back(Vec3(DVec3(r < 8 ? -3.0 : 3.0, 0.3 * (r % 8), 0.001) - scene->origin));
        }
    }
    AimBox box(double x, double z) const {
        AimBox b{0, DVec3(x, 1.0, z) - scene->origin};
        b.half = {0.05, 0.4, 0.4};
        return b;
    }
};

TEST(BoxesInSight, AreThoseThatNoWallHides) {
    const Halls halls;
    BoxesInSight sight(*halls.tracer, halls.receivers, {halls.box(-6.0, 1.0), halls.box(6.0, 1.0)}, 1);
    uint64_t rays = 0;
    EXPECT_EQ(sight.from(3, rays), std::vector<uint32_t>{0u});
    EXPECT_EQ(sight.from(8, rays), std::vector<uint32_t>{1u});
    EXPECT_EQ(sight.from(15, rays), std::vector<uint32_t>{1u});
    EXPECT_GT(rays, 0u);
    const uint64_t before = rays;
    EXPECT_EQ(sight.from(0, rays), std::vector<uint32_t>{0u});
    EXPECT_EQ(rays, before) << "looked twice";
}

TEST(BoxesInSight, ThoseBelowTheSurfaceAreNot) {
    const Halls halls;
    BoxesInSight sight(*halls.tracer, halls.receivers, {halls.box(-6.0, -2.0)}, 1);
    uint64_t rays = 0;
    EXPECT_TRUE(sight.from(0, rays).empty());
}

} // namespace
} // namespace ajar
