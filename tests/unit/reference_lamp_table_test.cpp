// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "reference/lamp_table.h"

namespace ajar {
namespace {

constexpr int kDraws = 20000;

Light lamp(Light::Type type, const Vec3& position, float intensity) {
    Light l;
    l.type = type;
    l.position = position;
    l.axis = {0, 0, -1};
    l.intensity = Vec3(intensity);
    l.area = 1.0f;
    return l;
}

TEST(LampTable, LampsComeAsOftenAsTheirChancesSay) {
    LampTable table;
    table.add(10, lamp(Light::Type::point, {0, 0, 2}, 1), 1);
    table.add(11, lamp(Light::Type::point, {0, 0, 1}, 1), 0.5f);
    table.add(12, lamp(Light::Type::sun, {0, 0, 0}, 0.25f), 1);
    table.add(13, lamp(Light::Type::point, {0, 0, -1}, 1), 1); // behind the surface
    Pcg random(1, 2);
    int seen[4] = {};
    float chance[4] = {};
    for (int i = 0; i < kDraws; ++i) {
        const LampTable::Choice c = table.choose({0, 0, 0}, {0, 0, 1}, random);
        ++seen[c.number - 10];
        chance[c.number - 10] = c.chance;
        EXPECT_EQ(c.weight, c.number == 11 ? 0.5f : 1.0f);
    }
    // Irradiance 1/4, 1/2, 1/4 and 0 share nine tenths; the rest goes to all alike.
    const float expected[] = {0.25f, 0.475f, 0.25f, 0.025f};
    for (int k = 0; k < 4; ++k) {
        EXPECT_NEAR(chance[k], expected[k], 1e-5f);
        EXPECT_NEAR(seen[k], expected[k] * kDraws, 5.0 * std::sqrt(expected[k] * kDraws)) << k;
    }
}

TEST(LampTable, PlacesInsideLampsAndFarAwayStayFinite) {
    LampTable table;
    table.add(0, lamp(Light::Type::point, {0, 0, 0}, 1), 1);
    table.add(1, lamp(Light::Type::point, {1e13f, 0, 0}, 1e30f), 1);
    Pcg random(1, 2);
    for (const Vec3& p : {Vec3(0, 0, 0), Vec3(1e13f, 0, 0), Vec3(-1e13f, 0, 1e13f)})
        for (int i = 0; i < 100; ++i) {
            const float chance = table.choose(p, {0, 0, 1}, random).chance;
            EXPECT_GE(chance, 0.05f - 1e-6f);
            EXPECT_LE(chance, 1.0f);
        }
}

} // namespace
} // namespace ajar
