// SPDX-License-Identifier: GPL-3.0-or-later
// What the check of a finished bake says when it and brute force disagree.
#include "api/self_check.h"

#include <gtest/gtest.h>

namespace ajar {
namespace {

SelfCheck check_of(const std::vector<CheckPoint>& points) {
    SelfCheck check;
    check.states.push_back(compare_points(points, 0.0));
    return check;
}

TEST(SelfCheck, WrongLightIsTold) {
    const SelfCheck check = check_of(std::vector<CheckPoint>(200, {1.2f, 0.02f, 1.0f, 0.05f}));
    EXPECT_NEAR(check.worst().ratio, 1.2, 1e-6);
    EXPECT_NEAR(check.worst().far_share, 0.0, 1e-12); // each alone may be noise, all together are not
    ASSERT_EQ(check_warnings(check, "level").size(), 1u);
    EXPECT_EQ(check_warnings(check, "level")[0].culprit, "level");
}

TEST(SelfCheck, NoiseIsNoReasonToWarn) {
    EXPECT_TRUE(check_warnings(check_of(std::vector<CheckPoint>(4, {1.2f, 0.02f, 1.0f, 0.5f})), "level").empty());
    EXPECT_TRUE(check_warnings(check_of({}), "level").empty());
}

TEST(SelfCheck, ManyWrongTexelsAndGrowingLightAreTold) {
    std::vector<CheckPoint> points(100, {1.0f, 0.001f, 1.0f, 0.001f});
    for (size_t i = 0; i < points.size(); i += 4) points[i].baked = i % 8 == 0 ? 1.5f : 0.5f;
    SelfCheck check = check_of(points);
    EXPECT_NEAR(check.worst().far_share, 0.25, 0.01);
    check.bounce_gain = {1.1, 0.02};
    EXPECT_EQ(check_warnings(check, "level").size(), 2u);
}

TEST(SelfCheck, TheWorstStateIsTold) {
    SelfCheck check = check_of(std::vector<CheckPoint>(100, {1.0f, 0.001f, 1.0f, 0.001f}));
    check.states.push_back(compare_points(std::vector<CheckPoint>(100, {0.6f, 0.001f, 1.0f, 0.001f}), 0.0));
    check.states.back().state.name = "random 1";
    check.states.push_back(compare_points(std::vector<CheckPoint>(100, {1.06f, 0.001f, 1.0f, 0.001f}), 0.0));
    EXPECT_EQ(check.worst().state.name, "random 1");
    const auto warnings = check_warnings(check, "level");
    ASSERT_EQ(warnings.size(), 2u);
    EXPECT_NE(warnings[0].text.find("60.0 %"), std::string::npos) << warnings[0].text;
    EXPECT_NE(warnings[0].text.find("random 1"), std::string::npos) << warnings[0].text;
}

TEST(SelfCheck, LightInADarkStateIsMeasuredByTheBrightestOne) {
    // 0.5 % of it is what terms may leave out; ten times that where brute force finds nothing is wrong.
    EXPECT_LT(compare_points(std::vector<CheckPoint>(100, {0.0f, 0.0f, 0.0f, 0.0f}), 0.01).excess(), 1e-9);
    EXPECT_LT(compare_points(std::vector<CheckPoint>(100, {0.0f, 0.0f, 0.0004f, 0.0f}), 0.01).excess(), 1.0);
    EXPECT_GT(compare_points(std::vector<CheckPoint>(100, {0.05f, 0.001f, 0.0f, 0.0f}), 0.01).excess(), 1.0);
}

TEST(SelfCheck, LooksAtTheStartTheEndsAndFourStatesByChance) {
    EXPECT_EQ(states_to_check({}, 0).size(), 1u);
    Element set, door;
    door.kind = ElementKind::door, door.weight = 0.0f;
    const auto states = states_to_check({set, door}, 3);
    ASSERT_EQ(states.size(), 6u);
    EXPECT_EQ(states[0].weights, (std::vector<float>{1, 0}));
    EXPECT_EQ(states[1].weights, (std::vector<float>{1, 1}));
    for (size_t i = 2; i < 6; ++i)
        for (const float w : states[i].weights) EXPECT_TRUE(w >= 0.0f && w <= 1.0f);
    EXPECT_NE(states[2].weights, states[3].weights);
    door.weight = 1.0f;
    const auto closing = states_to_check({set, door}, 3);
    ASSERT_EQ(closing.size(), 6u) << "the start is everything on";
    EXPECT_EQ(closing[1].weights, (std::vector<float>{1, 0})) << "all changed";
    set.weight = 0.0f;
    ASSERT_EQ(states_to_check({set}, 3).size(), 6u) << "nothing to change but the set";
    EXPECT_EQ(points_of_state(256, 1), 256u);
    EXPECT_EQ(points_of_state(256, 6), 42u);
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
