// SPDX-License-Identifier: GPL-3.0-or-later
// Importance sampling of image skies. Texel solid angles and the mapping are written out here
// again, from Blender's definition: u = 0.5 - atan2(y, x) / 2 pi, v = 0.5 + asin(z) / pi.
#include <gtest/gtest.h>

#include <random>

#include "base/hash.h"
#include "sampling/sky_sampler.h"
#include "statistics.h"

namespace ajar {
namespace {

using Random = std::mt19937;
constexpr double kAlarm = 1e-4; ///< chance below which samples are said not to follow the density

Vec2 random_point(Random& random) {
    return {unit_float(static_cast<uint32_t>(random())), unit_float(static_cast<uint32_t>(random()))};
}

/// Radiance grey[y * width + x] times color, bottom row first.
Sky image_sky(uint32_t width, uint32_t height, const std::vector<float>& grey, const Vec3& color = Vec3(1.0f)) {
    Sky sky;
    sky.present = sky.has_image = true;
    sky.color = color;
    sky.image.width = width;
    sky.image.height = height;
    for (const float g : grey) sky.image.floats.insert(sky.image.floats.end(), {g, g, g, 1.0f});
    return sky;
}

/// A sky of 16 x 8 texels with everything that occurs: grey of any level, black, a sun.
std::vector<float> mixed_texels() {
    Random random(1);
    std::vector<float> grey(16 * 8);
    for (float& g : grey) g = std::max(0.0f, 2.0f * unit_float(static_cast<uint32_t>(random())) - 0.5f);
    for (int x = 0; x < 16; ++x) grey[3 * 16 + x] = 0.0f;
    grey[6 * 16 + 11] = 1e3f;
    return grey;
}

double solid_angle(uint32_t y, uint32_t width, uint32_t height) {
    const double low = (double(y) / height - 0.5) * kPi, high = (double(y + 1) / height - 0.5) * kPi;
    return 2.0 * kPi / width * (std::sin(high) - std::sin(low));
}

/// Place in the image in texels.
glm::dvec2 place(const Vec3& w, const Sky& sky) {
    const double u = 0.5 - std::atan2(double(w.y), double(w.x)) / (2.0 * kPi),
                 v = 0.5 + std::asin(std::clamp(double(w.z), -1.0, 1.0)) / kPi;
    return {u * sky.image.width, v * sky.image.height};
}

Vec3 texel_direction(double x, double y, const Sky& sky) {
    const double phi = (0.5 - x / sky.image.width) * 2.0 * kPi, latitude = (y / sky.image.height - 0.5) * kPi;
    return {std::cos(latitude) * std::cos(phi), std::cos(latitude) * std::sin(phi), std::sin(latitude)};
}

TEST(SkySampler, DensityIntegratesToOne) {
    const std::vector<float> grey = mixed_texels();
    const Sky sky = image_sky(16, 8, grey, {0.2f, 0.7f, 2.0f});
    const SkySampler sampler(sky);
    double density = 0.0, light = 0.0;
    for (uint32_t y = 0; y < 8; ++y)
        for (uint32_t x = 0; x < 16; ++x) {
            const double angle = solid_angle(y, 16, 8);
            density += sampler.pdf(texel_direction(x + 0.5, y + 0.5, sky)) * angle;
            light += luminance(sky.color) * grey[y * 16 + x] * angle;
        }
    EXPECT_NEAR(density, 1.0, 1e-5);
    EXPECT_NEAR(sampler.total() / light, 1.0, 1e-5);
}

TEST(SkySampler, SamplesFollowTheirDensity) {
    const std::vector<float> grey = mixed_texels();
    const Sky sky = image_sky(16, 8, grey);
    const SkySampler sampler(sky);
    Random random(2);
    constexpr int kCount = 400000;
    std::vector<double> counts(16 * 8, 0.0), expected(16 * 8);
    for (int i = 0; i < kCount; ++i) {
        const auto [w, radiance, density] = sampler.sample(random_point(random));
        ASSERT_NEAR(glm::length(w), 1.0f, 1e-5f);
        const glm::dvec2 p = place(w, sky);
        const auto x = static_cast<uint32_t>(std::clamp(p.x, 0.0, 15.0)),
                   y = static_cast<uint32_t>(std::clamp(p.y, 0.0, 7.0));
        ++counts[y * 16 + x];
    }
    for (uint32_t t = 0; t < expected.size(); ++t)
        expected[t] = kCount * grey[t] * solid_angle(t / 16, 16, 8) / sampler.total();
    EXPECT_GT(kit::chi_square_test(counts, expected), kAlarm);
}

TEST(SkySampler, SamplesAreUniformInsideATexel) {
    std::vector<float> grey(4 * 3, 0.0f);
    for (const uint32_t y : {0u, 1u, 2u}) { // poles and equator
        std::fill(grey.begin(), grey.end(), 0.0f);
        grey[y * 4 + 1] = 5.0f;
        const Sky sky = image_sky(4, 3, grey);
        const SkySampler sampler(sky);
        const double low = std::sin((y / 3.0 - 0.5) * kPi), high = std::sin(((y + 1) / 3.0 - 0.5) * kPi);
        Random random(3);
        constexpr int kCells = 8, kCount = 100000;
        std::vector<double> counts(kCells * kCells, 0.0);
        for (int i = 0; i < kCount; ++i) {
            const auto [w, radiance, density] = sampler.sample(random_point(random));
            const double along = place(w, sky).x - 1.0, up = (w.z - low) / (high - low);
            ASSERT_NEAR(along, 0.5, 0.5 + 1e-4);
            ASSERT_NEAR(up, 0.5, 0.5 + 1e-4);
            const auto column = static_cast<int>(std::clamp(along * kCells, 0.0, kCells - 1.0)),
                       row = static_cast<int>(std::clamp(up * kCells, 0.0, kCells - 1.0));
            ++counts[row * kCells + column];
        }
        EXPECT_GT(
            kit::chi_square_test(counts, std::vector<double>(kCells * kCells, double(kCount) / (kCells * kCells))),
            kAlarm)
            << y;
    }
}

TEST(SkySampler, TheDensityOfASampleIsTheDensityOfItsDirection) { // or MIS weights would not add to 1
    const Sky sky = image_sky(16, 8, mixed_texels(), {0.2f, 0.7f, 2.0f});
    const SkySampler sampler(sky);
    Random random(4);
    int different = 0;
    for (int i = 0; i < 100000; ++i) {
        const auto [w, radiance, density] = sampler.sample(random_point(random));
        EXPECT_GT(density, 0.0f);
        EXPECT_NEAR(luminance(radiance) / density, sampler.total(), 1e-4f * sampler.total());
        different += std::abs(sampler.pdf(w) / density - 1.0f) > 1e-4f;
    }
    EXPECT_LE(different, 10) << "more than rounding at texel borders explains";
}

TEST(SkySampler, SamplesIntegrateAnyFunction) {
    // The mean of f / density is the integral of f over the lit part: here z^2 over the upper half.
    std::vector<float> grey(16 * 8, 0.0f);
    for (uint32_t t = 4 * 16; t < grey.size(); ++t) grey[t] = 1.0f + static_cast<float>(t % 5);
    const Sky sky = image_sky(16, 8, grey);
    const SkySampler sampler(sky);
    Random random(5);
    kit::Sample integral;
    for (int i = 0; i < 100000; ++i) {
        const auto [w, radiance, density] = sampler.sample(random_point(random));
        integral.add(w.z * w.z / density);
    }
    EXPECT_NEAR(integral.mean(), 2.0 * kPi / 3.0, 4.0 * integral.error());
}

TEST(SkySampler, LightOfOneSunIsFoundByEverySample) {
    std::vector<float> grey(64 * 32, 0.0f);
    grey[20 * 64 + 40] = 1e5f;
    const Sky sky = image_sky(64, 32, grey);
    const SkySampler sampler(sky);
    Random random(6);
    for (int i = 0; i < 10000; ++i) {
        const auto [w, radiance, density] = sampler.sample(random_point(random));
        EXPECT_GT(glm::dot(w, texel_direction(40.5, 20.5, sky)), 0.99f);
        EXPECT_NEAR(density, 1.0 / solid_angle(20, 64, 32), 1e-3 * density);
    }
}

TEST(SkySampler, NothingToSampleHasNoDensity) {
    Sky plain;
    plain.present = true;
    plain.color = Vec3(1.0f);
    for (const Sky& sky : {Sky(), plain, image_sky(4, 2, std::vector<float>(8, 0.0f)),
                           image_sky(4, 2, std::vector<float>(8, 1.0f), Vec3(0.0f))}) {
        const SkySampler sampler(sky);
        const auto [w, radiance, density] = sampler.sample({0.3f, 0.6f});
        EXPECT_EQ(density, 0.0f);
        EXPECT_EQ(sampler.total(), 0.0f);
        EXPECT_EQ(sampler.pdf(w), 0.0f);
    }
}

TEST(SkySampler, TheEndsOfTheUnitSquareStayInside) {
    const Sky sky = image_sky(16, 8, mixed_texels());
    const SkySampler sampler(sky);
    for (const float x : {0.0f, 0x1.fffffep-1f})
        for (const float y : {0.0f, 0x1.fffffep-1f}) {
            const auto [w, radiance, density] = sampler.sample({x, y});
            EXPECT_TRUE(is_finite(w));
            EXPECT_GT(density, 0.0f);
        }
}

} // namespace
} // namespace ajar
