// SPDX-License-Identifier: GPL-3.0-or-later
// Rays through surfaces that let light through: every one counts once, also those in one plane, and however many there
// are the mean is right.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "accel/embree_scene.h"
#include "snapshot_kit.h"
#include "statistics.h"

namespace ajar {
namespace {

constexpr int kRays = 2000;

struct Dice {
    std::mt19937 engine{11};
    std::uniform_real_distribution<float> number{-1.0f, 1.0f};
    float next() { return number(engine); }
    Vec3 direction() {
        while (true)
            if (const Vec3 v(next(), next(), next()); glm::dot(v, v) > 0.01f && glm::dot(v, v) < 1.0f)
                return glm::normalize(v);
    }
};

/// A wall and two panes in its plane, anywhere and at any size.
struct Wall {
    SnapshotKit kit;
    const Snapshot* scene;
    std::unique_ptr<Tracer> tracer;
    Vec3 center, x, y, n;

    Wall(Dice& dice, float size, float away) {
        const Frame f = frame_from_normal(dice.direction());
        const Vec3 place = dice.direction() * away;
        x = f.x * size, y = f.y * size, n = f.z;
        const uint32_t grey = kit.material(Vec3(0.5f)), glass = kit.glass(Vec3(0.5f));
        kit.object(parallelogram(place - x - y, 2.0f * x, 2.0f * y), grey);
        kit.object(parallelogram(place - 0.7f * x - 0.8f * y, 1.5f * x, 1.6f * y), glass);
        kit.object(parallelogram(place - 0.6f * x - 0.9f * y, 1.3f * x, 1.7f * y), glass);
        scene = &kit.commit();
        center = place - Vec3(scene->origin);
        tracer = std::make_unique<Tracer>(*scene);
    }
    /// Towards a point of both panes.
    Ray ray(Dice& dice, float size) const {
        const Vec3 to = center + (0.5f * dice.next()) * x + (0.5f * dice.next()) * y;
        Vec3 d = dice.direction();
        if (glm::dot(d, n) < 0.0f) d = -d;
        if (!(glm::dot(d, n) > 0.02f)) d = n;
        return {to + d * (size * (1.5f + dice.next())), -d};
    }
};

TEST(TracerLayers, NoWallIsLostBehindPanesInItsPlane) {
    Dice dice;
    for (const auto& [size, away] : {std::pair{0.01f, 0.0f}, {1.0f, 0.0f}, {1.0f, 3000.0f}, {1000.0f, 100.0f}}) {
        const Wall wall(dice, size, away);
        for (int i = 0; i < kRays; ++i) {
            const Ray ray = wall.ray(dice, size);
            Passed passed;
            int layers = 0;
            Hit hit = wall.tracer->intersect(ray, kMaskGather);
            for (;
                 hit.triangle != kMiss && wall.scene->materials[wall.scene->triangles[hit.triangle].material].transmits;
                 ++layers) {
                wall.tracer->pass(hit, passed);
                hit = wall.tracer->next(ray, kMaskGather, passed);
            }
            ASSERT_NE(hit.triangle, kMiss) << "size " << size << ", " << away << " m away, ray " << i;
            ASSERT_LE(layers, 2);
        }
    }
}

TEST(TracerLayers, PanesInOnePlaneAllDim) {
    Dice dice;
    SnapshotKit kit;
    const Frame f = frame_from_normal(dice.direction());
    const Vec3 x = f.x, y = f.y;
    constexpr int kPanes = 5;
    for (int i = 0; i < kPanes; ++i)
        kit.object(parallelogram((-1.0f - 0.1f * static_cast<float>(i)) * (x + y), 3.0f * x, 3.0f * y),
                   kit.glass(Vec3(0.5f)));
    const Snapshot& scene = kit.commit();
    const Tracer tracer(scene);
    for (int i = 0; i < kRays; ++i) {
        const Vec3 at = 0.9f * dice.next() * x + 0.9f * dice.next() * y - Vec3(scene.origin), d = dice.direction();
        if (std::abs(glm::dot(d, f.z)) < 0.02f) continue;
        ASSERT_FLOAT_EQ(tracer.tint({at - 3.0f * d, d}).x, std::pow(0.5f, static_cast<float>(kPanes))) << "ray " << i;
    }
}

/// A pile of panes that lie 1 cm apart.
struct Pile {
    SnapshotKit kit;
    std::unique_ptr<Tracer> tracer;
    Vec3 below{0.0f};

    Pile(int count, float transmittance) {
        const uint32_t glass = kit.glass(Vec3(transmittance));
        for (int i = 0; i < count; ++i)
            kit.object(parallelogram({-5, -5, 0.01f * static_cast<float>(i)}, {10, 0, 0}, {0, 10, 0}), glass);
        const Snapshot& scene = kit.commit();
        below = Vec3(0, 0, -1) - Vec3(scene.origin);
        tracer = std::make_unique<Tracer>(scene);
    }
    /// Mean over rays upwards, each a little different.
    kit::Sample tint(int rays) const {
        kit::Sample s;
        Dice dice;
        for (int i = 0; i < rays; ++i) {
            const Vec3 w = glm::normalize(Vec3(0.3f * dice.next(), 0.3f * dice.next(), 1.0f));
            s.add(tracer->tint({below, w}).x);
        }
        return s;
    }
};

TEST(TracerLayers, HundredsOfClearPanesTakeNothing) { EXPECT_EQ(Pile(400, 1.0f).tint(10).mean(), 1.0); }

TEST(TracerLayers, FewPanesDimExactly) {
    const kit::Sample s = Pile(12, 0.7f).tint(100);
    EXPECT_NEAR(s.mean() / std::pow(0.7, 12), 1.0, 1e-5);
    EXPECT_LT(s.variance(), 1e-12);
}

TEST(TracerLayers, ManyAndDarkPanesAreRightOnAverage) {
    for (const auto& [count, transmittance] : {std::pair{40, 0.9f}, {100, 0.97f}, {1, 1e-5f}, {3, 0.01f}}) {
        const kit::Sample s = Pile(count, transmittance).tint(40000);
        const double expected = std::pow(double(transmittance), count);
        EXPECT_NEAR(s.mean(), expected, 4.0 * s.error() + 1e-6 * expected) << count << " of " << transmittance;
        EXPECT_LT(s.error(), 0.1 * expected) << "the test says something";
    }
}

TEST(TracerLayers, TheSameRayGetsTheSame) {
    const Pile pile(60, 0.9f);
    const Ray ray{pile.below, glm::normalize(Vec3(0.1f, 0.2f, 1.0f))};
    const Vec3 first = pile.tracer->tint(ray);
    for (int i = 0; i < 10; ++i) EXPECT_EQ(pile.tracer->tint(ray).x, first.x);
}

} // namespace
} // namespace ajar
