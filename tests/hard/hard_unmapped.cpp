// SPDX-License-Identifier: GPL-3.0-or-later
// Light by way of surfaces without a lightmap: chains of reflections that nothing stores.
#include "hard_case.h"

namespace hard {
namespace {

/// Closed box that glows with radiance 1: pi / (1 - rho) everywhere.
double occluder_furnace(const Variant& v) {
    Stage s(v);
    const uint32_t page = s.object(kit::plane(0.01f, 0.5f), s.black(), 4);
    s.object(kit::box({-1, -1, 0}, {1, 1, 2}, true), s.emitter({1, 1, 1}, 0.95f));
    s.scene.commit();
    return off(mean(s.irradiance(kit::Bake(s.scene, s.settings(1, 2048)), page)), pi / 0.05);
}

/// Irradiance of one reflection by a ceiling at 2.5 m of reflectance .6, 4 m wide, at the middle of the floor, from a
/// lamp of 100 W at (0.5, 0.3) some way under it. In polar coordinates around the lamp's foot.
double from_ceiling(double below) {
    constexpr int kRings = 1000, kAngles = 180;
    double sum = 0.0;
    for (int i = 0; i < kRings; ++i) {
        const double angle = (i + 0.5) / kRings * 0.5 * pi, radius = below * std::tan(angle);
        if (radius > 4.0) break;
        const double area = radius * below / std::pow(std::cos(angle), 2) * (0.5 * pi / kRings) * (2.0 * pi / kAngles);
        const double lamp = below / std::pow(radius * radius + below * below, 1.5);
        for (int k = 0; k < kAngles; ++k) {
            const double a = 2.0 * pi * (k + 0.5) / kAngles, x = 0.5 + radius * std::cos(a),
                         y = 0.3 + radius * std::sin(a);
            if (std::abs(x) > 2.0 || std::abs(y) > 2.0) continue;
            const double d2 = x * x + y * y + 6.25;
            sum += lamp * area * 6.25 / (d2 * d2);
        }
    }
    return 0.6 / pi * 100.0 / (4.0 * pi) * sum;
}

double lamps_under_a_ceiling(const Variant& v) {
    double most = 0.0;
    for (const float below : {0.01f, 0.05f, 0.5f}) {
        Stage s(v);
        const uint32_t page = s.object(kit::plane(0.05f, 0.0f), s.black(), 8);
        s.object(kit::plane(4.0f, 2.5f, false), s.scene.diffuse({0.6f, 0.6f, 0.6f}));
        s.light(Stage::lamp(AJAR_LIGHT_POINT, 100.0, AJAR_ROLE_PRIMARY), {0.5f, 0.3f, 2.5f - below});
        s.scene.commit();
        most =
            std::max(most, off(mean(s.irradiance(kit::Bake(s.scene, s.settings(1, 256)), page)), from_ceiling(below)));
    }
    return most;
}

/// The ceiling is a toggle, there by a half at the start, and the lamp is in a set.
double ceiling_that_goes(const Variant& v) {
    Stage s(v);
    const uint32_t page = s.object(kit::plane(0.05f, 0.0f), s.black(), 8);
    s.toggle("ceiling", 0.5f);
    s.object(kit::plane(4.0f, 2.5f, false), s.scene.diffuse({0.6f, 0.6f, 0.6f}));
    s.release();
    s.set("lamp");
    s.light(Stage::lamp(AJAR_LIGHT_POINT, 100.0, AJAR_ROLE_PRIMARY), {0.5f, 0.3f, 2.0f});
    s.scene.commit();
    const kit::Bake bake(s.scene, s.settings(1, 256));
    double most = largest(s.state(bake, {0, 1}, 8, page));
    for (const float there : {0.5f, 1.0f})
        most = std::max(most, off(mean(s.state(bake, {there, 1}, 8, page)), there * from_ceiling(0.5)));
    return most;
}

/// In a sphere every place gets the same share of what any other reflects, wherever the lamp is.
double integrating_sphere(const Variant& v) {
    Stage s(v);
    const kit::MeshData sphere = kit::sphere_inside(1.0f, 3);
    double area = 0.0;
    for (size_t t = 0; t < sphere.corners.size(); t += 3) {
        const Float3 &a = sphere.positions[sphere.corners[t]], &b = sphere.positions[sphere.corners[t + 1]],
                     &c = sphere.positions[sphere.corners[t + 2]];
        const double ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2], wx = c[0] - a[0], wy = c[1] - a[1],
                     wz = c[2] - a[2];
        area += 0.5 * std::hypot(uy * wz - uz * wy, uz * wx - ux * wz, ux * wy - uy * wx);
    }
    s.object(sphere, s.scene.diffuse({0.8f, 0.8f, 0.8f}));
    const uint32_t page = s.object(kit::plane(0.02f, -0.97f), s.black(), 4);
    s.light(Stage::lamp(AJAR_LIGHT_POINT, 100.0, AJAR_ROLE_PRIMARY), {0.9f, 0.05f, 0.1f});
    s.scene.commit();
    return off(mean(s.irradiance(kit::Bake(s.scene, s.settings(1, 2048)), page)), 100.0 / area * 0.8 / 0.2);
}

/// A card of 2 mm that looks down at sunlit ground.
double sunlit_ground(const Variant& v) {
    Stage s(v);
    const uint32_t page = s.object(kit::plane(0.002f, 0.1f, false), s.black(), 4);
    s.object(kit::plane(15.0f, 0.0f), s.scene.diffuse({0.7f, 0.7f, 0.7f}));
    s.sun(0.6, 5.0);
    s.scene.commit();
    return off(mean(s.irradiance(kit::Bake(s.scene, s.settings(1, 256)), page)), 0.7 * 5.0 * std::sin(0.6));
}

/// A glowing floor and a ceiling, 15 m wide and 5 cm apart, that reflect .9 each: a geometric series.
double two_plates(const Variant& v) {
    Stage s(v);
    const uint32_t page = s.object(kit::plane(0.001f, 0.0005f), s.black(), 4);
    s.object(kit::plane(15.0f, 0.0f), s.emitter({1, 1, 1}, 0.9f));
    s.object(kit::plane(15.0f, 0.05f, false), s.scene.diffuse({0.9f, 0.9f, 0.9f}));
    s.scene.commit();
    return off(mean(s.irradiance(kit::Bake(s.scene, s.settings(1, 2048)), page)), pi * 0.9 / (1.0 - 0.81));
}

const Case kCases[] = {
    {"unmapped", Origin::kReport, "glowing box of reflectance .95", "chains of reflections end too early", "mean", 0.03,
     occluder_furnace},
    {"unmapped", Origin::kReport, "lamps 1 cm to .5 m under a ceiling", "the bright spot is missed",
     "mean of the worst", 0.03, lamps_under_a_ceiling},
    {"unmapped", Origin::kSibling, "lamp of a set .5 m under a ceiling that is a toggle",
     "light by way of it has no term", "mean of the worst of three states", 0.03, ceiling_that_goes},
    {"unmapped", Origin::kSibling, "lamp 9 cm from the wall of a white sphere", "chains of reflections end too early",
     "mean", 0.03, integrating_sphere},
    {"unmapped", Origin::kSibling, "sunlit ground under a card", "the sun is not asked for at once", "mean", 0.01,
     sunlit_ground},
    {"unmapped", Origin::kSibling, "two white plates, one aglow", "chains of reflections end too early", "mean", 0.03,
     two_plates},
};

} // namespace

std::span<const Case> unmapped_cases() { return kCases; }

} // namespace hard
