// SPDX-License-Identifier: GPL-3.0-or-later
// R11G11B10F against its definition (algorithms.md 2.5; Khronos data format 1.3, 10.3 and 10.4).
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <random>

#include "encode/ahd.h"

namespace ajar {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();

/// One of the three channels.
struct Channel {
    int index, shift, mantissa;
    double largest, worst; ///< worst relative error of rounding to nearest

    uint32_t pack(float v) const {
        Vec3 color(0.0f);
        color[index] = v;
        const uint32_t word = pack_r11g11b10f(color);
        EXPECT_EQ(word & ~(mask() << shift), 0u) << "spills into the neighbours";
        return word >> shift & mask();
    }
    float unpack(uint32_t code) const { return unpack_r11g11b10f(code << shift)[index]; }
    uint32_t mask() const { return (32u << mantissa) - 1u; }
    uint32_t largest_code() const { return (31u << mantissa) - 1u; }
    /// Exponent bias 15; exponent 0 holds denormals.
    double definition(uint32_t code) const {
        const int exponent = static_cast<int>(code >> mantissa);
        const double fraction = (code & ((1u << mantissa) - 1u)) / std::ldexp(1.0, mantissa);
        return exponent == 0 ? std::ldexp(fraction, -14) : std::ldexp(1.0 + fraction, exponent - 15);
    }
};

constexpr std::array<Channel, 3> kChannels{
    {{0, 0, 6, 65024.0, 0.0078}, {1, 11, 6, 65024.0, 0.0078}, {2, 22, 5, 64512.0, 0.0154}}};

TEST(EncodeSmallFloat, EveryCodeReadsAsDefinedAndPacksToItself) {
    for (const Channel& c : kChannels)
        for (uint32_t code = 0; code <= c.largest_code(); ++code) {
            ASSERT_EQ(c.unpack(code), c.definition(code)) << c.index << ' ' << code;
            ASSERT_EQ(c.pack(c.unpack(code)), code) << c.index;
        }
}

TEST(EncodeSmallFloat, TheLargestCodesAreThoseOfTheTable) {
    for (const Channel& c : kChannels) EXPECT_EQ(c.definition(c.largest_code()), c.largest);
    EXPECT_EQ(kChannels[0].definition(1), std::ldexp(1.0, -20));  // 9.5e-7
    EXPECT_EQ(kChannels[0].definition(64), std::ldexp(1.0, -14)); // 6.1e-5
}

TEST(EncodeSmallFloat, RoundsToTheNearestCode) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> decades(std::log(1e-7), std::log(7e4));
    for (const Channel& c : kChannels)
        for (int i = 0; i < 20000; ++i) {
            const auto v = static_cast<float>(std::exp(decades(random)));
            const uint32_t code = c.pack(v);
            const uint32_t below = code - (code > 0), above = code + (code < c.largest_code());
            const double error = std::abs(c.definition(code) - v);
            ASSERT_LE(error, std::abs(c.definition(below) - v)) << c.index << ' ' << v;
            ASSERT_LE(error, std::abs(c.definition(above) - v)) << c.index << ' ' << v;
        }
}

TEST(EncodeSmallFloat, ErrorsStayWithinTheirBounds) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> normal(-14.0, 15.98), denormal(0.0, std::ldexp(1.0, -14));
    for (const Channel& c : kChannels)
        for (int i = 0; i < 20000; ++i) {
            const auto v = static_cast<float>(std::exp2(normal(random))), small = static_cast<float>(denormal(random));
            ASSERT_NEAR(c.unpack(c.pack(v)) / v, 1.0, c.worst) << c.index << ' ' << v;
            ASSERT_NEAR(c.unpack(c.pack(small)), small, 0.5 * c.definition(1)) << c.index << ' ' << small;
        }
}

TEST(EncodeSmallFloat, RoundingIsUnbiased) { // truncation would darken by half a step
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(1.0f, 2.0f);
    for (const Channel& c : kChannels) {
        double sum = 0.0;
        constexpr int kCount = 100000;
        for (int i = 0; i < kCount; ++i) {
            const float v = unit(random);
            sum += (c.unpack(c.pack(v)) - v) / kCount;
        }
        const double step = std::ldexp(1.0, -c.mantissa), deviation = step / std::sqrt(12.0 * kCount);
        EXPECT_NEAR(sum, 0.0, 5.0 * deviation) << c.index;
    }
}

TEST(EncodeSmallFloat, TooLargeBecomesTheLargest) {
    for (const Channel& c : kChannels)
        for (const float v : {static_cast<float>(c.largest), 65025.0f, 65535.0f, 65536.0f, 1e10f,
                              std::numeric_limits<float>::max(), kInf})
            EXPECT_EQ(c.pack(v), c.largest_code()) << c.index << ' ' << v;
}

TEST(EncodeSmallFloat, NegativeAndNanBecomeZero) {
    for (const Channel& c : kChannels)
        for (const float v :
             {-0.0f, -1e-30f, -1.0f, -kInf, kNan, -kNan, std::numeric_limits<float>::denorm_min(), 4e-7f})
            EXPECT_EQ(c.pack(v), 0u) << c.index << ' ' << v;
}

TEST(EncodeSmallFloat, ChannelsDoNotTouchEachOther) {
    const uint32_t word = pack_r11g11b10f({1.0f, kNan, kInf});
    EXPECT_EQ(unpack_r11g11b10f(word), Vec3(1.0f, 0.0f, 64512.0f));
    EXPECT_EQ(unpack_r11g11b10f(pack_r11g11b10f({-1.0f, 0.5f, 3.0f})), Vec3(0.0f, 0.5f, 3.0f));
}

} // namespace
} // namespace ajar
