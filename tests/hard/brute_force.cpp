// SPDX-License-Identifier: GPL-3.0-or-later
#include "brute_force.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace hard {
namespace {

constexpr double kClear = 1e-6; ///< m, between a surface and a ray that starts there

struct Hit {
    const Rectangle* rectangle = nullptr;
    double distance = 1e30;
};

Hit nearest(const std::vector<Rectangle>& scene, const Double3& from, const Double3& along, double end = 1e30) {
    Hit hit{nullptr, end};
    for (const Rectangle& r : scene) {
        const auto a = static_cast<size_t>(r.axis), b = (a + 1) % 3, c = (a + 2) % 3;
        const double t = (r.at - from[a]) / along[a];
        if (!(t > kClear && t < hit.distance)) continue;
        const double p = from[b] + t * along[b], q = from[c] + t * along[c];
        if (p >= r.low[0] && p <= r.high[0] && q >= r.low[1] && q <= r.high[1]) hit = {&r, t};
    }
    return hit;
}

/// Irradiance of the lamp at a place whose normal is an axis times a sign.
double direct(const std::vector<Rectangle>& scene, const Lamp& lamp, const Double3& at, size_t axis, double sign) {
    Double3 to;
    double d2 = 0.0;
    for (size_t i = 0; i < 3; ++i) to[i] = lamp.position[i] - at[i], d2 += to[i] * to[i];
    const double d = std::sqrt(d2), cosine = sign * to[axis] / d;
    if (lamp.watts == 0.0 || cosine <= 0.0 || nearest(scene, at, to, 1.0).rectangle != nullptr) return 0.0;
    return lamp.watts / (4.0 * std::numbers::pi) * cosine / d2;
}

} // namespace

std::vector<Rectangle> box_walls(const Double3& low, const Double3& high, double albedo) {
    std::vector<Rectangle> out;
    for (size_t a = 0; a < 3; ++a) {
        const size_t b = (a + 1) % 3, c = (a + 2) % 3;
        for (const double at : {low[a], high[a]})
            out.push_back({static_cast<int>(a), at, {low[b], low[c]}, {high[b], high[c]}, albedo});
    }
    return out;
}

double brute_force(const std::vector<Rectangle>& scene, const Lamp& lamp, const Double3& point, int bounces,
                   int paths) {
    std::mt19937 random(
        static_cast<uint32_t>(1e4 * (7.0 * point[0] + 3.0 * point[1] + 1e3))); // apart from other points
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    double sum = 0.0;
    for (int i = 0; i < paths; ++i) {
        Double3 at = point;
        size_t axis = 2;
        double sign = 1.0, weight = std::numbers::pi;
        for (int bounce = 0; bounce <= bounces; ++bounce) {
            // Cosine-weighted, so that a path brings pi times the radiance that it meets.
            const double r2 = uniform(random), a = 2.0 * std::numbers::pi * uniform(random), r = std::sqrt(r2);
            Double3 along;
            along[axis] = sign * std::sqrt(1.0 - r2);
            along[(axis + 1) % 3] = r * std::cos(a), along[(axis + 2) % 3] = r * std::sin(a);
            const Hit hit = nearest(scene, at, along);
            if (hit.rectangle == nullptr) break;
            for (size_t k = 0; k < 3; ++k) at[k] += hit.distance * along[k];
            axis = static_cast<size_t>(hit.rectangle->axis);
            at[axis] = hit.rectangle->at;
            sign = along[axis] > 0.0 ? -1.0 : 1.0;
            const double reflected = hit.rectangle->albedo / std::numbers::pi;
            sum += weight * hit.rectangle->radiance / paths;
            if (bounce < bounces) sum += weight * reflected * direct(scene, lamp, at, axis, sign) / paths;
            weight *= hit.rectangle->albedo;
        }
    }
    return sum + direct(scene, lamp, point, 2, 1.0);
}

} // namespace hard
