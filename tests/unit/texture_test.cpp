// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/texture.h"

#include <gtest/gtest.h>

namespace ajar {
namespace {

/// Black and white side by side.
Texture pair_of_bytes(bool srgb, Texture::Extend extend = Texture::Extend::edge) {
    Texture t;
    t.width = 2, t.height = 1;
    t.srgb = srgb;
    t.extend = extend;
    t.bytes = {0, 0, 0, 255, 255, 255, 255, 255};
    return t;
}

TEST(Texture, SrgbIsMixedAsItIsStored) {
    // Half way between the codes 0 and 255; 0.2140 is the sRGB curve at 0.5.
    EXPECT_NEAR(pair_of_bytes(true).sample({0.5f, 0.5f}).x, 0.21404f, 1e-4f);
    EXPECT_NEAR(pair_of_bytes(false).sample({0.5f, 0.5f}).x, 0.5f, 1e-6f);
    for (const float u : {0.25f, 0.75f})
        EXPECT_EQ(pair_of_bytes(true).sample({u, 0.5f}).x, pair_of_bytes(true).texel(u > 0.5f, 0).x) << u;
}

TEST(Texture, Extension) {
    using enum Texture::Extend;
    EXPECT_EQ(pair_of_bytes(false, edge).sample({-3.0f, 0.5f}).x, 0.0f);
    EXPECT_EQ(pair_of_bytes(false, edge).sample({1e30f, 0.5f}).x, 1.0f);
    EXPECT_EQ(pair_of_bytes(false, clip).sample({-3.0f, 0.5f}), Vec4(0.0f));
    EXPECT_NEAR(pair_of_bytes(false, repeat).sample({-0.25f, 0.5f}).x, 1.0f, 1e-6f);
    EXPECT_NEAR(pair_of_bytes(false, repeat).sample({1.0f, 7.5f}).x, 0.5f, 1e-6f);
    EXPECT_NEAR(pair_of_bytes(false, repeat).sample({-1e-9f, 0.5f}).x, 0.5f, 1e-6f);
}

TEST(Texture, NearestAndNumbersThatAreNone) {
    Texture t = pair_of_bytes(false, Texture::Extend::repeat);
    t.nearest = true;
    EXPECT_EQ(t.sample({0.49f, 0.5f}).x, 0.0f);
    EXPECT_EQ(t.sample({1.51f, -0.5f}).x, 1.0f);
    EXPECT_EQ(t.sample({std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}).w, 1.0f);
}

} // namespace
} // namespace ajar
