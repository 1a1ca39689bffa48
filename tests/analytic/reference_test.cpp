// SPDX-License-Identifier: GPL-3.0-or-later
// Closed forms that the reference integrator must meet (algorithms.md 12); the baker is not asked.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scene_kit.h"
#include "statistics.h"

namespace {

using std::numbers::pi;

/// Mean of the irradiance over all points, with its standard error.
kit::Sample mean_of(const std::vector<ajar_reference_point>& points) {
    kit::Sample s;
    for (const auto& p : points) s.add(p.irradiance[0]);
    return s;
}

/// How often |difference| exceeds two standard errors; 5 % is expected.
template <class Expected>
double share_beyond_two_sigma(const std::vector<ajar_reference_point>& points, Expected expected) {
    double beyond = 0.0;
    for (const auto& p : points) beyond += std::abs(p.irradiance[1] - expected(p)) > 2.0 * p.standard_error;
    return beyond / static_cast<double>(points.size());
}

/// White furnace: bounce b brings pi Le rho^b everywhere.
void expect_furnace(const kit::MeshData& room, float rho, uint32_t bounces) {
    kit::Scene scene("furnace");
    scene.instance(scene.mesh(room), scene.emitter({0.8f, 0.8f, 0.8f}, {rho, rho, rho}), scene.page(64, 64));
    scene.commit();
    double expected = 0.0;
    for (uint32_t b = 0; b <= bounces; ++b) expected += pi * 0.8 * std::pow(rho, b);
    const auto points = kit::trace(scene, kit::reference_settings(bounces, 100, 128));
    const kit::Sample mean = mean_of(points);
    EXPECT_NEAR(mean.mean() / expected, 1.0, 0.01);
    EXPECT_LT(share_beyond_two_sigma(points, [&](const auto&) { return expected; }), 0.2);
}

TEST(Reference, FurnaceOfACube) { expect_furnace(kit::box({0, 0, 0}, {2, 3, 1.5f}, true), 0.5f, 4); }
TEST(Reference, FurnaceOfASphere) { expect_furnace(kit::sphere_inside(1.0f, 2), 0.8f, 3); }
TEST(Reference, FurnaceWithoutBounces) { expect_furnace(kit::box({0, 0, 0}, {2, 3, 1.5f}, true), 0.5f, 0); }

TEST(Reference, UniformSkyOnAPlaneHasNoNoise) {
    kit::Scene scene;
    scene.instance(scene.mesh(kit::plane(4.0f, 0.0f)), scene.diffuse({0.9f, 0.9f, 0.9f}), scene.page(16, 16));
    scene.sky({2.0f, 1.0f, 0.5f});
    scene.commit();
    for (const auto& p : kit::trace(scene, kit::reference_settings(3, 50, 4))) {
        ASSERT_NEAR(p.irradiance[0] / (2.0 * pi), 1.0, 1e-4);
        ASSERT_NEAR(p.irradiance[2] / (0.5 * pi), 1.0, 1e-4);
    }
}

TEST(Reference, TiltedNormalUnderAUniformSky) {
    // pi L (1 + cos) / 2: the part of the sky below the surface is cut off.
    kit::Scene scene;
    scene.instance(scene.mesh(kit::plane(4.0f, 0.0f)), scene.diffuse({0.9f, 0.9f, 0.9f}), scene.page(16, 16));
    scene.sky({1.0f, 1.0f, 1.0f});
    scene.commit();
    ajar_reference_settings s = kit::reference_settings(1, 100, 64);
    const double tilt = pi / 3;
    s.normal[0] = static_cast<float>(std::sin(tilt));
    s.normal[2] = static_cast<float>(std::cos(tilt));
    EXPECT_NEAR(mean_of(kit::trace(scene, s)).mean() / (pi * (1.0 + std::cos(tilt)) / 2.0), 1.0, 0.01);
}

/// Irradiance below a rectangle parallel to the receiver, by the four corners' view factors
/// (algorithms.md 12.4): x0..x1, y0..y1 relative to the point, h above it, radiance 1.
double rectangle(double x0, double x1, double y0, double y1, double h) {
    const auto corner = [h](double x, double y) {
        const double a = std::sqrt(x * x + h * h), b = std::sqrt(y * y + h * h);
        return 0.5 * (x / a * std::atan(y / a) + y / b * std::atan(x / b));
    };
    return corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0);
}

/// Where a point on kit::plane(4) lies.
struct Spot {
    double x, y;
};
Spot spot_of(const ajar_reference_point& p) {
    const double corner[2][3][2] = {{{-2, -2}, {2, -2}, {2, 2}}, {{-2, -2}, {2, 2}, {-2, 2}}};
    const auto& c = corner[p.triangle];
    return {c[0][0] + p.u * (c[1][0] - c[0][0]) + p.v * (c[2][0] - c[0][0]),
            c[0][1] + p.u * (c[1][1] - c[0][1]) + p.v * (c[2][1] - c[0][1])};
}

void expect_rectangle(kit::Scene& scene, double radiance) {
    scene.instance(scene.mesh(kit::plane(4.0f, 0.0f)), scene.diffuse({0.5f, 0.5f, 0.5f}), scene.page(16, 16));
    scene.commit();
    ajar_reference_settings s = kit::reference_settings(0, 200, 64);
    s.texel_mean = 0;
    const auto points = kit::trace(scene, s);
    const auto expected = [&](const ajar_reference_point& p) {
        const Spot at = spot_of(p);
        return radiance * rectangle(-0.5 - at.x, 0.7 - at.x, -0.4 - at.y, 0.3 - at.y, 1.0);
    };
    double sum = 0.0, wanted = 0.0;
    for (const auto& p : points) sum += p.irradiance[1], wanted += expected(p);
    EXPECT_NEAR(sum / wanted, 1.0, 0.005);
    EXPECT_LT(share_beyond_two_sigma(points, expected), 0.12);
}

TEST(Reference, EmissiveRectangleOnAPlane) {
    kit::Scene scene;
    kit::MeshData lamp;
    lamp.quad({-0.5f, 0.3f, 1.0f}, {0.7f, 0.3f, 1.0f}, {0.7f, -0.4f, 1.0f}, {-0.5f, -0.4f, 1.0f}, {0, 0}, {1, 1});
    scene.instance(scene.mesh(lamp), scene.emitter({3, 3, 3}), AJAR_NONE);
    expect_rectangle(scene, 3.0);
}

TEST(Reference, AreaLampOnAPlane) {
    kit::Scene scene;
    ajar_light_desc d;
    ajar_light_desc_init(&d);
    d.type = AJAR_LIGHT_AREA_RECTANGLE;
    d.role = AJAR_ROLE_STATIC;
    d.energy = 60.0f;
    d.size_x = 1.2f;
    d.size_y = 0.7f;
    scene.light(d, kit::translation(0.1, -0.05, 1.0).data());
    expect_rectangle(scene, 60.0 / (4.0 * 1.2 * 0.7));
}

TEST(Reference, PointLampOnAPlaneHasNoNoise) {
    kit::Scene scene;
    scene.instance(scene.mesh(kit::plane(4.0f, 0.0f)), scene.diffuse({0.5f, 0.5f, 0.5f}), scene.page(16, 16));
    scene.point_light({0.3f, -0.2f, 1.5f}, 100.0f);
    scene.commit();
    ajar_reference_settings s = kit::reference_settings(0, 100, 4);
    s.texel_mean = 0;
    for (const auto& p : kit::trace(scene, s)) {
        const Spot at = spot_of(p);
        const double x = at.x - 0.3, y = at.y + 0.2, r = std::sqrt(x * x + y * y + 1.5 * 1.5);
        ASSERT_NEAR(p.irradiance[1] / (100.0 / (4.0 * pi) * 1.5 / (r * r * r)), 1.0, 1e-4);
    }
}

TEST(Reference, PrimaryLampInASphereLightsItEvenly) {
    // rho Phi / (4 pi R^2 (1 - rho)), less the bounces left out (algorithms.md 12.3).
    constexpr float kRho = 0.5f, kWatts = 40.0f;
    constexpr uint32_t kBounces = 10;
    const auto indirect = [&](int subdivisions) {
        kit::Scene scene;
        scene.instance(scene.mesh(kit::sphere_inside(1.0f, subdivisions)), scene.diffuse({kRho, kRho, kRho}),
                       scene.page(512, 512));
        scene.point_light({0.3f, 0.2f, -0.1f}, kWatts, 0.0f, true);
        scene.commit();
        ajar_reference_settings s = kit::reference_settings(kBounces, 1000, 16);
        s.texel_mean = 0;
        return mean_of(kit::trace(scene, s));
    };
    const kit::Sample coarse = indirect(2), fine = indirect(3);
    const double extrapolated = fine.mean() + (fine.mean() - coarse.mean()) / 3.0;
    const double expected = kRho * kWatts / (4.0 * pi * (1.0 - kRho)) * (1.0 - std::pow(kRho, kBounces));
    EXPECT_NEAR(extrapolated / expected, 1.0, 0.005);
}

} // namespace
