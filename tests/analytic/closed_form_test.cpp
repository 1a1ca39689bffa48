// SPDX-License-Identifier: GPL-3.0-or-later
// Closed forms of direct and bounced light (algorithms.md 12).
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scene_kit.h"

namespace {

using std::numbers::pi;

struct Vec {
    double x, y, z;
    Vec operator-(const Vec& o) const { return {x - o.x, y - o.y, z - o.z}; }
    double dot(const Vec& o) const { return x * o.x + y * o.y + z * o.z; }
    Vec cross(const Vec& o) const { return {y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x}; }
    double length() const { return std::sqrt(dot(*this)); }
};

/// Irradiance from a polygon of radiance 1 on a point with normal +z, polygon above the horizon
/// (Lambert's sum, algorithms.md 12.4).
double lambert(const std::vector<Vec>& corners, const Vec& p) {
    double sum = 0.0;
    for (size_t i = 0; i < corners.size(); ++i) {
        Vec a = corners[i] - p, b = corners[(i + 1) % corners.size()] - p;
        const Vec n = a.cross(b);
        sum += std::acos(a.dot(b) / (a.length() * b.length())) * n.z / n.length();
    }
    return 0.5 * std::abs(sum);
}

/// Mean of lambert over a texel of a square plane at z = 0.
double lambert_texel(const std::vector<Vec>& corners, uint32_t x, uint32_t y, uint32_t size, float edge) {
    double sum = 0.0;
    for (int i = 0; i < 64; ++i)
        sum += lambert(corners, {(x + (i % 8 + 0.5) / 8) / size * edge - edge / 2,
                                 (y + (i / 8 + 0.5) / 8) / size * edge - edge / 2, 0.0});
    return sum / 64.0;
}

Vec texel_position(uint32_t x, uint32_t y, uint32_t size, float edge) {
    return {(x + 0.5) / size * edge - edge / 2, (y + 0.5) / size * edge - edge / 2, 0.0};
}

TEST(ClosedForm, PointLightOnPlane) {
    kit::Scene scene;
    constexpr uint32_t kSize = 64;
    scene.instance(scene.mesh(kit::plane(4.0f, 0.0f)), scene.diffuse({0.5f, 0.5f, 0.5f}), scene.page(kSize, kSize));
    scene.point_light({0.3f, -0.2f, 1.5f}, 100.0f);
    scene.commit();
    const kit::Layer e = kit::Bake(scene, kit::settings(0)).layer(AJAR_LAYER_IRRADIANCE);
    for (uint32_t y = 0; y < kSize; y += 3)
        for (uint32_t x = 0; x < kSize; x += 3) {
            const Vec d = Vec{0.3, -0.2, 1.5} - texel_position(x, y, kSize, 4.0f);
            const double r = d.length(), expected = 100.0 / (4.0 * pi) * d.z / (r * r * r);
            ASSERT_NEAR(e.at(x, y) / expected, 1.0, 0.005) << x << ' ' << y;
        }
}

TEST(ClosedForm, UniformSkyOnPlane) {
    kit::Scene scene;
    scene.instance(scene.mesh(kit::plane(4.0f, 0.0f)), scene.diffuse({0.9f, 0.9f, 0.9f}), scene.page(16, 16));
    scene.sky({2.0f, 1.0f, 0.5f});
    scene.commit();
    const kit::Layer e = kit::Bake(scene, kit::settings(3)).layer(AJAR_LAYER_IRRADIANCE);
    for (size_t i = 0; i < e.data.size() / 3; ++i) ASSERT_NEAR(e.data[3 * i] / (2.0 * pi), 1.0, 1e-4);
    for (size_t i = 0; i < e.data.size() / 3; ++i) ASSERT_NEAR(e.data[3 * i + 2] / (0.5 * pi), 1.0, 1e-4);
}

TEST(ClosedForm, EmissiveRectangleOnPlane) {
    kit::Scene scene;
    constexpr uint32_t kSize = 16;
    scene.instance(scene.mesh(kit::plane(4.0f, 0.0f)), scene.diffuse({0.5f, 0.5f, 0.5f}), scene.page(kSize, kSize));
    kit::MeshData lamp;
    lamp.quad({-0.5f, 0.3f, 1.0f}, {0.7f, 0.3f, 1.0f}, {0.7f, -0.4f, 1.0f}, {-0.5f, -0.4f, 1.0f}, {0, 0}, {1, 1});
    scene.instance(scene.mesh(lamp), scene.emitter({3, 3, 3}), AJAR_NONE);
    scene.commit();
    ajar_settings s = kit::settings(0, 8192);
    s.direct_samples = 8192;
    const kit::Layer e = kit::Bake(scene, s).layer(AJAR_LAYER_IRRADIANCE);
    for (uint32_t y = 0; y < kSize; ++y)
        for (uint32_t x = 0; x < kSize; ++x) {
            const double expected =
                3.0 *
                lambert_texel({{-0.5, 0.3, 1}, {0.7, 0.3, 1}, {0.7, -0.4, 1}, {-0.5, -0.4, 1}}, x, y, kSize, 4.0f);
            ASSERT_NEAR(e.at(x, y) / expected, 1.0, 0.005) << x << ' ' << y;
        }
}

TEST(ClosedForm, AreaLampEqualsItsRadiance) {
    kit::Scene scene;
    constexpr uint32_t kSize = 16;
    scene.instance(scene.mesh(kit::plane(4.0f, 0.0f)), scene.diffuse({0.5f, 0.5f, 0.5f}), scene.page(kSize, kSize));
    ajar_light_desc d;
    ajar_light_desc_init(&d);
    d.name = "area";
    d.type = AJAR_LIGHT_AREA_RECTANGLE;
    d.role = AJAR_ROLE_STATIC;
    d.energy = 60.0f;
    d.size_x = 1.2f;
    d.size_y = 0.7f;
    scene.light(d, kit::translation(0.1, -0.05, 1.0).data());
    scene.commit();
    ajar_settings s = kit::settings(0);
    s.direct_samples = 8192;
    const kit::Layer e = kit::Bake(scene, s).layer(AJAR_LAYER_IRRADIANCE);
    const double radiance = 60.0 / (4.0 * 1.2 * 0.7);
    for (uint32_t y = 0; y < kSize; ++y)
        for (uint32_t x = 0; x < kSize; ++x) {
            const double expected =
                radiance *
                lambert_texel({{-0.5, 0.3, 1}, {0.7, 0.3, 1}, {0.7, -0.4, 1}, {-0.5, -0.4, 1}}, x, y, kSize, 4.0f);
            ASSERT_NEAR(e.at(x, y) / expected, 1.0, 0.005) << x << ' ' << y;
        }
}

/// A square receiver in a closed black box whose lid has a rectangular hole: only the hole shows the sky.
struct HoleInWall {
    static constexpr uint32_t kSize = 8;
    static constexpr float kEdge = 0.5f, kW = 20.0f, kH = 1.0f;
    float x0, x1, y0, y1; ///< the hole
    kit::Scene scene;

    HoleInWall(float left, float right, float low, float high) : x0(left), x1(right), y0(low), y1(high) {
        scene.instance(scene.mesh(kit::plane(kEdge, 0.0f)), scene.diffuse({0.5f, 0.5f, 0.5f}),
                       scene.page(kSize, kSize));
        kit::MeshData shell;
        shell.quad({-kW, -kW, kH}, {x0, -kW, kH}, {x0, kW, kH}, {-kW, kW, kH}, {0, 0}, {1, 1});
        shell.quad({x1, -kW, kH}, {kW, -kW, kH}, {kW, kW, kH}, {x1, kW, kH}, {0, 0}, {1, 1});
        shell.quad({x0, -kW, kH}, {x1, -kW, kH}, {x1, y0, kH}, {x0, y0, kH}, {0, 0}, {1, 1});
        shell.quad({x0, y1, kH}, {x1, y1, kH}, {x1, kW, kH}, {x0, kW, kH}, {0, 0}, {1, 1});
        shell.quad({-kW, -kW, -1}, {kW, -kW, -1}, {kW, -kW, kH}, {-kW, -kW, kH}, {0, 0}, {1, 1});
        shell.quad({-kW, kW, -1}, {kW, kW, -1}, {kW, kW, kH}, {-kW, kW, kH}, {0, 0}, {1, 1});
        shell.quad({-kW, -kW, -1}, {-kW, kW, -1}, {-kW, kW, kH}, {-kW, -kW, kH}, {0, 0}, {1, 1});
        shell.quad({kW, -kW, -1}, {kW, kW, -1}, {kW, kW, kH}, {kW, -kW, kH}, {0, 0}, {1, 1});
        shell.quad({-kW, -kW, -1}, {-kW, kW, -1}, {kW, kW, -1}, {kW, -kW, -1}, {0, 0}, {1, 1});
        scene.instance(scene.mesh(shell), scene.diffuse({0, 0, 0}), AJAR_NONE);
        scene.sky({1, 1, 1});
    }
    void expect(const kit::Layer& e) const {
        for (uint32_t y = 0; y < kSize; ++y)
            for (uint32_t x = 0; x < kSize; ++x) {
                const double expected =
                    lambert_texel({{x0, y0, kH}, {x1, y0, kH}, {x1, y1, kH}, {x0, y1, kH}}, x, y, kSize, kEdge);
                ASSERT_NEAR(e.at(x, y) / expected, 1.0, 0.005) << x << ' ' << y;
            }
    }
};

TEST(ClosedForm, HoleInWallBeforeSky) {
    HoleInWall hole(-0.4f, 0.6f, -0.3f, 0.5f);
    hole.scene.commit();
    hole.expect(kit::Bake(hole.scene, kit::settings(1, 1 << 17)).layer(AJAR_LAYER_IRRADIANCE));
}

TEST(ClosedForm, DoorBeforeSky) {
    // A black leaf lies over the hole: closed it is dark, open it is the hole. Most rays aim at the leaf's box.
    using Hole = HoleInWall;
    Hole hole(-0.1f, 0.15f, -0.08f, 0.12f);
    hole.scene.current_switch = hole.scene.element(AJAR_ELEMENT_DOOR, "door", false);
    const kit::MeshData leaf = kit::box({hole.x0 - 0.1f, hole.y0 - 0.1f, Hole::kH + 0.01f},
                                        {hole.x1 + 0.1f, hole.y1 + 0.1f, Hole::kH + 0.05f}, false);
    hole.scene.instance(hole.scene.mesh(leaf), hole.scene.diffuse({0, 0, 0}), AJAR_NONE);
    hole.scene.current_switch = AJAR_NONE;
    hole.scene.commit();
    ajar_settings s = kit::settings(1, 1 << 14);
    s.door_rays = 1.0f;
    const kit::Bake bake(hole.scene, s);
    ASSERT_EQ(bake.terms().size(), 2u);
    const kit::Layer closed = bake.term(0, Hole::kSize, Hole::kSize);
    for (const float e : closed.data) ASSERT_EQ(e, 0.0f);
    hole.expect(bake.term(1, Hole::kSize, Hole::kSize));
}

TEST(ClosedForm, LambertianSphereIndirect) {
    // Any light inside a sphere gives uniform indirect light rho Phi / (4 pi R^2 (1 - rho))
    // (algorithms.md 12.3); two tessellations extrapolate to the round sphere.
    constexpr float kRho = 0.5f, kWatts = 40.0f;
    constexpr uint32_t kBounces = 24;
    const auto mean_irradiance = [&](int subdivisions) {
        kit::Scene scene;
        scene.instance(scene.mesh(kit::sphere_inside(1.0f, subdivisions)), scene.diffuse({kRho, kRho, kRho}),
                       scene.page(512, 512));
        scene.point_light({0.3f, 0.2f, -0.1f}, kWatts, 0.0f, true);
        scene.commit();
        ajar_settings s = kit::settings(kBounces, 256);
        const kit::Bake bake(scene, s);
        const kit::Layer e = bake.layer(AJAR_LAYER_IRRADIANCE), v = bake.layer(AJAR_LAYER_VALIDITY);
        double sum = 0.0, count = 0.0;
        for (size_t i = 0; i < v.data.size(); ++i)
            if (v.data[i] == 1.0f) sum += e.data[3 * i], count += 1.0;
        return sum / count;
    };
    const double coarse = mean_irradiance(3), fine = mean_irradiance(4);
    const double extrapolated = fine + (fine - coarse) / 3.0;
    const double expected = kRho * kWatts / (4.0 * pi * (1.0 - kRho));
    EXPECT_NEAR(extrapolated / expected, 1.0, 0.005) << coarse << ' ' << fine;
}

} // namespace
