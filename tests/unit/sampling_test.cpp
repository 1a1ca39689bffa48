// SPDX-License-Identifier: GPL-3.0-or-later
// Warps and the sequence that feeds them: densities, samples that follow them, strata.
#include <gtest/gtest.h>

#include <array>
#include <random>
#include <set>

#include "base/owen_sobol.h"
#include "sampling/warp.h"
#include "statistics.h"

namespace ajar {
namespace {

constexpr double kAlarm = 1e-4; ///< chance below which counts are said not to follow a density
constexpr std::array<float, 5> kShares{0.0f, 0.25f, 0.5f, 0.75f, 1.0f};

using Random = std::mt19937;

Vec2 random_point(Random& random) {
    return {unit_float(static_cast<uint32_t>(random())), unit_float(static_cast<uint32_t>(random()))};
}

uint32_t cell_of(float u, uint32_t cells) {
    return std::min(static_cast<uint32_t>(u * static_cast<float>(cells)), cells - 1);
}

/// Chance that counts of independent samples come from equal cells.
double uniformity(const std::vector<double>& counts) {
    double total = 0.0;
    for (const double c : counts) total += c;
    return kit::chi_square_test(counts, std::vector<double>(counts.size(), total / static_cast<double>(counts.size())));
}

// ---- warps -----------------------------------------------------------------------------------

TEST(Warp, HemisphereDensityIntegratesToOne) {
    for (const float share : kShares) {
        double sum = 0.0;
        constexpr int kSteps = 1000; // the density is linear in the cosine: midpoints are exact
        for (int i = 0; i < kSteps; ++i)
            sum += hemisphere_pdf((static_cast<float>(i) + 0.5f) / kSteps, share) * 2.0 * kPi / kSteps;
        EXPECT_NEAR(sum, 1.0, 1e-5) << share;
        EXPECT_EQ(hemisphere_pdf(0.0f, share), 0.0f);
        EXPECT_EQ(hemisphere_pdf(-0.5f, share), 0.0f);
    }
}

TEST(Warp, HemisphereHeightInvertsItsDistribution) {
    // Samples above height c: share (1 - c^2) + (1 - share) (1 - c) of all, the disk's squared radius.
    for (const float share : kShares)
        for (int i = 0; i <= 1000; ++i) {
            const float r2 = static_cast<float>(i) / 1000.0f;
            const double c = hemisphere_cosine(r2, share);
            EXPECT_NEAR(share * (1.0 - c * c) + (1.0 - share) * (1.0 - c), r2, 1e-6) << share;
        }
}

TEST(Warp, HemisphereSamplesFollowTheirDensity) {
    Random random(1);
    constexpr uint32_t kHeights = 12, kSectors = 16;
    constexpr int kCount = 200000;
    for (const float share : kShares) {
        std::vector<double> counts(kHeights * kSectors, 0.0), expected(kHeights * kSectors);
        for (int i = 0; i < kCount; ++i) {
            const Vec3 w = sample_hemisphere(random_point(random), share);
            ASSERT_NEAR(glm::length(w), 1.0f, 1e-5f);
            ASSERT_GE(w.z, 0.0f);
            ++counts[cell_of(w.z, kHeights) * kSectors +
                     cell_of(0.5f + 0.5f * kInvPi * std::atan2(w.y, w.x), kSectors)];
        }
        for (uint32_t h = 0; h < kHeights; ++h) {
            const double low = double(h) / kHeights, high = double(h + 1) / kHeights;
            const double inside = share * (high * high - low * low) + (1.0 - share) * (high - low);
            for (uint32_t s = 0; s < kSectors; ++s) expected[h * kSectors + s] = kCount * inside / kSectors;
        }
        EXPECT_GT(kit::chi_square_test(counts, expected), kAlarm) << share;
    }
}

TEST(Warp, HemisphereSamplesWeighToTheSolidAngle) { // ties sample and density to each other
    Random random(2);
    for (const float share : {0.0f, 0.5f, 0.75f}) { // with share 1 the variance is infinite
        kit::Sample weight, height;
        for (int i = 0; i < 100000; ++i) {
            const Vec3 w = sample_hemisphere(random_point(random), share);
            if (!(w.z > 0.0f)) continue;
            weight.add(1.0 / hemisphere_pdf(w.z, share));
            height.add(w.z * w.z / hemisphere_pdf(w.z, share));
        }
        EXPECT_NEAR(weight.mean(), 2.0 * kPi, 4.0 * weight.error() + 1e-5) << share;
        EXPECT_NEAR(height.mean(), 2.0 * kPi / 3.0, 4.0 * height.error() + 1e-5) << share;
    }
}

TEST(Warp, ConcentricMapKeepsAreas) {
    Random random(3);
    constexpr uint32_t kRings = 10, kSectors = 20;
    std::vector<double> counts(kRings * kSectors, 0.0);
    for (int i = 0; i < 200000; ++i) {
        float c, s, r2;
        concentric(random_point(random), c, s, r2);
        ASSERT_NEAR(c * c + s * s, 1.0f, 1e-6f);
        ASSERT_GE(r2, 0.0f);
        ASSERT_LE(r2, 1.0f);
        ++counts[cell_of(r2, kRings) * kSectors + cell_of(0.5f + 0.5f * kInvPi * std::atan2(s, c), kSectors)];
    }
    EXPECT_GT(uniformity(counts), kAlarm);
}

TEST(Warp, ConcentricMapKeepsNeighboursTogether) {
    // Across the square's diagonals too; the map's derivatives are at most pi / sqrt 2 or so.
    Random random(4);
    const auto on_disk = [](const Vec2& u) {
        float c, s, r2;
        concentric(u, c, s, r2);
        return std::sqrt(r2) * Vec2(c, s);
    };
    constexpr float kStep = 1e-3f;
    for (int i = 0; i < 20000; ++i) {
        const Vec2 u = random_point(random) * (1.0f - kStep);
        const Vec2 diagonal(u.x, i % 2 != 0 ? u.x : 1.0f - kStep - u.x);
        for (const Vec2& p : {u, diagonal}) {
            EXPECT_LT(glm::length(on_disk(p + Vec2(kStep, 0.0f)) - on_disk(p)), 3.0f * kStep);
            EXPECT_LT(glm::length(on_disk(p + Vec2(0.0f, kStep)) - on_disk(p)), 3.0f * kStep);
        }
    }
    for (const float x : {0.0f, 1.0f}) EXPECT_NEAR(glm::length(on_disk({x, 0.5f})), 1.0f, 1e-6f);
    EXPECT_EQ(on_disk({0.5f, 0.5f}), Vec2(0.0f));
}

TEST(Warp, TriangleSamplesAreUniform) {
    Random random(5);
    constexpr uint32_t kCells = 8; // per edge; an upper and a lower triangle in each
    std::vector<double> counts(kCells * kCells, 0.0);
    for (int i = 0; i < 200000; ++i) {
        const Vec2 b = sample_triangle(random_point(random));
        ASSERT_GE(std::min(b.x, b.y), 0.0f);
        ASSERT_LE(b.x + b.y, 1.0f);
        const Vec2 scaled = b * static_cast<float>(kCells);
        const auto x = static_cast<uint32_t>(scaled.x), y = static_cast<uint32_t>(scaled.y);
        const bool upper = scaled.x - static_cast<float>(x) + scaled.y - static_cast<float>(y) > 1.0f;
        // Row y of the small triangles holds 2 (kCells - y) - 1 of them.
        ++counts[y * (2 * kCells - y) + 2 * x + upper];
    }
    EXPECT_GT(uniformity(counts), kAlarm);
}

TEST(Warp, TriangleMapKeepsAreas) {
    // Its Jacobian is 1/2 everywhere, so strata of the square stay strata of the triangle.
    Random random(6);
    constexpr float kStep = 1e-2f;
    for (int i = 0; i < 1000; ++i) {
        const Vec2 u = random_point(random) * (1.0f - kStep);
        if (std::abs(u.x - u.y) < 2.0f * kStep) continue; // the fold
        const Vec2 p = sample_triangle(u), x = sample_triangle(u + Vec2(kStep, 0.0f)) - p,
                   y = sample_triangle(u + Vec2(0.0f, kStep)) - p;
        EXPECT_NEAR(std::abs(x.x * y.y - x.y * y.x), 0.5f * kStep * kStep, 1e-6f);
    }
}

// ---- sequence --------------------------------------------------------------------------------

/// Points of [first, first + 2^bits) in the most crowded cell of a grid of 2^a by 2^(bits - a).
int most_crowded(uint32_t first, uint32_t bits, uint32_t a, uint32_t seed) {
    std::vector<int> counts(1u << bits, 0);
    for (uint32_t i = first; i < first + (1u << bits); ++i) {
        const Vec2 u = owen_sobol(i, seed);
        EXPECT_LT(std::max(u.x, u.y), 1.0f);
        ++counts[(cell_of(u.x, 1u << a) << (bits - a)) + cell_of(u.y, 1u << (bits - a))];
    }
    return *std::max_element(counts.begin(), counts.end());
}

TEST(OwenSobol, EveryAlignedBlockHasOnePointPerCell) {
    // For squares the header promises it; the halves, quarters and so on of the strips in between
    // come with any (0, 2)-sequence.
    for (uint32_t seed = 0; seed < 20; ++seed)
        for (uint32_t bits = 0; bits <= 10; ++bits)
            for (const uint32_t block : {0u, 1u, 6u, 1001u})
                for (uint32_t a = 0; a <= bits; ++a)
                    ASSERT_EQ(most_crowded(block << bits, bits, a, seed), 1)
                        << seed << ' ' << bits << ' ' << block << ' ' << a;
}

/// Seeds as they come about: one of the bake, one of the receiver.
uint32_t seed_of(uint32_t bake, uint32_t receiver) { return hash_combine(bake, receiver); }

TEST(OwenSobol, EachPointIsUniformOverTheSeeds) { // or estimates from few points would be biased
    constexpr uint32_t kCells = 8, kIndices = 128;
    for (uint32_t index = 0; index < kIndices; ++index) {
        std::vector<double> counts(kCells * kCells, 0.0);
        for (uint32_t receiver = 0; receiver < 20000; ++receiver) {
            const Vec2 u = owen_sobol(index, seed_of(index, receiver));
            ++counts[cell_of(u.x, kCells) * kCells + cell_of(u.y, kCells)];
        }
        EXPECT_GT(uniformity(counts), kit::sidak(0.01, kIndices)) << index;
    }
}

TEST(OwenSobol, SeedsGiveUnrelatedSequences) {
    // Where a point falls under one seed of the bake or the receiver says nothing about the next.
    constexpr uint32_t kCells = 8;
    for (const bool other_bake : {false, true}) {
        std::vector<double> x(kCells * kCells, 0.0), y(kCells * kCells, 0.0);
        std::set<std::pair<float, float>> different;
        for (uint32_t i = 0; i < 40000; ++i) {
            const Vec2 a = owen_sobol(3, seed_of(1, i)),
                       b = owen_sobol(3, other_bake ? seed_of(2, i) : seed_of(1, i + 1));
            ++x[cell_of(a.x, kCells) * kCells + cell_of(b.x, kCells)];
            ++y[cell_of(a.y, kCells) * kCells + cell_of(b.y, kCells)];
            different.emplace(a.x, a.y);
        }
        EXPECT_GT(uniformity(x), kAlarm) << other_bake;
        EXPECT_GT(uniformity(y), kAlarm) << other_bake;
        EXPECT_GT(different.size(), 39900u);
    }
}

TEST(OwenSobol, StrataBeatChance) {
    // 256 points integrate a smooth function far better than independent ones, whose standard
    // error is 1/sqrt(12 * 256) per dimension.
    kit::Sample error;
    for (uint32_t seed = 0; seed < 200; ++seed) {
        double sum = 0.0;
        for (uint32_t i = 0; i < 256; ++i) {
            const Vec2 u = owen_sobol(i, seed);
            sum += (u.x + u.y - 1.0) / 256.0;
        }
        error.add(sum);
    }
    EXPECT_LT(std::sqrt(error.variance()), 0.05 * std::sqrt(2.0 / (12.0 * 256.0)));
    EXPECT_NEAR(error.mean(), 0.0, 5.0 * error.error());
}

TEST(OwenSobol, ShufflingMapsAlignedBlocksToAlignedBlocks) {
    for (uint32_t seed = 1; seed < 50; ++seed)
        for (uint32_t bits = 0; bits <= 8; ++bits)
            for (const uint32_t block : {0u, 3u, 77u}) {
                std::set<uint32_t> inside, blocks;
                for (uint32_t i = 0; i < 1u << bits; ++i) {
                    const uint32_t shuffled = shuffle_index((block << bits) + i, seed);
                    inside.insert(shuffled & ((1u << bits) - 1u));
                    blocks.insert(shuffled >> bits);
                }
                ASSERT_EQ(inside.size(), 1u << bits) << "not a permutation";
                ASSERT_EQ(blocks.size(), 1u) << "torn apart";
            }
}

TEST(OwenSobol, ShufflingLeavesNoOrder) { // low bits must not follow those of the index
    std::vector<double> counts(16 * 16, 0.0);
    for (uint32_t seed = 0; seed < 40000; ++seed)
        for (const uint32_t index : {5u, 11u})
            ++counts[(shuffle_index(index, seed * 0x9e3779b9u) & 15u) * 16 +
                     (shuffle_index(index, (seed + 1) * 0x9e3779b9u) & 15u)];
    EXPECT_GT(uniformity(counts), kAlarm);
}

} // namespace
} // namespace ajar
