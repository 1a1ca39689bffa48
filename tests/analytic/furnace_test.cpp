// SPDX-License-Identifier: GPL-3.0-or-later
// White furnace (algorithms.md 12.2): in any closed room of uniform radiance and reflectance the
// irradiance of bounce b is pi Le rho^b at every texel, without noise.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scene_kit.h"

namespace {

void expect_furnace(const kit::MeshData& room, float rho, uint32_t bounces) {
    constexpr float kRadiance = 0.8f;
    kit::Scene scene("furnace");
    scene.instance(scene.mesh(room), scene.emitter({kRadiance, kRadiance, kRadiance}, {rho, rho, rho}),
                   scene.page(64, 64));
    scene.commit();
    ajar_settings s = kit::settings(bounces);
    s.keep_bounces = 1;
    const kit::Bake bake(scene, s);
    const kit::Layer validity = bake.layer(AJAR_LAYER_VALIDITY);
    double total = 0.0;
    for (uint32_t b = 0; b <= bounces; ++b) {
        const double expected = std::numbers::pi * kRadiance * std::pow(rho, b);
        total += expected;
        const kit::Layer e = bake.layer(AJAR_LAYER_BOUNCE + b);
        for (size_t i = 0; i < validity.data.size(); ++i)
            if (validity.data[i] == 1.0f) {
                ASSERT_NEAR(e.data[3 * i] / expected, 1.0, 1e-4) << "bounce " << b << " texel " << i;
            }
    }
    const kit::Layer e = bake.layer(AJAR_LAYER_IRRADIANCE);
    for (size_t i = 0; i < validity.data.size(); ++i)
        if (validity.data[i] == 1.0f) {
            ASSERT_NEAR(e.data[3 * i] / total, 1.0, 1e-4) << "total, texel " << i;
        }
}

TEST(Furnace, CubeEveryBounce) { expect_furnace(kit::box({0, 0, 0}, {2, 3, 1.5f}, true), 0.5f, 4); }
TEST(Furnace, SphereEveryBounce) { expect_furnace(kit::sphere_inside(1.0f, 2), 0.8f, 3); }
TEST(Furnace, ThinRoomEveryBounce) { expect_furnace(kit::box({0, 0, 0}, {4, 4, 0.02f}, true), 0.3f, 2); }

} // namespace
