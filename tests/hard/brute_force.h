// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A path tracer of a few lines to judge hard cases by: axis-aligned rectangles that reflect alike on both sides, and
// one point lamp or one glowing rectangle. It shares nothing with the engine.

#include <array>
#include <cstdint>
#include <vector>

namespace hard {

using Double3 = std::array<double, 3>;

/// Rectangle across an axis at a place, from low to high on the next two axes (cyclically).
struct Rectangle {
    int axis;
    double at;
    std::array<double, 2> low, high;
    double albedo;
    double radiance = 0.0; ///< of what glows
};

struct Lamp {
    Double3 position;
    double watts;
};

/// The six walls of a box.
std::vector<Rectangle> box_walls(const Double3& low, const Double3& high, double albedo);

/// Irradiance at a point with its normal along +z, the lamp's own light and up to so many reflections included.
double brute_force(const std::vector<Rectangle>& scene, const Lamp& lamp, const Double3& point, int bounces, int paths);

} // namespace hard
