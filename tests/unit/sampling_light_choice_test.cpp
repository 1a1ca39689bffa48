// SPDX-License-Identifier: GPL-3.0-or-later
// Choosing emitters per receiver: whatever the chances, they must add to one and be the ones used.
#include <gtest/gtest.h>

#include <random>

#include "base/hash.h"
#include "sampling/light_choice.h"
#include "snapshot_kit.h"

namespace ajar {
namespace {

using Random = std::mt19937;
constexpr uint32_t kReceivers = 5;

float unit(Random& random) { return unit_float(static_cast<uint32_t>(random())); }

/// What choosing needs to know of a scene.
struct Prepared {
    const Snapshot& scene;
    ThreadPool pool{1};
    Progress progress;
    EmitterSet emitters;
    Tracer tracer;
    LightmapReceivers receivers;

    explicit Prepared(const Snapshot& s) : scene(s), emitters(s, pool, progress), tracer(s) {}
    /// One more receiver that faces up.
    void stand_at(const DVec3& p) {
        receivers.texel.push_back(static_cast<uint32_t>(receivers.texel.size()));
        receivers.frame.push_back(Frame{});
        receivers.texel_size.push_back(0.1f);
        receivers.positions.push_back(Vec3(p - scene.origin));
    }
    /// For all receivers as one tile.
    LightChoice choice(LightRoles roles) const {
        LightChoice c(emitters, roles, emitters.of_set(kNoElement));
        c.begin(tracer, receivers, {0, static_cast<uint32_t>(receivers.texel.size())}, 5);
        return c;
    }
};

/// Lamps above a floor, some behind a wall, one of them primary; a glowing quad and a sky. The
/// receivers stand in a row on the floor.
struct Hall {
    SnapshotKit kit;
    Prepared at;
    uint32_t primary = EmitterSet::kNone;

    explicit Hall(uint32_t lamps) : at(fill(kit, lamps)) {
        for (uint32_t e = 0; e < at.emitters.count(); ++e)
            if (at.emitters.is_primary(e)) primary = e;
        for (uint32_t r = 0; r < kReceivers; ++r) at.stand_at({0.5 + r, 1.0, 0.001});
    }
    static const Snapshot& fill(SnapshotKit& kit, uint32_t lamps) {
        const uint32_t grey = kit.material(Vec3(0.5f));
        kit.object(parallelogram({-10, -10, 0}, {20, 0, 0}, {0, 20, 0}), grey);
        kit.object(parallelogram({0, -10, 0.01f}, {0, 20, 0}, {0, 0, 6}), grey); // wall at x = 0
        kit.object(parallelogram({3, 3, 4}, {0, 0.5f, 0}, {0.5f, 0, 0}),
                   kit.material(Vec3(0.5f), Vec3(9.0f))); // faces down
        Random random(1);
        for (uint32_t i = 0; i < lamps; ++i) {
            const Vec3 p(16.0f * unit(random) - 8.0f, 16.0f * unit(random) - 8.0f, 1.0f + 4.0f * unit(random));
            ajar_light_desc d = kit.lamp(AJAR_LIGHT_POINT, p, std::exp(4.0f * unit(random)));
            d.role = i == 7 ? AJAR_ROLE_PRIMARY : AJAR_ROLE_STATIC;
            kit.light(d);
        }
        kit.sky(4, 2, std::vector<float>(8, 0.2f));
        return kit.commit();
    }
};

/// More lamps than are weighed for every receiver, and few.
constexpr uint32_t kLampCounts[] = {60, 3};

TEST(LightChoice, ChancesAddToOne) {
    for (const uint32_t lamps : kLampCounts) {
        Hall hall(lamps);
        for (const LightRoles roles : {LightRoles::all, LightRoles::stored}) {
            const LightChoice choice = hall.at.choice(roles);
            ASSERT_FALSE(choice.empty());
            for (uint32_t local = 0; local < kReceivers; ++local) {
                double sum = 0.0;
                for (uint32_t e = 0; e < hall.at.emitters.count(); ++e) sum += choice.chance(local, e);
                EXPECT_NEAR(sum, 1.0, 1e-5) << lamps << ' ' << local;
            }
        }
    }
}

TEST(LightChoice, EveryLightThatReachesAReceiverHasAChance) {
    Hall hall(60);
    const LightChoice choice = hall.at.choice(LightRoles::all);
    for (uint32_t local = 0; local < kReceivers; ++local)
        for (uint32_t e = 0; e < hall.at.emitters.count(); ++e)
            EXPECT_TRUE(choice.chance(local, e) > 0.0f ||
                        hall.at.emitters.importance(e, hall.at.receivers.origins(local)[0], {0, 0, 1}) == 0.0f)
                << e;
}

/// A tile whose receivers lie in two rooms: most near many strong lamps, a few near one weak lamp.
TEST(LightChoice, AWeakLampHasItsShareWhereItIsTheNearest) {
    SnapshotKit kit;
    const uint32_t grey = kit.material(Vec3(0.5f));
    kit.object(parallelogram({-10, -10, 0}, {120, 0, 0}, {0, 20, 0}), grey);
    kit.object(parallelogram({50, -10, 0.01f}, {0, 20, 0}, {0, 0, 6}), grey);
    for (int i = 0; i < 40; ++i) kit.light(kit.lamp(AJAR_LIGHT_POINT, Vec3(float(i % 8), float(i / 8), 2.5f), 1000.0f));
    kit.light(kit.lamp(AJAR_LIGHT_POINT, Vec3(100.0f, 0.0f, 1.0f), 2.0f));
    Prepared two(kit.commit());
    constexpr uint32_t kCount = 256, kFew = 12;
    for (uint32_t r = 0; r < kCount; ++r)
        two.stand_at({r < kCount - kFew ? 8.0 * r / kCount : 100.0 + 0.05 * r / kCount, 1.0, 0.001});
    const LightChoice choice = two.choice(LightRoles::stored);
    const uint32_t weak = 40;
    EXPECT_LT(choice.chance(0, weak), 0.05f);
    for (uint32_t r = kCount - kFew; r < kCount; ++r) EXPECT_GT(choice.chance(r, weak), 0.02f) << r;
}

TEST(LightChoice, ExpectsTheUnshadowedLightOfWhatItSees) {
    SnapshotKit kit;
    kit.object(parallelogram({-10, -10, 0}, {20, 0, 0}, {0, 20, 0}), kit.material(Vec3(0.5f)));
    kit.light(kit.lamp(AJAR_LIGHT_POINT, {1.0f, 1.0f, 2.0f}, 10.0f));
    Prepared floor(kit.commit());
    for (uint32_t r = 0; r < kReceivers; ++r) floor.stand_at({r, 1.0, 0.001});
    LightChoice choice = floor.choice(LightRoles::all);
    choice.start_at(2);
    for (uint32_t r = 0; r < kReceivers; ++r) {
        const float unshadowed = floor.emitters.importance(0, floor.receivers.positions[r], Vec3(0, 0, 1));
        EXPECT_NEAR(choice.expected_light(r), unshadowed, 0.05f * unshadowed) << "receivers count from the first";
    }
}

TEST(LightChoice, PrimaryLampsAreNotStored) {
    Hall hall(60);
    ASSERT_NE(hall.primary, EmitterSet::kNone);
    const LightChoice all = hall.at.choice(LightRoles::all), stored = hall.at.choice(LightRoles::stored);
    EXPECT_GT(all.chance(0, hall.primary), 0.0f);
    EXPECT_EQ(stored.chance(0, hall.primary), 0.0f);
}

TEST(LightChoice, PicksHaveTheirChanceAndReuseTheirNumber) {
    // Equally spaced numbers instead of random ones: every emitter gets its share to within the
    // spacing, and what is left of the numbers is equally spaced again.
    constexpr uint32_t kCount = 1 << 18;
    for (const uint32_t lamps : kLampCounts) {
        Hall hall(lamps);
        const LightChoice choice = hall.at.choice(LightRoles::stored);
        for (uint32_t local = 0; local < kReceivers; local += 2) {
            std::vector<std::vector<float>> rest(hall.at.emitters.count());
            for (uint32_t i = 0; i < kCount; ++i) {
                float u = (static_cast<float>(i) + 0.5f) / kCount, chance;
                const uint32_t e = choice.pick(local, u, chance);
                ASSERT_LT(e, rest.size());
                ASSERT_EQ(chance, choice.chance(local, e)) << e;
                ASSERT_GE(u, 0.0f);
                ASSERT_LT(u, 1.0f);
                rest[e].push_back(u);
            }
            for (uint32_t e = 0; e < rest.size(); ++e) {
                const double share = double(rest[e].size()) / kCount, chance = choice.chance(local, e);
                EXPECT_NEAR(share, chance, 2.0 / kCount) << lamps << ' ' << local << ' ' << e;
                for (size_t i = 0; i < rest[e].size(); ++i) { // in ascending order, as they came
                    const double even = (double(i) + 0.5) / double(rest[e].size());
                    ASSERT_NEAR(rest[e][i], even, 2.0 / double(rest[e].size()) + 1e-6 / chance)
                        << lamps << ' ' << local << ' ' << e;
                }
            }
        }
    }
}

TEST(LightChoice, TheEndsOfTheUnitIntervalAreSafe) {
    for (const uint32_t lamps : kLampCounts) {
        Hall hall(lamps);
        const LightChoice choice = hall.at.choice(LightRoles::stored);
        for (const float end : {0.0f, 0x1.fffffep-1f}) {
            float u = end, chance = 0.0f;
            EXPECT_LT(choice.pick(0, u, chance), hall.at.emitters.count());
            EXPECT_GT(chance, 0.0f);
        }
    }
}

TEST(LightChoice, SamplesAddUpToEveryLightTogether) {
    // Unshadowed irradiance: one sample of one emitter over its chance, against all emitters'.
    Hall hall(60);
    const LightChoice choice = hall.at.choice(LightRoles::stored);
    const Vec3 p = hall.at.receivers.origins(2)[0], n(0, 0, 1);
    constexpr int kCount = 200000, kEach = 4000;
    const auto light = [&](uint32_t e, const Vec2& u) {
        const EmitterSample s = hall.at.emitters.sample(e, p, u);
        return double(s.weight.x) * std::max(0.0f, glm::dot(s.direction, n));
    };
    Random random(2);
    double expected = 0.0, sum = 0.0, squares = 0.0;
    for (uint32_t e = 0; e < hall.at.emitters.count(); ++e)
        for (int i = 0; i < kEach && e != hall.primary; ++i) expected += light(e, {unit(random), unit(random)}) / kEach;
    for (int i = 0; i < kCount; ++i) {
        float u = unit(random), chance;
        const uint32_t e = choice.pick(2, u, chance);
        const double v = light(e, {u, unit(random)}) / chance;
        sum += v / kCount;
        squares += v * v / kCount;
    }
    const double error = std::sqrt((squares - sum * sum) / kCount);
    EXPECT_NEAR(sum, expected, 4.5 * error + 0.002 * expected);
    EXPECT_LT(error, 0.01 * expected);
}

TEST(LightChoice, LampsBehindTheWallAreRarelyAsked) {
    Hall hall(60);
    const LightChoice choice = hall.at.choice(LightRoles::stored);
    double hidden = 0.0;
    for (uint32_t i = 0; i < hall.at.scene.lights.size(); ++i)
        if (hall.at.scene.lights[i].position.x + hall.at.scene.origin.x < 0.0) hidden += choice.chance(2, i);
    EXPECT_LT(hidden, 0.1); // half of all lamps are there
    EXPECT_GT(hidden, 0.0);
}

TEST(LightChoice, WithoutLightsThereIsNothingToPick) {
    SnapshotKit kit;
    kit.object(parallelogram({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), kit.material(Vec3(0.5f)));
    Prepared unlit(kit.commit());
    unlit.stand_at({0.0, 0.0, 0.001});
    EXPECT_TRUE(unlit.choice(LightRoles::all).empty());
}

} // namespace
} // namespace ajar
