// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A hard case: a scene of a few triangles whose light is known, and one number that must stay below a bound.

#include <cmath>
#include <functional>
#include <numbers>
#include <span>

#include "stage.h"

namespace hard {

using kit::Float3;
using kit::Layer;
using kit::Stage;
using kit::Variant;
using std::numbers::pi;

/// Where a case comes from.
enum class Origin {
    kBase,    ///< of the list of what bakers are known to fail on
    kReport,  ///< of a kind that was reported to fail in a scene
    kSibling, ///< of the same kind as a reported one, in another scene
};

struct Case {
    const char* kind;
    Origin origin;
    const char* name;
    const char* trap;   ///< what breaks naive bakers
    const char* number; ///< what is measured
    double bound;
    double (*measure)(const Variant&);
};

std::span<const Case> geometry_cases();
std::span<const Case> lamp_cases();
std::span<const Case> element_cases();
std::span<const Case> switch_cases();
std::span<const Case> door_cases();
std::span<const Case> set_cases();
std::span<const Case> leak_cases();
std::span<const Case> unmapped_cases();
std::span<const Case> layer_cases();
std::span<const Case> near_cases();
std::span<const Case> range_cases();
std::span<const Case> furnace_cases();
std::span<const Case> side_cases();
std::span<const Case> hall_cases();
std::span<const Case> hole_cases();

/// Largest channel value; infinite if some is not finite or negative.
double largest(const Layer& e);
/// Largest relative deviation of the first channel from what is expected at a texel.
double worst(const Layer& e, const std::function<double(uint32_t, uint32_t)>& expected);
double worst(const Layer& e, double expected);
/// Over all texels and channels.
double mean(const Layer& e);
/// Of one channel, over the texels of a bake that are valid.
double valid_mean(const Layer& e, const Layer& valid, uint32_t channel = 0);
/// Relative difference of a number from what is expected; infinite if it is not finite.
double off(double got, double expected);
/// Middle of a texel of a square of edge m about the origin.
Float3 texel(uint32_t x, uint32_t y, uint32_t size, float edge);
/// The i-th of many boxes within each other around a floor of 0.1 m: each ray from it passes each of them once.
kit::MeshData around(size_t i);
constexpr float kAround = 0.1f; ///< edge of that floor, m
/// Irradiance of a point lamp of so many watts at a point of the plane z = 0.
double from_point(const Float3& lamp, double watts, const Float3& p);
/// Irradiance at a point of the plane z = 0 of a rectangle of radiance 1 at height h (algorithms.md 12.5).
double from_rectangle(double x0, double x1, double y0, double y1, double h, const Float3& p);

} // namespace hard
