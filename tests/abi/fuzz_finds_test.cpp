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

} // namespace
