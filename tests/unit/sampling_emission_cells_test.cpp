// SPDX-License-Identifier: GPL-3.0-or-later
// Points on triangles whose emission is an image.
#include <gtest/gtest.h>

#include <random>

#include "base/hash.h"
#include "sampling/emission_cells.h"
#include "sampling/warp.h"
#include "snapshot_kit.h"
#include "statistics.h"

namespace ajar {
namespace {

using Random = std::mt19937;
Vec2 random_point(Random& random) {
    const auto unit = [&] { return unit_float(static_cast<uint32_t>(random())); };
    const float x = unit();
    return {x, unit()};
}

/// A square whose image is dark but for one of its 32 x 32 texels.
struct Lamp {
    static constexpr uint32_t kSize = 32;
    SnapshotKit kit;
    ThreadPool pool{2};
    Progress progress;
    const Snapshot* scene;
    std::unique_ptr<EmissionCells> cells;

    explicit Lamp(float background = 0.0f) {
        std::vector<float> grey(size_t{kSize} * kSize, background);
        grey[5 * kSize + 20] = 10.0f;
        const std::vector<Vec2> uv = parallelogram_uv({0, 0}, {1, 0}, {0, 1});
        kit.object(parallelogram({0, 0, 0}, {2, 0, 0}, {0, 2, 0}), kit.glowing_image(kSize, kSize, grey), uv,
                   kit.page(16, 16));
        scene = &kit.commit();
        cells = std::make_unique<EmissionCells>(*scene, std::vector<uint32_t>{0, 1}, pool, progress);
    }
    float light(uint32_t triangle, const Vec2& b) const { return luminance(scene->emission(triangle, b.x, b.y)); }
};

TEST(EmissionCells, DensityIntegratesToOne) {
    const Lamp lamp(0.01f);
    Random random(1);
    for (const uint32_t t : {0u, 1u}) {
        kit::Sample density;
        for (int i = 0; i < 200000; ++i) {
            const Vec2 b = sample_triangle(random_point(random));
            density.add(lamp.cells->density(t, b.x, b.y));
        }
        EXPECT_NEAR(density.mean(), 1.0, 4.5 * density.error()) << t;
    }
}

TEST(EmissionCells, SamplesLieInTheTriangleWithTheirDensity) {
    const Lamp lamp(0.01f);
    Random random(2);
    int agree = 0;
    constexpr int kCount = 20000;
    for (int i = 0; i < kCount; ++i) {
        float density;
        const Vec2 b = lamp.cells->sample(0, random_point(random), density);
        ASSERT_GE(std::min(b.x, b.y), 0.0f);
        ASSERT_LE(b.x + b.y, 1.0f + 1e-6f);
        agree += std::abs(lamp.cells->density(0, b.x, b.y) / density - 1.0f) < 1e-4f;
    }
    EXPECT_GE(agree, kCount - 20); // points on the line between two cells may count as either's
}

TEST(EmissionCells, SamplesAddUpToTheMeanAndGoWhereTheImageGlows) {
    const Lamp lamp;
    Random random(3);
    for (const uint32_t t : {0u, 1u}) {
        kit::Sample plain, aimed;
        for (int i = 0; i < 400000; ++i) {
            const Vec2 b = sample_triangle(random_point(random));
            plain.add(lamp.light(t, b));
        }
        for (int i = 0; i < 20000; ++i) {
            float density;
            const Vec2 b = lamp.cells->sample(t, random_point(random), density);
            aimed.add(lamp.light(t, b) / density);
        }
        EXPECT_NEAR(aimed.mean(), plain.mean(), 4.5 * std::hypot(aimed.error(), plain.error())) << t;
        EXPECT_NEAR(lamp.cells->mean(t), plain.mean(), 0.1 * plain.mean() + 4.5 * plain.error()) << t;
        if (plain.mean() == 0.0) continue; // the other half of the square
        EXPECT_LT(aimed.error() * std::sqrt(20000.0), 0.1 * plain.error() * std::sqrt(400000.0)) << t;
    }
}

TEST(EmissionCells, EvenEmissionIsSampledEvenly) {
    SnapshotKit kit;
    kit.object(parallelogram({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), kit.material(Vec3(0.5f), Vec3(3.0f)));
    const Snapshot& scene = kit.commit();
    ThreadPool pool{1};
    Progress progress;
    const EmissionCells cells(scene, {0, 1}, pool, progress);
    float density;
    EXPECT_EQ(cells.sample(1, {0.3f, 0.8f}, density), sample_triangle({0.3f, 0.8f}));
    EXPECT_EQ(density, 1.0f);
    EXPECT_EQ(cells.density(1, 0.2f, 0.1f), 1.0f);
    EXPECT_NEAR(cells.mean(0), 3.0f, 1e-5f);
}

} // namespace
} // namespace ajar
