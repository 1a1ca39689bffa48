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
    check.bounce_gain = 1.1;
    EXPECT_EQ(check_warnings(check, "level").size(), 2u);
}

} // namespace
} // namespace ajar
