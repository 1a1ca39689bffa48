// SPDX-License-Identifier: GPL-3.0-or-later
// AHD lightmaps (algorithms.md 1): what is exact by construction, and the degenerate cases.
#include <gtest/gtest.h>

#include <limits>

#include "encode/ahd.h"
#include "synthetic_light.h"

namespace ajar {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
const Vec3 kUp(0, 0, 1);

/// Light and its fit, for irradiance of a given colour.
struct Fitted {
    SyntheticLight light;
    Vec3 irradiance;
    Ahd ahd;
};

Fitted fit(const SyntheticLight& light, const Vec3& color = Vec3(1.0f)) {
    const Vec3 irradiance = color * static_cast<float>(light.irradiance(kUp) / luminance(color));
    return {light, irradiance, fit_ahd(irradiance, light.sh().data())};
}

/// As the game reads it: both words unpacked.
Ahd stored(const Ahd& a) {
    return unpack_direction(pack_direction(a), unpack_r11g11b10f(pack_r11g11b10f(a.irradiance)));
}

/// A few distant lamps of any strength over six decades.
SyntheticLight random_lamps(Random& random) {
    SyntheticLight light;
    const int count = 1 + static_cast<int>(uniform(random, 0.0, 5.0));
    const double level = std::pow(10.0, uniform(random, -2.0, 4.0));
    for (int i = 0; i < count; ++i) {
        light.direction.push_back(direction_between(random, 0.05, 1.0));
        light.power.push_back(level * uniform(random, 0.1, 1.0));
    }
    return light;
}

void expect_close(const Vec3& a, const Vec3& b, double relative) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], relative * b[c]) << c;
}

// ---- exact by construction -------------------------------------------------------------------

TEST(EncodeAhd, IrradianceAlongTheNormalIsExactToStoragePrecision) {
    Random random(1);
    for (int i = 0; i < 400; ++i) {
        const Vec3 color(uniform(random, 0.1, 1.0), uniform(random, 0.1, 1.0), uniform(random, 0.1, 1.0));
        const Fitted f = fit(random_lamps(random), color);
        EXPECT_EQ(f.ahd.irradiance, f.irradiance);
        expect_close(decode_ahd(f.ahd, kUp), f.irradiance, 1e-6);
        const Vec3 read = decode_ahd(stored(f.ahd), kUp);
        EXPECT_NEAR(read.x, f.irradiance.x, 0.00782 * f.irradiance.x);
        EXPECT_NEAR(read.y, f.irradiance.y, 0.00782 * f.irradiance.y);
        EXPECT_NEAR(read.z, f.irradiance.z, 0.0155 * f.irradiance.z);
        // All of that error is the irradiance's own: direction and ratio add none.
        expect_close(read, unpack_r11g11b10f(pack_r11g11b10f(f.irradiance)), 1e-6);
    }
}

TEST(EncodeAhd, FittedTexelsAreWithinTheirRanges) {
    Random random(2);
    for (int i = 0; i < 400; ++i) {
        const Ahd a = fit(random_lamps(random)).ahd;
        EXPECT_NEAR(glm::length(a.direction), 1.0f, 1e-5f);
        EXPECT_GE(a.direction.z, kAhdMinHeight - 1e-6f);
        EXPECT_GE(a.ratio, 0.0f);
        EXPECT_LE(a.ratio, 1.0f);
    }
}

TEST(EncodeAhd, FilteredTexelsKeepTheFilteredIrradiance) {
    Random random(3);
    for (int i = 0; i < 200; ++i) {
        const float tx = static_cast<float>(uniform(random)), ty = static_cast<float>(uniform(random));
        const float weight[4] = {(1 - tx) * (1 - ty), tx * (1 - ty), (1 - tx) * ty, tx * ty};
        Ahd mixed{Vec3(0.0f), 0.0f, Vec3(0.0f)};
        for (const float w : weight) {
            const Ahd a = stored(fit(random_lamps(random), {1.0f, 0.5f, 0.25f}).ahd);
            mixed.irradiance += w * a.irradiance;
            mixed.ratio += w * a.ratio;
            mixed.direction += w * a.direction;
        }
        expect_close(decode_ahd(mixed, kUp), mixed.irradiance, 2e-6);
    }
}

TEST(EncodeAhd, DirectionsThatOpposeEachOtherDoNotBrightenTheirMiddle) { // algorithms.md 1.2
    const Ahd left{Vec3(0.536f), 0.1f / 0.536f, {-0.9f, 0.0f, 0.4359f}},
        right{Vec3(0.536f), 0.1f / 0.536f, {0.9f, 0.0f, 0.4359f}};
    const Ahd middle{Vec3(0.536f), left.ratio, 0.5f * (left.direction + right.direction)};
    EXPECT_NEAR(decode_ahd(middle, kUp).x, 0.536f, 1e-6f);
}

TEST(EncodeAhd, PackedDirectionIsWithinHalfAStep) {
    Random random(4);
    for (int i = 0; i < 400; ++i) {
        const Ahd a{Vec3(1.0f), static_cast<float>(uniform(random)), Vec3(direction_between(random, 0.2, 1.0))};
        const Ahd b = unpack_direction(pack_direction(a), a.irradiance);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(b.direction[c], a.direction[c], 1.0f / 255.0f + 1e-6f);
        EXPECT_NEAR(b.ratio, a.ratio, 0.5f / 255.0f + 1e-6f);
    }
    const uint32_t packed = pack_direction({Vec3(1.0f), 0.2f, {1.0f, -1.0f, 0.0f}}); // R in the lowest byte
    EXPECT_EQ(packed & 0xffffu, 0x00ffu);
    EXPECT_EQ(packed >> 24, 51u);
}

// ---- degenerate cases (algorithms.md 1.6) ----------------------------------------------------

TEST(EncodeAhd, NoLightIsStoredAsAmbientAlongZ) {
    Random random(5);
    const auto sh = random_lamps(random).sh();
    for (const Vec3& dark : {Vec3(0.0f), Vec3(-1.0f), Vec3(kNan)}) {
        const Ahd a = fit_ahd(dark, sh.data());
        EXPECT_EQ(a.ratio, 1.0f);
        EXPECT_EQ(a.direction, kUp);
    }
    EXPECT_EQ(decode_ahd(stored(fit_ahd(Vec3(0.0f), sh.data())), {0.6f, 0.0f, 0.8f}), Vec3(0.0f));
}

TEST(EncodeAhd, HarmonicsThatAreNotFiniteFallBackToAmbient) {
    for (const float bad : {kNan, kInf, -kInf})
        for (int c = 0; c < kShCount; ++c) {
            float sh[kShCount] = {1.0f, 0.1f, 0.5f, 0.1f};
            sh[c] = bad;
            const Ahd a = fit_ahd({1.0f, 2.0f, 3.0f}, sh);
            EXPECT_EQ(a.ratio, 1.0f) << c;
            EXPECT_EQ(a.direction, kUp) << c;
            EXPECT_EQ(a.irradiance, Vec3(1.0f, 2.0f, 3.0f)) << c;
        }
}

TEST(EncodeAhd, LightFromEverywhereIsAmbientAlongZ) {
    // Radiance 1 over the whole sphere: pi on every normal.
    float sh[kShCount] = {2.0f * std::sqrt(kPi)};
    const Ahd a = fit_ahd(Vec3(kPi), sh);
    EXPECT_EQ(a.direction, kUp);
    EXPECT_EQ(pack_direction(a) >> 24, 255u);
    for (const Vec3& n : {kUp, Vec3(0.6f, 0.0f, 0.8f), Vec3(0.0f, -0.8f, 0.6f)})
        expect_close(decode_ahd(a, n), Vec3(kPi), 1e-3);
}

TEST(EncodeAhd, UniformSkyIsHalfAmbientAlongZ) {
    // E(n) = pi L (1 + n.z) / 2, which AHD holds exactly: ratio 1/2, direction z. What is left is
    // the error of nine coefficients for half a sphere, up to a hundredth of the irradiance.
    const Ahd a = fit(quadrature([](const DVec3&) { return 1.0; })).ahd;
    EXPECT_NEAR(a.ratio, 0.5f, 0.02f);
    EXPECT_GT(a.direction.z, std::cos(0.02f));
    for (const float z : {1.0f, 0.866f, 0.5f})
        EXPECT_NEAR(decode_ahd(a, {std::sqrt(1.0f - z * z), 0.0f, z}).x, kPi * 0.5f * (1.0f + z), 0.01f * kPi);
}

TEST(EncodeAhd, GrazingLightIsLiftedToTheLeastHeightAndKeepsItsAzimuth) {
    for (const float degrees : {2.0f, 5.0f, 9.0f})
        for (int k = 0; k < 16; ++k) {
            const float elevation = glm::radians(degrees), phi = glm::radians(22.5f * static_cast<float>(k) + 4.0f);
            const DVec3 w(std::cos(elevation) * std::cos(phi), std::cos(elevation) * std::sin(phi),
                          std::sin(elevation));
            const Ahd a = fit({{w}, {1.0}}).ahd;
            EXPECT_NEAR(a.direction.z, std::max(kAhdMinHeight, std::sin(elevation)), 0.006f) << degrees << ' ' << k;
            EXPECT_NEAR(std::remainder(std::atan2(a.direction.y, a.direction.x) - phi, 2.0f * kPi), 0.0f, 0.06f)
                << degrees << ' ' << k;
        }
}

TEST(EncodeAhd, OneLampIsFoundAndIsNoAmbient) {
    // Its E(n) = I max(0, n.w) is AHD with ratio 0; nine coefficients blur it by some degrees.
    Random random(6);
    for (int i = 0; i < 100; ++i) {
        const DVec3 w = direction_between(random, 0.35, 1.0);
        const Ahd a = fit({{w}, {3.0}}).ahd;
        EXPECT_GT(glm::dot(DVec3(a.direction), w), std::cos(glm::radians(8.0))) << w.z;
        EXPECT_LT(a.ratio, 0.1f) << w.z;
    }
}

} // namespace
} // namespace ajar
