// SPDX-License-Identifier: GPL-3.0-or-later
// What random calls found and was mended.
#include <gtest/gtest.h>

#include "room_kit.h"

namespace {

TEST(FuzzFinds, LightmapUvsTooFarOutsideToReckonWithAreHarmless) {
    kit::Scene scene;
    kit::MeshData room = kit::box({-2, -2, 0}, {2, 2, 3}, true);
    for (size_t corner = 3; corner < room.uv.size(); corner += 6) room.uv[corner][1] = -3.4e38f;
    scene.instance(scene.mesh(room), scene.diffuse({0.5f, 0.5f, 0.5f}), scene.page(20, 1));
    scene.point_light({0, 0, 2}, 60.0f);
    scene.commit();
    const kit::Bake bake(scene, kit::quick());
    EXPECT_TRUE(kit::all_finite(bake.layer(AJAR_LAYER_IRRADIANCE)));
}

/// A white floor in shells of a material that reflects and lets through all light at once.
uint64_t rays_among_shells(int shells) {
    kit::Scene scene;
    ajar_closure closures[2];
    for (ajar_closure& c : closures) ajar_closure_init(&c);
    closures[1].type = AJAR_CLOSURE_TRANSPARENT;
    const uint32_t both = scene.material({closures[0], closures[1]});
    const uint32_t page = scene.page(2, 2);
    scene.instance(scene.mesh(kit::plane(1.0f, 0.0f)), scene.diffuse({0.5f, 0.5f, 0.5f}), page);
    for (int i = 0; i < shells; ++i) {
        const float r = 1.0f + 0.1f * static_cast<float>(i);
        scene.instance(scene.mesh(kit::box({-r, -r, -r}, {r, r, r}, true)), both, AJAR_NONE, "shell");
    }
    scene.point_light({0, 0, 0.5f}, 10.0f);
    scene.commit();
    ajar_settings s = kit::quick();
    s.samples = 8;
    s.bounces = 1;
    const kit::Bake bake(scene, s);
    ajar_progress progress;
    ajar_progress_init(&progress);
    kit::check(ajar_job_poll(bake.handle(), &progress));
    return progress.rays;
}

TEST(FuzzFinds, LayersThatReflectAndLetThroughDoNotMultiplyRaysWithoutEnd) {
    EXPECT_LT(rays_among_shells(8), 10000 * rays_among_shells(0));
}

} // namespace
