// SPDX-License-Identifier: GPL-3.0-or-later
// The tests' own measuring tape, against published tables.
#include "statistics.h"

#include <gtest/gtest.h>

namespace {

TEST(Statistics, ChiSquareMatchesTheTables) {
    EXPECT_NEAR(kit::chi_square_tail(3.841459, 1), 0.05, 1e-7);
    EXPECT_NEAR(kit::chi_square_tail(18.307038, 10), 0.05, 1e-7);
    EXPECT_NEAR(kit::chi_square_tail(2.558212, 10), 0.99, 1e-7);
    EXPECT_NEAR(kit::chi_square_tail(149.449253, 100), 0.001, 1e-8);
    EXPECT_EQ(kit::chi_square_tail(0.0, 4), 1.0);
}

TEST(Statistics, StudentMatchesTheTables) {
    EXPECT_NEAR(kit::student_tail(12.7062047, 1), 0.05, 1e-8);
    EXPECT_NEAR(kit::student_tail(-2.22813885, 10), 0.05, 1e-8);
    EXPECT_NEAR(kit::student_tail(0.7027221, 9), 0.5, 1e-6);
    EXPECT_NEAR(kit::student_tail(1.95996398, 1e7), 0.05, 1e-6); // the normal distribution
    EXPECT_NEAR(kit::student_tail(5.4078823, 7), 0.001, 1e-8);
    EXPECT_EQ(kit::student_tail(0.0, 7), 1.0);
}

TEST(Statistics, SidakOfManyTestsRaisesOneAlarmAsOftenAsAsked) {
    EXPECT_NEAR(1.0 - std::pow(1.0 - kit::sidak(0.01, 2000), 2000), 0.01, 1e-9);
    EXPECT_DOUBLE_EQ(kit::sidak(0.05, 1), 0.05);
}

TEST(Statistics, PearsonPoolsRareCellsAndRefusesTheImpossible) {
    EXPECT_DOUBLE_EQ(kit::chi_square_test({50, 50}, {50, 50}), 1.0);
    EXPECT_NEAR(kit::chi_square_test({60, 40}, {50, 50}), 0.0455003, 1e-6); // chi-square 4, 1 degree
    EXPECT_NEAR(kit::chi_square_test({60, 37, 3}, {50, 46, 4}), kit::chi_square_tail(2.0 + 81.0 / 46.0 + 0.25, 2),
                1e-12);
    EXPECT_NEAR(kit::chi_square_test({60, 1, 2, 37}, {50, 2, 2, 46}), kit::chi_square_tail(2.0 + 0.25 + 81.0 / 46.0, 2),
                1e-12);
    EXPECT_EQ(kit::chi_square_test({99, 1}, {100, 0}), 0.0);
}

TEST(Statistics, RunningMomentsAreTheMoments) {
    kit::Sample s;
    for (double v : {1e6 + 1.0, 1e6 + 2.0, 1e6 + 4.0, 1e6 + 9.0}) s.add(v);
    EXPECT_DOUBLE_EQ(s.mean(), 1e6 + 4.0);
    EXPECT_NEAR(s.variance(), 38.0 / 3.0, 1e-6);
    EXPECT_NEAR(s.error(), std::sqrt(38.0 / 12.0), 1e-6);
}

} // namespace
