// SPDX-License-Identifier: GPL-3.0-or-later
// Whether something blocks a ray, against what it meets first.
#include <gtest/gtest.h>

#include <random>

#include "accel/embree_scene.h"
#include "snapshot_kit.h"

namespace ajar {
namespace {

constexpr int kTriangles = 40, kRays = 4000;
constexpr uint32_t kMasks[] = {kMaskGather, kMaskShadowOpaque, kMaskShadowSwitch, kMaskWall, kMaskGatherAll};

struct Dice {
    std::mt19937 engine{7};
    std::uniform_real_distribution<float> number{-1.0f, 1.0f};
    Vec3 point() { return {number(engine), number(engine), number(engine)}; }
};

/// Small triangles all over a cube, every other one a toggle's.
void scatter(SnapshotKit& kit, Dice& dice) {
    const uint32_t grey = kit.material(Vec3(0.5f)), toggle = kit.toggle();
    for (int i = 0; i < kTriangles; ++i) {
        const Vec3 p = dice.point();
        kit.object({p, p + 0.4f * dice.point(), p + 0.4f * dice.point()}, grey, {}, AJAR_NONE,
                   i % 2 != 0 ? toggle : AJAR_NONE);
    }
}

TEST(TracerOccluded, WhereTheNearestHitIs) {
    Dice dice;
    SnapshotKit kit;
    scatter(kit, dice);
    const Snapshot& scene = kit.commit();
    const Tracer tracer(scene);
    for (const uint32_t mask : kMasks) {
        int blocked = 0;
        for (int i = 0; i < kRays; ++i) {
            const Vec3 p = dice.point() - Vec3(scene.origin);
            const Ray ray{p, dice.point(), 0.0f, 1.0f};
            const bool met = tracer.intersect(ray, mask).triangle != kMiss;
            ASSERT_EQ(tracer.occluded(ray, mask), met) << "ray " << i << ", mask " << mask;
            blocked += met;
        }
        EXPECT_GT(blocked, kRays / 100) << "mask " << mask;
        EXPECT_LT(blocked, kRays) << "mask " << mask;
    }
}

} // namespace
} // namespace ajar
