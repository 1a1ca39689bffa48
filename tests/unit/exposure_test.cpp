// SPDX-License-Identifier: GPL-3.0-or-later
// The unit of packed irradiance, against what R11G11B10F can hold.
#include "package/exposure.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ajar {
namespace {

Snapshot with_elements(std::initializer_list<ElementKind> kinds) {
    Snapshot s;
    s.name = "scene";
    for (const ElementKind kind : kinds) {
        s.elements.emplace_back();
        s.elements.back().kind = kind;
    }
    return s;
}

std::vector<float> range(float low, float high, int count) {
    std::vector<float> out;
    for (int i = 0; i < count; ++i)
        out.push_back(low * std::pow(high / low, static_cast<float>(i) / static_cast<float>(count - 1)));
    return out;
}

TEST(Exposure, OrdinaryLightIsStoredAsItIs) {
    const Snapshot s = with_elements({});
    EXPECT_EQ(choose_scale(s, range(1e-6f, 0.0625f, 100)), 1.0f);
    EXPECT_EQ(choose_scale(s, range(1e-3f, 64000.0f, 100)), 1.0f);
    EXPECT_EQ(choose_scale(s, std::vector<float>(10, 0.0f)), 1.0f);
}

TEST(Exposure, AFewHotTexelsDoNotChangeTheUnitAndAreNamed) {
    Snapshot s = with_elements({});
    std::vector<float> light(5000, 3.0f);
    light[7] = 1e9f;
    EXPECT_EQ(choose_scale(s, light), 1.0f);
    s.instances.resize(2);
    s.instances[0].name = "wall", s.instances[1].name = "floor";
    s.triangles.resize(2);
    s.triangles[0].instance = 0, s.triangles[1].instance = 1;
    LightmapReceivers receivers;
    receivers.texel = {3, 7};
    receivers.triangle = {0, 1};
    const auto warnings = exposure_warnings(s, receivers, light, 1.0f);
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_EQ(warnings[0].culprit, "floor");
    EXPECT_NE(warnings[0].text.find("1 texels are brighter"), std::string::npos) << warnings[0].text;
}

TEST(Exposure, DimAndBrightScenesKeepTheirDigits) {
    const Snapshot s = with_elements({});
    for (const float top : {1e-30f, 1e-10f, 1e-6f, 1e-3f, 0.06f, 1e5f, 1e10f, 1e30f, 3e38f}) {
        const std::vector<float> light = range(top * 1e-2f, top, 100);
        const float scale = choose_scale(s, light);
        EXPECT_EQ(std::ldexp(1.0f, std::ilogb(scale)), scale);
        for (const float v : light) {
            const Vec3 stored = unpack_r11g11b10f(pack_r11g11b10f(Vec3(v) / scale)) * scale;
            EXPECT_NEAR(stored.x / v, 1.0f, 0x1p-7f) << top;
            EXPECT_NEAR(stored.z / v, 1.0f, 0x1p-6f) << top;
        }
    }
}

TEST(Exposure, ALightSetCanStillBeTurnedUpToAWattPerSquareMetre) {
    const Snapshot s = with_elements({ElementKind::light_set});
    for (const float top : {1e-12f, 1e-7f, 1e-4f}) EXPECT_LT(1.0f / choose_scale(s, {top}), kLargestPacked);
    for (const float top : {1e7f, 1e12f}) EXPECT_GE(1.0f / choose_scale(s, {top}), 0x1p-15f);
    EXPECT_LT(choose_scale(with_elements({ElementKind::door}), {1e-12f}), 1e-10f);
}

TEST(Exposure, TermsCountAsTheyStart) {
    Snapshot s = with_elements({ElementKind::light_set, ElementKind::light_set});
    s.elements[0].weight = 3.0f;
    s.elements[1].weight = 0.0f;
    BakedPages pages;
    pages.irradiance.assign(2, Vec3(1.0f));
    pages.terms.resize(2);
    pages.terms[0] = {{0}, false, 0, 0, {1}, {Vec3(2.0f)}, {0}};
    pages.terms[1] = {{1}, false, 0, 0, {1}, {Vec3(10.0f, 0.0f, 0.0f)}, {0}};
    EXPECT_EQ(brightest_light(s, pages), (std::vector<float>{1.0f, 17.0f}));
}

} // namespace
} // namespace ajar
