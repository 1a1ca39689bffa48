// SPDX-License-Identifier: GPL-3.0-or-later
// Seam stitching (algorithms.md 9.5): which edges are seams, and what solving for them does.
#include "post/stitch.h"

#include <gtest/gtest.h>

#include <random>

#include "snapshot_kit.h"

namespace ajar {
namespace {

constexpr double kLambda = 0.1;    ///< algorithms.md 9.5
constexpr float kAnywhere = 0.16f; ///< of the step may stay where the seam ends: those texels carry half the points
constexpr Page kPage{32, 16, 0};

/// Two charts on one page: the right edge of A, u = 10, meets the left edge of B, u = 20, from
/// v = 2 to 14. Both have a ring of texels around them.
struct TwoCharts {
    std::vector<Vec3> value = std::vector<Vec3>(kPage.width * kPage.height, Vec3(0.0f));
    std::vector<uint8_t> usable = std::vector<uint8_t>(kPage.width * kPage.height, 0);
    std::vector<SeamPoint> seam;

    TwoCharts() {
        for (uint32_t y = 1; y < 15; ++y)
            for (uint32_t x = 0; x < 32; ++x) usable[at(x, y)] = in_a(x) || in_b(x);
        for (int i = 0; i < 36; ++i) { // three points per texel
            const float v = 2.0f + (static_cast<float>(i) + 0.5f) / 3.0f;
            seam.push_back({bilinear_tap(kPage, {10.0f, v}), bilinear_tap(kPage, {20.0f, v})});
        }
    }
    static uint32_t at(uint32_t x, uint32_t y) { return y * kPage.width + x; }
    static bool in_a(uint32_t x) { return x >= 2 && x <= 10; }
    static bool in_b(uint32_t x) { return x >= 19 && x <= 28; }

    template <class F>
    void fill(F f) {
        for (uint32_t y = 1; y < 15; ++y)
            for (uint32_t x = 0; x < 32; ++x)
                if (in_a(x) || in_b(x)) value[at(x, y)] = f(x, y);
    }
    uint64_t stitch() { return stitch_seams(seam, usable, value); }
};

Vec3 read(const std::vector<Vec3>& value, const BilinearTap& t) {
    Vec3 sum(0.0f);
    for (int k = 0; k < 4; ++k) sum += t.weight[k] * value[t.texel[k]];
    return sum;
}

/// Largest difference of the two sides of a seam.
float step(const TwoCharts& c) {
    float worst = 0.0f;
    for (const SeamPoint& p : c.seam) {
        const Vec3 d = glm::abs(read(c.value, p.a) - read(c.value, p.b));
        worst = std::max(worst, max_component(d));
    }
    return worst;
}

glm::dvec3 sum(const std::vector<Vec3>& value) {
    glm::dvec3 total(0.0);
    for (const Vec3& v : value) total += glm::dvec3(v);
    return total;
}

/// One in A, two in B: a step of 1 at the seam.
void fill_step(TwoCharts& c) {
    c.fill([](uint32_t x, uint32_t) { return Vec3(TwoCharts::in_a(x) ? 1.0f : 2.0f); });
}

Vec3 noise(std::mt19937& random) {
    std::uniform_real_distribution<float> unit(1.0f, 3.0f);
    return {unit(random), unit(random), unit(random)};
}

// ---- solving ---------------------------------------------------------------------------------

TEST(Stitch, AStepVanishesAtTheSeam) {
    TwoCharts c;
    fill_step(c);
    ASSERT_NEAR(step(c), 1.0f, 1e-6f);
    EXPECT_EQ(c.stitch(), c.seam.size());
    // Where the seam goes straight on, each side moves by d: minimise n (1 - 2 d)^2 + 4 lambda d^2
    // for n = 3 points per texel. That leaves 1 - 2 d = lambda / (n + lambda) of the step.
    const SeamPoint& middle = c.seam[c.seam.size() / 2];
    EXPECT_NEAR(read(c.value, middle.b).x - read(c.value, middle.a).x, kLambda / (3.0 + kLambda), 0.003);
    EXPECT_LT(step(c), kAnywhere);
}

/// Minimises the same sum by solving its normal equations, in double and without iterations.
std::vector<double> least_squares(const TwoCharts& c, int channel) {
    const size_t n = c.value.size();
    std::vector<std::vector<double>> m(n, std::vector<double>(n + 1, 0.0));
    for (size_t i = 0; i < n; ++i) m[i][i] = kLambda, m[i][n] = kLambda * c.value[i][channel];
    for (const SeamPoint& p : c.seam)
        for (int j = 0; j < 8; ++j)
            for (int k = 0; k < 8; ++k) {
                const auto entry = [&](int e) {
                    return e < 4 ? std::pair(p.a.texel[e], p.a.weight[e])
                                 : std::pair(p.b.texel[e - 4], -p.b.weight[e - 4]);
                };
                m[entry(j).first][entry(k).first] += double(entry(j).second) * entry(k).second;
            }
    for (size_t i = 0; i < n; ++i) // symmetric and positive definite: no pivoting needed
        for (size_t r = i + 1; r < n; ++r) {
            const double f = m[r][i] / m[i][i];
            if (f == 0.0) continue;
            for (size_t k = i; k <= n; ++k) m[r][k] -= f * m[i][k];
        }
    std::vector<double> x(n);
    for (size_t i = n; i-- > 0;) {
        double right = m[i][n];
        for (size_t k = i + 1; k < n; ++k) right -= m[i][k] * x[k];
        x[i] = right / m[i][i];
    }
    return x;
}

TEST(Stitch, MinimisesWhatItClaims) {
    std::mt19937 random(1);
    TwoCharts c;
    c.fill([&](uint32_t, uint32_t) { return noise(random); });
    for (SeamPoint& p : c.seam) { // a seam that is slanted on B's side
        const float v = 2.0f + 12.0f * static_cast<float>(&p - c.seam.data()) / 36.0f;
        p.b = bilinear_tap(kPage, {20.3f + 0.4f * v, v});
    }
    const std::vector<double> expected[3] = {least_squares(c, 0), least_squares(c, 1), least_squares(c, 2)};
    c.stitch();
    for (size_t i = 0; i < c.value.size(); ++i)
        for (int channel = 0; channel < 3; ++channel) ASSERT_NEAR(c.value[i][channel], expected[channel][i], 5e-4) << i;
}

TEST(Stitch, TheSumOfAllTexelsStays) {
    // The weights of every seam point add to zero, so the best change adds to zero as well.
    std::mt19937 random(2);
    TwoCharts c;
    c.fill([&](uint32_t x, uint32_t) { return noise(random) * (TwoCharts::in_a(x) ? 1.0f : 2.0f); });
    const glm::dvec3 before = sum(c.value);
    c.stitch();
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(sum(c.value)[k] / before[k], 1.0, 1e-5);
}

TEST(Stitch, OnlyTexelsAtTheSeamMove) {
    TwoCharts c;
    fill_step(c);
    const std::vector<Vec3> before = c.value;
    c.stitch();
    for (uint32_t y = 0; y < 16; ++y)
        for (uint32_t x = 0; x < 32; ++x) {
            const bool near = (x == 9 || x == 10 || x == 19 || x == 20) && y >= 1 && y <= 14;
            EXPECT_EQ(near, c.value[TwoCharts::at(x, y)] != before[TwoCharts::at(x, y)]) << x << ' ' << y;
        }
}

TEST(Stitch, ChannelsAreIndependent) {
    TwoCharts c;
    c.fill([](uint32_t x, uint32_t) { return Vec3(0.25f, TwoCharts::in_a(x) ? 1.0f : 2.0f, 4.0f); });
    c.stitch();
    for (const SeamPoint& p : c.seam) {
        EXPECT_NEAR(read(c.value, p.a).x, 0.25f, 1e-6f);
        EXPECT_NEAR(read(c.value, p.a).y, 1.5f, 0.5f * kAnywhere);
        EXPECT_NEAR(read(c.value, p.a).z, 4.0f, 1e-5f);
    }
}

TEST(Stitch, NothingBecomesNegative) {
    TwoCharts c;
    c.fill([](uint32_t x, uint32_t) { return Vec3(x == 20 ? 10.0f : 0.0f); });
    c.stitch();
    for (const Vec3& v : c.value) EXPECT_GE(v.x, 0.0f);
    EXPECT_GT(c.value[TwoCharts::at(9, 7)].x, 0.0f);
}

TEST(Stitch, ValuesAtSomeTexelsMoveAsIfTheOthersWereZero) {
    TwoCharts all;
    all.fill([](uint32_t x, uint32_t y) { return y < 8 && x < 20 ? Vec3(x, 2.0f, y) : Vec3(0.0f); });
    std::vector<uint32_t> texel;
    std::vector<Vec3> value;
    for (uint32_t t = 0; t < all.value.size(); ++t)
        if (all.value[t] != Vec3(0.0f)) texel.push_back(t), value.push_back(all.value[t]);
    ASSERT_GT(texel.size(), 40u);
    SeamSolver(all.seam, all.usable).solve(texel, value, false);
    ASSERT_GT(all.stitch(), 0u);
    for (size_t i = 0; i < texel.size(); ++i) EXPECT_EQ(value[i], all.value[texel[i]]) << texel[i];
}

TEST(Stitch, SignedValuesMayStayNegative) {
    TwoCharts charts;
    const std::vector<uint32_t> texel{TwoCharts::at(10, 5), TwoCharts::at(10, 6)};
    std::vector<Vec3> value(2, Vec3(-1.0f));
    SeamSolver(charts.seam, charts.usable).solve(texel, value, true);
    for (const Vec3& v : value) EXPECT_LT(v.x, -0.1f);
}

TEST(Stitch, WithoutSeamsNothingChanges) {
    TwoCharts c;
    fill_step(c);
    const std::vector<Vec3> before = c.value;
    c.seam.clear();
    EXPECT_EQ(c.stitch(), 0u);
    EXPECT_EQ(c.value, before);
}

TEST(Stitch, SidesThatAgreeStay) {
    TwoCharts c;
    // Changes along the seam, but is the same on both sides of it.
    c.fill([](uint32_t, uint32_t y) { return Vec3(1.0f, 2.0f, 3.0f) * (1.0f + 0.1f * static_cast<float>(y)); });
    const std::vector<Vec3> before = c.value;
    EXPECT_EQ(c.stitch(), c.seam.size());
    for (size_t i = 0; i < before.size(); ++i)
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(c.value[i][k], before[i][k], 1e-5f * before[i][k]) << i;
}

TEST(Stitch, UnusableTexelsAreNeitherReadNorMoved) {
    TwoCharts c;
    fill_step(c);
    const uint32_t broken = TwoCharts::at(9, 7);
    c.usable[broken] = 0;
    c.value[broken] = Vec3(1e6f);
    const uint64_t used = c.stitch();
    EXPECT_EQ(c.value[broken], Vec3(1e6f));
    // Points between v = 6.5 and 8.5 read row 7: five of them.
    EXPECT_EQ(used, c.seam.size() - 5);
    for (size_t i = 0; i < c.value.size(); ++i) EXPECT_TRUE(i == broken || c.value[i].x <= 2.0f) << i;
    EXPECT_LT(std::abs(read(c.value, c.seam[0].a).x - read(c.value, c.seam[0].b).x), kAnywhere);
}

TEST(Stitch, UnusableTexelsOfNoWeightDoNotStandInTheWay) {
    TwoCharts c;
    fill_step(c);
    // Reads at texel centres: the other three texels have no weight.
    c.seam.assign(1, {bilinear_tap(kPage, {10.5f, 7.5f}), bilinear_tap(kPage, {19.5f, 7.5f})});
    c.value[TwoCharts::at(11, 7)] = c.value[TwoCharts::at(11, 8)] = Vec3(1e6f);
    EXPECT_EQ(c.stitch(), 1u);
    EXPECT_NEAR(c.value[TwoCharts::at(19, 7)].x - c.value[TwoCharts::at(10, 7)].x, kLambda / (2.0 + kLambda), 1e-4);
    EXPECT_EQ(c.value[TwoCharts::at(11, 7)], Vec3(1e6f));
    EXPECT_EQ(c.value[TwoCharts::at(11, 8)], Vec3(1e6f));
}

// ---- finding ---------------------------------------------------------------------------------

/// A floor cut at x = 1 into two charts, 10 x 12 texels each, whose second part may be folded up;
/// gap moves it away.
std::vector<SeamPoint> seams_of_floor(float fold, bool cut = true, float gap = 0.0f, bool second_page = false) {
    SnapshotKit kit;
    const uint32_t white = kit.material(Vec3(0.5f)), page = kit.page(32, 16),
                   other = second_page ? kit.page(32, 16) : page;
    const Vec2 size(10.0f / 32.0f, 12.0f / 16.0f), low(0.0f, 2.0f / 16.0f),
        right(cut ? 20.0f / 32.0f : 10.0f / 32.0f, 2.0f / 16.0f);
    kit.object(parallelogram({0, 0, 0}, {1, 0, 0}, {0, 1.2f, 0}), white,
               parallelogram_uv(low, {size.x, 0}, {0, size.y}), page);
    kit.object(parallelogram({1 + gap, 0, 0}, {std::cos(fold), 0, std::sin(fold)}, {0, 1.2f, 0}), white,
               parallelogram_uv(right, {size.x, 0}, {0, size.y}), other);
    return find_seams(kit.commit());
}

TEST(FindSeams, TheTwoSidesOfACutMeet) {
    const std::vector<SeamPoint> seams = seams_of_floor(0.0f);
    EXPECT_GE(seams.size(), 3u * 12u); // three per texel
    const TwoCharts expected;          // whose seam is the same: where u is 10 the other side's is 20
    std::vector<Vec3> place(kPage.width * kPage.height);
    for (uint32_t i = 0; i < place.size(); ++i) place[i] = Vec3(i % kPage.width, i / kPage.width, 0);
    for (const SeamPoint& p : seams) {
        const Vec3 a = read(place, p.a) + 0.5f, b = read(place, p.b) + 0.5f;
        EXPECT_NEAR(std::min(a.x, b.x), 10.0f, 1e-3f);
        EXPECT_NEAR(std::max(a.x, b.x), 20.0f, 1e-3f);
        EXPECT_NEAR(a.y, b.y, 1e-3f);
        EXPECT_GT(a.y, 2.0f);
        EXPECT_LT(a.y, 14.0f);
    }
}

TEST(FindSeams, TheirStitchedSidesAreEqual) {
    TwoCharts c;
    fill_step(c);
    c.seam = seams_of_floor(0.0f);
    ASSERT_FALSE(c.seam.empty());
    EXPECT_EQ(c.stitch(), c.seam.size());
    EXPECT_LT(step(c), kAnywhere);
}

TEST(FindSeams, SidesMayLieOnTwoPages) {
    const std::vector<SeamPoint> seams = seams_of_floor(0.0f, true, 0.0f, true);
    ASSERT_FALSE(seams.empty());
    for (const SeamPoint& p : seams) EXPECT_NE(p.a.texel[0] / (32 * 16), p.b.texel[0] / (32 * 16));
}

TEST(FindSeams, SmoothEdgesAreSeamsAndSharpOnesAreNot) {
    EXPECT_FALSE(seams_of_floor(glm::radians(8.0f)).empty());
    EXPECT_TRUE(seams_of_floor(glm::radians(12.0f)).empty());
    EXPECT_TRUE(seams_of_floor(glm::radians(90.0f)).empty());
}

TEST(FindSeams, WhatIsWholeInTheLightmapOrApartInSpaceIsNoSeam) {
    EXPECT_TRUE(seams_of_floor(0.0f, false).empty());
    EXPECT_TRUE(seams_of_floor(0.0f, true, 0.01f).empty());
}

TEST(BilinearTap, WeightsAddToOneAndReadLinearlyInside) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> x(0.5f, 31.5f), y(0.5f, 15.5f);
    std::vector<Vec3> place(kPage.width * kPage.height);
    for (uint32_t i = 0; i < place.size(); ++i) place[i] = Vec3(i % kPage.width, i / kPage.width, 1);
    for (int i = 0; i < 200; ++i) {
        const Vec2 p(x(random), y(random));
        const Vec3 v = read(place, bilinear_tap(kPage, p));
        EXPECT_NEAR(v.x, p.x - 0.5f, 1e-4f);
        EXPECT_NEAR(v.y, p.y - 0.5f, 1e-4f);
        EXPECT_NEAR(v.z, 1.0f, 1e-6f);
    }
    for (const Vec2& p : {Vec2(0, 0), Vec2(-3, 20), Vec2(32, 16)}) // clamped at the border
        EXPECT_NEAR(read(place, bilinear_tap(kPage, p)).z, 1.0f, 1e-6f);
    EXPECT_EQ(read(place, bilinear_tap(kPage, {40, 20})), Vec3(31, 15, 1));
}

} // namespace
} // namespace ajar
