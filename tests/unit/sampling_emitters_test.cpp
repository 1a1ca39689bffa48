// SPDX-License-Identifier: GPL-3.0-or-later
// Next-event estimation: what samples of emitters add up to, against closed forms.
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "base/hash.h"
#include "sampling/emitters.h"
#include "snapshot_kit.h"
#include "statistics.h"

namespace ajar {
namespace {

using Random = std::mt19937;
constexpr double kAlarm = 1e-4; ///< chance below which samples are said not to follow a density
constexpr uint32_t kNone = EmitterSet::kNone;
const Vec2 kMiddle(1.0f / 3.0f);

float unit(Random& random) { return unit_float(static_cast<uint32_t>(random())); }
Vec2 random_point(Random& random) { return {unit(random), unit(random)}; }
Vec3 random_direction(Random& random) {
    const float z = 2.0f * unit(random) - 1.0f, r = std::sqrt(1.0f - z * z), phi = 2.0f * kPi * unit(random);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

/// A scene and its emitters. The large black floor keeps every emitter below the share of the
/// scene's area from which it is left to the gather.
struct Lit {
    SnapshotKit kit;
    const Snapshot* scene = nullptr;
    ThreadPool pool{1};
    Progress progress;
    std::unique_ptr<EmitterSet> emitters;

    explicit Lit(bool floor = true) {
        if (floor) kit.object(parallelogram({-50, -50, -9}, {100, 0, 0}, {0, 100, 0}), kit.material(Vec3(0.0f)));
    }
    /// As if the scene had too many emissive triangles for each to be an emitter.
    EmitterSet& build(uint32_t singles = 1) {
        scene = &kit.commit();
        emitters = std::make_unique<EmitterSet>(*scene, pool, progress, singles);
        return *emitters;
    }
    /// Positions are given in the kit's space, the scene's are about its middle.
    Vec3 local(const Vec3& p) const { return Vec3(DVec3(p) - scene->origin); }
    std::array<Vec3, 3> corners(uint32_t t) const {
        return {scene->position(t, 0, 0), scene->position(t, 1, 0), scene->position(t, 0, 1)};
    }
};

/// Solid angle of a triangle seen from p (van Oosterom and Strackee 1983).
double solid_angle(const std::array<Vec3, 3>& triangle, const Vec3& p) {
    DVec3 v[3];
    for (int i = 0; i < 3; ++i) v[i] = glm::normalize(DVec3(triangle[i] - p));
    const double volume = glm::dot(v[0], glm::cross(v[1], v[2]));
    return std::abs(2.0 * std::atan2(volume, 1.0 + glm::dot(v[0], v[1]) + glm::dot(v[1], v[2]) + glm::dot(v[2], v[0])));
}

/// How far p is from lying in a triangle: area that its three connections add to the triangle's.
double outside(const std::array<Vec3, 3>& c, const Vec3& p) {
    double parts = -0.5 * glm::length(glm::cross(c[1] - c[0], c[2] - c[0]));
    for (int j = 0; j < 3; ++j) parts += 0.5 * glm::length(glm::cross(c[j] - p, c[(j + 1) % 3] - p));
    return parts;
}

/// Irradiance from a triangle of radiance 1, wholly above the horizon (Lambert).
double irradiance(const std::array<Vec3, 3>& triangle, const Vec3& p, const Vec3& n) {
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) {
        const DVec3 a = glm::normalize(DVec3(triangle[i] - p)), b = glm::normalize(DVec3(triangle[(i + 1) % 3] - p));
        sum += std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0)) * glm::dot(glm::normalize(glm::cross(a, b)), DVec3(n));
    }
    return 0.5 * std::abs(sum);
}

/// Mean over random samples of the irradiance that one emitter, or all of them, add.
kit::Sample sampled_irradiance(const EmitterSet& set, const std::vector<uint32_t>& emitters, const Vec3& p,
                               const Vec3& n, int count = 40000) {
    Random random(11);
    kit::Sample out;
    for (int i = 0; i < count; ++i) {
        double sum = 0.0;
        for (const uint32_t e : emitters) {
            const EmitterSample s = set.sample(e, p, random_point(random));
            sum += s.weight.x * std::max(0.0f, glm::dot(s.direction, n));
        }
        out.add(sum);
    }
    return out;
}

std::vector<uint32_t> all(const EmitterSet& set) {
    std::vector<uint32_t> out(set.count());
    for (uint32_t i = 0; i < out.size(); ++i) out[i] = i;
    return out;
}

/// A bent strip of 20 triangles above the floor; radiance 3 and 5 in turns.
void add_strip(Lit& lit) {
    const uint32_t dim = lit.kit.material(Vec3(0.5f), Vec3(3.0f)), bright = lit.kit.material(Vec3(0.5f), Vec3(5.0f));
    for (int i = 0; i < 10; ++i) {
        const float a = 0.2f * static_cast<float>(i), next = a + 0.2f, width = 0.1f + 0.05f * static_cast<float>(i % 3);
        const Vec3 low(std::sin(a), 0.0f, 2.0f - std::cos(a)), high(std::sin(next), 0.0f, 2.0f - std::cos(next));
        lit.kit.object(parallelogram(low, {0, width, 0}, high - low), i % 2 != 0 ? bright : dim);
    }
}

// ---- emissive triangles ----------------------------------------------------------------------

TEST(Emitters, EveryEmissiveTriangleHasOneEmitterAndOthersHaveNone) {
    Lit lit;
    add_strip(lit);
    const EmitterSet& set = lit.build();
    EXPECT_EQ(set.emissive_triangles(), 20u);
    EXPECT_GE(set.count(), 3u); // 20 triangles in clusters of at most 8
    std::vector<int> members(set.count(), 0);
    for (uint32_t t = 0; t < lit.scene->triangles.size(); ++t) {
        const bool emits = luminance(lit.scene->emission(t, 0.3f, 0.3f)) > 0.0f;
        EXPECT_EQ(set.emitter_of(t) != kNone, emits) << t;
        if (emits) ++members[set.emitter_of(t)];
    }
    for (const int count : members) {
        EXPECT_GE(count, 1);
        EXPECT_LE(count, 8);
    }
}

TEST(Emitters, FewTrianglesAreEmittersOfTheirOwn) {
    Lit few, many;
    add_strip(few);
    add_strip(many);
    EXPECT_EQ(few.build(20).count(), 20u);
    EXPECT_LT(many.build(10).count(), 15u);
}

TEST(Emitters, DensitiesAddToOnePerEmitter) {
    Lit lit;
    add_strip(lit);
    const EmitterSet& set = lit.build();
    std::vector<double> sum(set.count(), 0.0);
    for (uint32_t t = 0; t < lit.scene->triangles.size(); ++t)
        if (set.emitter_of(t) != kNone)
            sum[set.emitter_of(t)] += set.triangle_pdf(t, kMiddle, 1.0f, 1.0f) * lit.scene->area(t);
    for (const double s : sum) EXPECT_NEAR(s, 1.0, 1e-5);
    // Away from the triangle it turns into solid angle with distance^2 / cosine.
    for (uint32_t t = 0; t < lit.scene->triangles.size(); ++t)
        EXPECT_NEAR(set.emitter_of(t) != kNone
                        ? set.triangle_pdf(t, kMiddle, 3.0f, 0.5f) / set.triangle_pdf(t, kMiddle, 1.0f, 1.0f)
                        : 18.0,
                    18.0, 1e-4);
}

TEST(Emitters, SamplesLieOnTheirEmitterWithItsDensity) {
    Lit lit;
    add_strip(lit);
    const EmitterSet& set = lit.build();
    const Vec3 p = lit.local({0.3f, -0.4f, 1.9f});
    Random random(1);
    for (uint32_t e = 0; e < set.count(); ++e)
        for (int i = 0; i < 500; ++i) {
            const EmitterSample s = set.sample(e, p, random_point(random));
            ASSERT_GT(s.pdf, 0.0f);
            ASSERT_NEAR(glm::length(s.direction), 1.0f, 1e-5f);
            ASSERT_LT(glm::length(p + s.direction * s.distance - s.target), 1e-5f);
            bool found = false; // a triangle that holds the point and agrees with the sample
            for (uint32_t t = 0; t < lit.scene->triangles.size(); ++t) {
                if (set.emitter_of(t) != e || outside(lit.corners(t), s.target) > 1e-5) continue;
                const float cosine = std::abs(glm::dot(s.direction, lit.scene->geometric_normal(t)));
                const float radiance = lit.scene->emission(t, 0.3f, 0.3f).x;
                found |= std::abs(set.triangle_pdf(t, kMiddle, s.distance, cosine) / s.pdf - 1.0f) < 1e-3f &&
                         std::abs(s.weight.x * s.pdf / radiance - 1.0f) < 1e-3f;
            }
            ASSERT_TRUE(found) << e;
        }
}

TEST(Emitters, TrianglesAreChosenByTheirPower) {
    Lit lit;
    add_strip(lit);
    const EmitterSet& set = lit.build();
    const Vec3 p = lit.local({0.3f, -0.4f, 1.9f});
    Random random(2);
    constexpr int kCount = 50000;
    for (uint32_t e = 0; e < set.count(); ++e) {
        std::vector<uint32_t> members;
        double power = 0.0;
        for (uint32_t t = 0; t < lit.scene->triangles.size(); ++t)
            if (set.emitter_of(t) == e)
                members.push_back(t), power += lit.scene->area(t) * lit.scene->emission(t, 0.3f, 0.3f).x;
        std::vector<double> counts(members.size(), 0.0), expected;
        for (const uint32_t t : members)
            expected.push_back(kCount * lit.scene->area(t) * lit.scene->emission(t, 0.3f, 0.3f).x / power);
        for (int i = 0; i < kCount; ++i) {
            const EmitterSample s = set.sample(e, p, random_point(random));
            size_t nearest = 0;
            double best = 1e9;
            for (size_t k = 0; k < members.size(); ++k) {
                const double d = outside(lit.corners(members[k]), s.target);
                if (d < best) best = d, nearest = k;
            }
            ++counts[nearest];
        }
        EXPECT_GT(kit::chi_square_test(counts, expected), kAlarm) << e;
    }
}

TEST(Emitters, DensitiesIntegrateToOneOverTheDirections) {
    // The mean of 1 / pdf over an emitter's samples is the solid angle it fills.
    Lit lit;
    add_strip(lit);
    const EmitterSet& set = lit.build();
    const Vec3 p = lit.local({0.3f, -0.4f, 1.9f});
    Random random(3);
    for (uint32_t e = 0; e < set.count(); ++e) {
        double angle = 0.0;
        for (uint32_t t = 0; t < lit.scene->triangles.size(); ++t)
            if (set.emitter_of(t) == e) angle += solid_angle(lit.corners(t), p);
        kit::Sample inverse;
        for (int i = 0; i < 40000; ++i) inverse.add(1.0 / set.sample(e, p, random_point(random)).pdf);
        EXPECT_NEAR(inverse.mean(), angle, 4.5 * inverse.error()) << e;
    }
}

TEST(Emitters, SamplesAddUpToTheIrradiance) {
    Lit lit;
    add_strip(lit);
    const EmitterSet& set = lit.build();
    const Vec3 p = lit.local({0.8f, 0.1f, 0.5f}), n(0, 0, 1); // below the strip, all of it above the horizon
    double expected = 0.0;
    for (uint32_t t = 0; t < lit.scene->triangles.size(); ++t)
        if (set.emitter_of(t) != kNone)
            expected += lit.scene->emission(t, 0.3f, 0.3f).x * irradiance(lit.corners(t), p, n);
    const kit::Sample got = sampled_irradiance(set, all(set), p, n);
    EXPECT_NEAR(got.mean(), expected, 4.5 * got.error());
    EXPECT_LT(got.error(), 0.01 * expected);
}

TEST(Emitters, OneSidedTrianglesShineForwardOnly) {
    for (const bool one_sided : {true, false}) {
        Lit lit;
        lit.kit.object(parallelogram({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}),
                       lit.kit.material(Vec3(0.5f), Vec3(2.0f), one_sided)); // faces up
        const EmitterSet& set = lit.build();
        ASSERT_EQ(set.count(), 1u);
        const EmitterSample front = set.sample(0, lit.local({0.1f, 0.2f, 1}), {0.3f, 0.4f}),
                            back = set.sample(0, lit.local({0.1f, 0.2f, -1}), {0.3f, 0.4f});
        EXPECT_GT(front.weight.x, 0.0f);
        EXPECT_FLOAT_EQ(back.weight.x, one_sided ? 0.0f : front.weight.x);
    }
}

TEST(Emitters, WhatFillsTheSceneIsLeftToTheGather) {
    Lit lit(false);
    lit.kit.object(parallelogram({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), lit.kit.material(Vec3(0.5f), Vec3(2.0f)));
    lit.kit.object(parallelogram({0, 0, 2}, {1, 0, 0}, {0, 1, 0}), lit.kit.material(Vec3(0.5f)));
    const EmitterSet& set = lit.build();
    EXPECT_EQ(set.count(), 0u);
    EXPECT_EQ(set.emissive_triangles(), 2u);
    for (uint32_t t = 0; t < 4; ++t) EXPECT_EQ(set.emitter_of(t), kNone);
}

TEST(Emitters, DarkLampsAreNone) {
    Lit lit;
    lit.kit.light(lit.kit.lamp(AJAR_LIGHT_POINT, {0, 0, 1}, 0.0f));
    ajar_light_desc primary = lit.kit.lamp(AJAR_LIGHT_POINT, {0, 0, 1}, 10.0f);
    primary.role = AJAR_ROLE_PRIMARY;
    lit.kit.light(primary);
    lit.kit.light(lit.kit.lamp(AJAR_LIGHT_SUN, {0, 0, 1}, 10.0f));
    const EmitterSet& set = lit.build();
    ASSERT_EQ(set.count(), 2u);
    EXPECT_TRUE(set.is_primary(0));
    EXPECT_FALSE(set.is_primary(1));
    EXPECT_TRUE(set.is_lamp(1));
    EXPECT_EQ(set.sample(1, Vec3(0.0f), {0.5f, 0.5f}).pdf, 0.0f) << "rays never meet lamps";
}

// ---- image sky -------------------------------------------------------------------------------

TEST(Emitters, EverySampleOfTheSkyWeighsItsWholeLight) {
    // A thousand times brighter texel beside a dim one, so narrow that some directions round from
    // one into the other. A dim texel's density with the bright one's radiance is a firefly.
    constexpr uint32_t kWidth = 16384, kDim = 12000;
    std::vector<float> grey(kWidth * 2, 0.0f);
    for (const uint32_t row : {0u, kWidth}) grey[row + kDim] = 1.0f, grey[row + kDim + 1] = 1000.0f;
    Lit lit;
    lit.kit.sky(kWidth, 2, grey);
    const EmitterSet& set = lit.build();
    ASSERT_NE(set.sky_emitter(), kNone);
    const double total = 4.0 * kPi / kWidth * 1001.0;
    Random random(4);
    for (int i = 0; i < 20000; ++i) {
        const float within = i % 2 != 0 ? unit(random) : 1.0f - 0.01f * unit(random); // of the dim texel
        for (const float x : {within / 1001.0f, unit(random)}) {
            const EmitterSample s = set.sample(set.sky_emitter(), Vec3(0.0f), {x, unit(random)});
            ASSERT_NEAR(luminance(s.weight) / total, 1.0, 1e-3) << i;
            ASSERT_TRUE(std::isinf(s.distance));
        }
    }
}

TEST(Emitters, TheSkyAddsUpToItsIrradiance) {
    Lit lit;
    lit.kit.sky(8, 4, std::vector<float>(32, 2.0f));
    const EmitterSet& set = lit.build();
    const kit::Sample got = sampled_irradiance(set, {set.sky_emitter()}, Vec3(0.0f), {0.6f, 0.0f, 0.8f});
    EXPECT_NEAR(got.mean(), 2.0 * kPi, 4.5 * got.error());
}

// ---- bright texels ---------------------------------------------------------------------------

/// A whole bright texel about a point, on triangle 0.
BrightPatch bright_square(uint32_t texel, const Vec3& center, const Vec3& edge_x, const Vec3& edge_y,
                          const Vec3& normal, const Vec3& radiance) {
    BrightPatch p{texel, 0, {}, center - 0.5f * (edge_x + edge_y), edge_x, edge_y, normal, radiance, {}};
    for (const Vec2& c : {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)}) p.shape.corner[p.shape.count++] = c;
    return p;
}

/// A wall of 6 x 4 bright texels of edge 0.1, radiance by column, on page texels 100 and on.
std::vector<BrightPatch> bright_wall() {
    std::vector<BrightPatch> out;
    for (uint32_t y = 0; y < 4; ++y)
        for (uint32_t x = 0; x < 6; ++x)
            out.push_back(bright_square(100 + y * 16 + x,
                                        Vec3(0.1f * static_cast<float>(x), 0.0f, 0.1f * static_cast<float>(y)),
                                        {0.1f, 0, 0}, {0, 0, 0.1f}, {0, -1, 0}, Vec3(1.0f + static_cast<float>(x))));
    return out;
}

TEST(BrightTexels, DensitiesAddToOnePerEmitter) {
    Lit lit;
    lit.kit.page(16, 16);
    const EmitterSet set = lit.build().with_bright_texels(bright_wall());
    std::map<uint32_t, double> sum;
    for (const BrightPatch& t : bright_wall()) {
        float density = 0.0f;
        const uint32_t e = set.bright_emitter(t.texel, 0, density);
        ASSERT_LT(e, set.count());
        sum[e] += density * 0.01;
    }
    EXPECT_GE(sum.size(), 2u); // at most 16 share one
    for (const auto& [e, s] : sum) EXPECT_NEAR(s, 1.0, 1e-5) << e;
    float density;
    EXPECT_EQ(set.bright_emitter(0, 0, density), kNone);
    EXPECT_EQ(set.bright_emitter(bright_wall()[0].texel, 1, density), kNone) << "another triangle of the texel";
}

TEST(BrightTexels, SamplesAddUpToTheIrradiance) {
    Lit lit;
    lit.kit.page(16, 16);
    const EmitterSet& plain = lit.build();
    EXPECT_EQ(plain.count(), 0u);
    const EmitterSet set = plain.with_bright_texels(bright_wall());
    const Vec3 p(0.2f, -0.5f, 0.1f), n = glm::normalize(Vec3(0.2f, 1.0f, 0.1f));
    double expected = 0.0;
    for (const BrightPatch& t : bright_wall()) {
        const Vec3 a = t.origin, b = a + t.edge_x, c = b + t.edge_y, d = a + t.edge_y;
        expected += t.radiance.x * (irradiance({a, b, c}, p, n) + irradiance({a, c, d}, p, n));
    }
    const kit::Sample got = sampled_irradiance(set, all(set), p, n);
    EXPECT_NEAR(got.mean(), expected, 4.5 * got.error());
    EXPECT_LT(got.error(), 0.01 * expected);
    for (const uint32_t e : all(set))
        EXPECT_EQ(set.sample(e, {0.2f, 0.5f, 0.1f}, {0.5f, 0.5f}).pdf, 0.0f) << "shines backwards";
}

TEST(BrightTexels, TheDensityOfASampleIsThatOfItsTexel) {
    Lit lit;
    lit.kit.page(16, 16);
    const EmitterSet set = lit.build().with_bright_texels(bright_wall());
    const Vec3 p(0.2f, -0.5f, 0.1f);
    Random random(5);
    for (uint32_t e = 0; e < set.count(); ++e)
        for (int i = 0; i < 300; ++i) {
            const EmitterSample s = set.sample(e, p, random_point(random));
            const auto x = static_cast<uint32_t>(std::floor(s.target.x / 0.1f + 0.5f)),
                       y = static_cast<uint32_t>(std::floor(s.target.z / 0.1f + 0.5f));
            float density = 0.0f;
            ASSERT_EQ(set.bright_emitter(100 + y * 16 + x, 0, density), e);
            const float cosine = s.direction.y; // the wall's normal is -y
            ASSERT_NEAR(s.pdf / (density * s.distance * s.distance / cosine), 1.0f, 1e-3f);
        }
}

// ---- choosing among all of them --------------------------------------------------------------

/// Lamps of every kind, an emissive strip and a sky.
void add_everything(Lit& lit) {
    add_strip(lit);
    Random random(6);
    for (const uint32_t type :
         {AJAR_LIGHT_POINT, AJAR_LIGHT_SPOT, AJAR_LIGHT_SUN, AJAR_LIGHT_AREA_RECTANGLE, AJAR_LIGHT_AREA_ELLIPSE}) {
        ajar_light_desc d = lit.kit.lamp(type, 3.0f * Vec3(unit(random), unit(random), unit(random)),
                                         type == AJAR_LIGHT_SUN ? 2.0f : 50.0f);
        d.radius = type == AJAR_LIGHT_POINT ? 0.2f : 0.0f;
        d.spot_angle = 1.0f;
        d.sun_angle = 0.05f;
        lit.kit.light(d);
    }
    lit.kit.sky(8, 4, std::vector<float>(32, 0.3f));
}

/// No emitter whose importance is 0 may light a surface.
void expect_safe_importance(const EmitterSet& set, const Vec3& p, const Vec3& n, Random& random) {
    for (uint32_t e = 0; e < set.count(); ++e) {
        if (set.importance(e, p, n) > 0.0f) continue;
        for (int k = 0; k < 32; ++k) {
            const EmitterSample s = set.sample(e, p, random_point(random));
            ASSERT_FALSE(max_component(s.weight) > 0.0f && glm::dot(s.direction, n) > 1e-6f) << e;
        }
    }
}

TEST(Emitters, ImportanceIsZeroOnlyWhereNoSampleLights) {
    Lit lit;
    add_everything(lit);
    const EmitterSet& set = lit.build();
    Random random(7);
    for (int i = 0; i < 3000; ++i)
        expect_safe_importance(set, lit.local(6.0f * Vec3(unit(random), unit(random), unit(random)) - 2.0f),
                               random_direction(random), random);
}

TEST(Emitters, ImportanceOfSlightlyBentPanelsReachesBehindTheirPlane) {
    // Two quads that face up, tilted apart by 2.5 degrees each: each lights a little of what lies
    // below the plane of both, far to its side.
    Lit lit;
    const uint32_t glow = lit.kit.material(Vec3(0.5f), Vec3(2.0f), true);
    const float rise = std::tan(glm::radians(2.5f));
    lit.kit.object(parallelogram({0, 0, 0}, {0.1f, 0, -0.1f * rise}, {0, 0.1f, 0}), glow);
    lit.kit.object(parallelogram({-0.1f, 0, -0.1f * rise}, {0.1f, 0, 0.1f * rise}, {0, 0.1f, 0}), glow);
    const EmitterSet& set = lit.build();
    ASSERT_EQ(set.count(), 1u);
    Random random(8);
    for (int i = 0; i < 2000; ++i) {
        const float x = 20.0f * unit(random) - 10.0f;
        expect_safe_importance(set, lit.local({x, unit(random) - 0.5f, -0.05f * std::abs(x) * unit(random)}), {0, 0, 1},
                               random);
        expect_safe_importance(set, lit.local({x, unit(random) - 0.5f, -0.05f * std::abs(x) * unit(random)}),
                               {x < 0.0f ? 1.0f : -1.0f, 0, 0}, random);
    }
}

TEST(BrightTexels, ImportanceIsZeroOnlyWhereNoSampleLights) { // of a wall bent like a barrel
    Lit lit;
    lit.kit.page(16, 16);
    std::vector<BrightPatch> barrel;
    for (uint32_t i = 0; i < 6; ++i) {
        const float a = 0.06f * static_cast<float>(i);
        const Vec3 normal(std::sin(a), -std::cos(a), 0.0f), along(std::cos(a), std::sin(a), 0.0f);
        barrel.push_back(bright_square(100 + i, 1.7f * normal, 0.1f * along, {0, 0, 0.1f}, normal, Vec3(2.0f)));
    }
    const EmitterSet set = lit.build().with_bright_texels(barrel);
    ASSERT_LT(set.count(), 6u) << "nothing shares an emitter";
    Random random(9);
    for (int i = 0; i < 5000; ++i)
        expect_safe_importance(set, 12.0f * (Vec3(unit(random), unit(random), unit(random)) - 0.5f),
                               random_direction(random), random);
}

TEST(Emitters, PickingAnywhereIsUnbiased) {
    // Each emitter's share of 1 / chance is 1 in the mean, whatever the chances are.
    Lit lit;
    add_everything(lit);
    const EmitterSet& set = lit.build();
    for (const Vec3& place : {Vec3(0.5f, 0.2f, 0.4f), Vec3(2.5f, 2.0f, -1.0f)}) {
        const Vec3 p = lit.local(place), n(0, 0, 1);
        std::vector<kit::Sample> share(set.count());
        for (uint32_t i = 0; i < 400000; ++i) {
            float chance;
            const uint32_t chosen = set.pick_anywhere(p, n, hash_combine(1, i), chance);
            for (uint32_t e = 0; e < set.count(); ++e) share[e].add(e == chosen ? 1.0 / chance : 0.0);
        }
        for (uint32_t e = 0; e < set.count(); ++e) {
            const double wanted = set.importance(e, p, n) > 0.0f ? 1.0 : 0.0;
            EXPECT_NEAR(share[e].mean(), wanted, 4.5 * share[e].error()) << e;
        }
    }
}

TEST(Emitters, PickingAnywhereFindsTheLampsNearby) {
    // Of 144 equal lamps 8 m apart, all the light at a point near some of them by one pick: its relative deviation is
    // 1.9, 0.9 and 1.2 at these places; of picks that know nothing of the place 5.0, 2.4 and 3.8.
    Lit lit;
    for (int i = 0; i < 144; ++i)
        lit.kit.light(lit.kit.lamp(AJAR_LIGHT_POINT, Vec3(8 * (i % 12) - 44, 8 * (i / 12) - 44, 3), 50.0f));
    const EmitterSet& set = lit.build();
    const Vec3 n(0, 0, 1);
    for (const Vec3& place : {Vec3(4.5f, 3.2f, 1.0f), Vec3(-20.0f, 13.0f, -2.0f), Vec3(41.0f, -37.0f, 2.0f)}) {
        const Vec3 p = lit.local(place);
        double all = 0.0;
        for (uint32_t e = 0; e < set.count(); ++e) all += set.importance(e, p, n);
        kit::Sample found;
        for (uint32_t i = 0; i < 100000; ++i) {
            float chance;
            const uint32_t e = set.pick_anywhere(p, n, hash_combine(3, i), chance);
            found.add(e == kNone ? 0.0 : set.importance(e, p, n) / chance / all);
        }
        EXPECT_NEAR(found.mean(), 1.0, 4.5 * found.error());
        EXPECT_LT(found.error() * std::sqrt(found.count()), 2.0) << place.x;
    }
}

TEST(Emitters, PickingWhereNothingShinesFindsNothing) {
    Lit lit;
    float chance;
    EXPECT_EQ(lit.build().pick_anywhere(Vec3(0.0f), {0, 0, 1}, 1, chance), kNone);
}

} // namespace
} // namespace ajar
