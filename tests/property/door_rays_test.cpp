// SPDX-License-Identifier: GPL-3.0-or-later
// Rays aimed at doors: the same mean, much less noise where a door is small and far.
#include <gtest/gtest.h>

#include "door_hall.h"

namespace {

using kit::Comparison;

TEST(DoorRays, KeepTheMeanAndTakeTheNoise) {
    const kit::DoorHall hall;
    const std::vector<double> truth = hall.bake(4096, 0.5f);
    const Comparison plain = kit::compare(hall.bake(4096, 0.0f), truth),
                     few = kit::compare(hall.bake(256, 0.0f), truth),
                     aimed = kit::compare(hall.bake(256, 0.25f), truth);
    EXPECT_NEAR(plain.mean / plain.expected, 1.0, 0.12); // three standard errors
    EXPECT_NEAR(aimed.mean / aimed.expected, 1.0, 0.04);
    EXPECT_LT(aimed.rms, 0.15 * few.rms);
}

} // namespace
