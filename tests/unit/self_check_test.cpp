// SPDX-License-Identifier: GPL-3.0-or-later
// What the check of a finished bake says when it and brute force disagree.
#include "api/self_check.h"

#include <gtest/gtest.h>

namespace ajar {
namespace {

TEST(SelfCheck, WrongLightIsTold) {
    SelfCheck check;
    compare_points(std::vector<CheckPoint>(200, {1.2f, 0.02f, 1.0f, 0.05f}), check);
    EXPECT_NEAR(check.ratio, 1.2, 1e-6);
    EXPECT_NEAR(check.far_share, 0.0, 1e-12); // each alone may be noise, all together are not
    ASSERT_EQ(check_warnings(check, "level").size(), 1u);
    EXPECT_EQ(check_warnings(check, "level")[0].culprit, "level");
}

TEST(SelfCheck, NoiseIsNoReasonToWarn) {
    SelfCheck check;
    compare_points(std::vector<CheckPoint>(4, {1.2f, 0.02f, 1.0f, 0.5f}), check);
    EXPECT_TRUE(check_warnings(check, "level").empty());
    compare_points({}, check);
    EXPECT_TRUE(check_warnings(check, "level").empty());
}

TEST(SelfCheck, ManyWrongTexelsAndGrowingLightAreTold) {
    std::vector<CheckPoint> points(100, {1.0f, 0.001f, 1.0f, 0.001f});
    for (size_t i = 0; i < points.size(); i += 4) points[i].baked = i % 8 == 0 ? 1.5f : 0.5f;
    SelfCheck check;
    compare_points(points, check);
    EXPECT_NEAR(check.far_share, 0.25, 0.01);
    check.bounce_gain = {1.1, 0.02};
    EXPECT_EQ(check_warnings(check, "level").size(), 2u);
}

TEST(SelfCheck, GrowthWithinItsErrorIsNoReasonToWarn) {
    SelfCheck check;
    check.bounce_gain = {1.1, 0.03};
    EXPECT_TRUE(check_warnings(check, "level").empty());
    // Direct light may fall on unmapped surfaces first; of the others the surest counts, not the largest.
    const BounceGain worst = largest_gain({{9.0, 0.0}, {0.8, 0.01}, {1.3, 0.2}, {0.9, 0.01}});
    EXPECT_EQ(worst.gain, 0.9);
    EXPECT_EQ(largest_gain({}).gain, 0.0);
}

TEST(SelfCheck, EveryFailureIsAReasonInWordsButCancelling) {
    EXPECT_EQ(why_not([] {}), "");
    EXPECT_EQ(why_not([] { throw std::bad_alloc(); }), "not enough memory");
    EXPECT_EQ(why_not([] { throw Error(AJAR_ERROR_IO, "the disk is full"); }), "the disk is full");
    EXPECT_THROW(why_not([] { throw Cancelled(); }), Cancelled);
    SelfCheck check;
    check.not_checked = "the disk is full";
    const auto warnings = check_warnings(check, "level");
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].text.find("not checked: the disk is full"), std::string::npos);
}

} // namespace
} // namespace ajar
