// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Made-up light on the upper hemisphere of a texel, and by quadrature what a perfect bake of it
// knows: irradiance on any normal and the spherical harmonics of its radiance.

#include <array>
#include <functional>
#include <random>
#include <vector>

#include "base/math.h"
#include "sampling/sh.h"

namespace ajar {

/// Light as many small distant sources; every integral over it is a plain sum.
struct SyntheticLight {
    std::vector<DVec3> direction;
    std::vector<double> power; ///< radiance * solid angle

    double irradiance(const Vec3& n) const {
        double sum = 0.0;
        for (size_t i = 0; i < power.size(); ++i) sum += power[i] * std::max(0.0, glm::dot(direction[i], DVec3(n)));
        return sum;
    }
    /// Coefficients by the definition of the basis, written out here a second time.
    std::array<float, kShCount> sh() const {
        const double k0 = 0.5 / std::sqrt(std::numbers::pi), k1 = std::sqrt(3.0) * k0, k2 = std::sqrt(15.0) * k0;
        std::array<double, kShCount> sum{};
        for (size_t i = 0; i < power.size(); ++i) {
            const DVec3& w = direction[i];
            const double y[kShCount] = {k0,
                                        -k1 * w.y,
                                        k1 * w.z,
                                        -k1 * w.x,
                                        k2 * w.x * w.y,
                                        -k2 * w.y * w.z,
                                        std::sqrt(5.0) * k0 * (1.5 * w.z * w.z - 0.5),
                                        -k2 * w.x * w.z,
                                        0.5 * k2 * (w.x * w.x - w.y * w.y)};
            for (int c = 0; c < kShCount; ++c) sum[c] += power[i] * y[c];
        }
        std::array<float, kShCount> out;
        std::copy(sum.begin(), sum.end(), out.begin());
        return out;
    }
};

using Radiance = std::function<double(const DVec3&)>;

/// Cuts the hemisphere into cells of equal solid angle, the light of each at its middle.
inline SyntheticLight quadrature(const Radiance& radiance, int rings = 40, int sectors = 80) {
    SyntheticLight light;
    for (int i = 0; i < rings; ++i)
        for (int j = 0; j < sectors; ++j) {
            const double z = (i + 0.5) / rings, r = std::sqrt(1.0 - z * z),
                         phi = 2.0 * std::numbers::pi * (j + 0.5) / sectors;
            const DVec3 w(r * std::cos(phi), r * std::sin(phi), z);
            const double l = radiance(w);
            if (!(l > 0.0)) continue;
            light.direction.push_back(w);
            light.power.push_back(l * 2.0 * std::numbers::pi / (rings * sectors));
        }
    return light;
}

using Random = std::mt19937;
inline double uniform(Random& random, double low = 0.0, double high = 1.0) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

/// Unit direction with height (sine of the elevation) in the given range.
inline DVec3 direction_between(Random& random, double low, double high) {
    const double z = uniform(random, low, high), r = std::sqrt(1.0 - z * z),
                 phi = uniform(random, 0.0, 2.0 * std::numbers::pi);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

/// A soft lamp: spherical Gaussian with 1 at its middle.
inline double lobe(const DVec3& w, const DVec3& middle, double sharpness) {
    return std::exp(sharpness * (glm::dot(w, middle) - 1.0));
}

// Four kinds of light that algorithms.md 1.9 names without a formula. Their contrast is chosen so
// that ignoring the direction costs about what the table there says it does.

/// An overcast sky (CIE: radiance as 1 + 2 sin elevation), brighter towards one side.
inline SyntheticLight sky_light(Random& random) {
    const double tilt = uniform(random, 0.0, 0.3);
    const DVec3 side = direction_between(random, 0.0, 0.1);
    return quadrature([=](const DVec3& w) { return 1.0 + 2.0 * w.z + tilt * glm::dot(w, side); });
}

inline SyntheticLight lobe_light(Random& random, int lobes) {
    std::vector<std::pair<DVec3, double>> lamps;
    for (int i = 0; i < lobes; ++i)
        lamps.emplace_back(direction_between(random, 0.3, 0.95), uniform(random, 4.0, 10.0));
    return quadrature([=](const DVec3& w) {
        double l = 0.4;
        for (const auto& [middle, strength] : lamps) l += strength * lobe(w, middle, 15.0);
        return l;
    });
}

/// A bright rectangle in a dark wall, seen from a room.
inline SyntheticLight window_light(Random& random) {
    const DVec3 middle = direction_between(random, 0.5, 0.85);
    const double half_width = uniform(random, 0.15, 0.3), half_height = uniform(random, 0.15, 0.3);
    const DVec3 across = glm::normalize(glm::cross(DVec3(0, 0, 1), middle)), up = glm::cross(middle, across);
    return quadrature([=](const DVec3& w) {
        const double depth = glm::dot(w, middle);
        const bool inside = depth > 0.0 && std::abs(glm::dot(w, across)) < half_width * depth &&
                            std::abs(glm::dot(w, up)) < half_height * depth;
        return 0.06 + (inside ? 8.0 : 0.0);
    });
}

} // namespace ajar
