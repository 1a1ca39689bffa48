// SPDX-License-Identifier: GPL-3.0-or-later
// Input that real levels contain and bakers fail on, each with a number (algorithms.md 12.8).
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include "room_kit.h"

namespace {

using std::numbers::pi;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();

/// Scene that collects a floor under a sky of radiance 1: unshadowed irradiance is pi.
struct SkyScene {
    kit::Scene scene;
    uint32_t white = scene.diffuse({0.8f, 0.8f, 0.8f});
    SkyScene() { scene.sky({1, 1, 1}); }
    void add(const kit::MeshData& mesh, uint32_t page, const char* name) {
        scene.instance(scene.mesh(mesh), white, page, name);
    }
};

void expect_finite_layers(const kit::Bake& bake, uint32_t page = 0) {
    for (uint32_t layer :
         {AJAR_LAYER_IRRADIANCE, AJAR_LAYER_STDERR, AJAR_LAYER_SAMPLES, AJAR_LAYER_VALIDITY, AJAR_LAYER_ALBEDO})
        EXPECT_TRUE(kit::all_finite(bake.layer(layer, page))) << layer;
    for (float v : bake.layer(AJAR_LAYER_IRRADIANCE, page).data) EXPECT_GE(v, 0.0f);
}

uint32_t word(const kit::Layer& packed, uint32_t x, uint32_t y, uint32_t channel) {
    uint32_t bits;
    const float f = packed.at(x, y, channel);
    std::memcpy(&bits, &f, 4);
    return bits;
}

ajar_light_desc lamp(uint32_t type, const char* name) {
    ajar_light_desc d;
    ajar_light_desc_init(&d);
    d.type = type;
    d.role = AJAR_ROLE_STATIC;
    d.name = name;
    return d;
}

// ---- broken meshes ---------------------------------------------------------------------------

TEST(HardMesh, NanVertexIsNamedAndTheOtherTriangleIsRight) {
    SkyScene s;
    kit::MeshData plane = kit::plane(2.0f, 0.0f);
    plane.positions[3] = {kNan, 0, 0}; // corner of the upper left triangle
    s.add(plane, s.scene.page(16, 16), "torn floor");
    s.add(kit::plane(2.0f, 5.0f), s.scene.page(16, 16), "roof");
    s.scene.commit();
    EXPECT_TRUE(kit::has_warning(kit::scene_warnings(s.scene), "torn floor", "not finite"));
    const kit::Bake bake(s.scene, kit::settings(0, 1024));
    expect_finite_layers(bake);
    const kit::Layer validity = bake.layer(AJAR_LAYER_VALIDITY), roof = bake.layer(AJAR_LAYER_IRRADIANCE, 1),
                     floor = bake.layer(AJAR_LAYER_IRRADIANCE);
    EXPECT_NEAR(roof.at(8, 8), pi, 1e-3);
    EXPECT_EQ(validity.at(12, 3), 1.0f);
    EXPECT_EQ(validity.at(3, 12), 0.0f);
    EXPECT_GT(floor.at(12, 3), 0.8 * pi); // the roof hides a little of the sky
}

TEST(HardMesh, InfiniteVertexIsTreatedAlike) {
    SkyScene s;
    kit::MeshData plane = kit::plane(2.0f, 0.0f);
    plane.positions[3] = {0, -kInf, 0};
    s.add(plane, s.scene.page(16, 16), "torn floor");
    s.scene.commit();
    EXPECT_TRUE(kit::has_warning(kit::scene_warnings(s.scene), "torn floor", "not finite"));
    EXPECT_NEAR(kit::Bake(s.scene, kit::settings(1)).layer(AJAR_LAYER_IRRADIANCE).at(12, 3), pi, 1e-3);
}

TEST(HardMesh, NanUvsAndNormalsAreNamed) {
    SkyScene s;
    kit::MeshData plane = kit::plane(2.0f, 0.0f);
    plane.normals.assign(6, {0, 0, 1});
    plane.normals[4] = {kNan, kNan, kNan};
    plane.uv[5] = {kNan, 1};
    s.add(plane, s.scene.page(16, 16), "floor");
    s.scene.commit();
    EXPECT_TRUE(kit::has_warning(kit::scene_warnings(s.scene), "mesh", "not finite"));
    const kit::Bake bake(s.scene, kit::settings(1));
    expect_finite_layers(bake);
    EXPECT_NEAR(bake.layer(AJAR_LAYER_IRRADIANCE).at(12, 3), pi, 1e-3);
}

TEST(HardMesh, TrianglesWithoutAreaAreNamedAndLeftOut) {
    SkyScene s;
    kit::MeshData plane = kit::plane(2.0f, 0.0f);
    plane.corners.insert(plane.corners.end(), {0, 0, 0, 0, 1, 1});
    plane.uv.insert(plane.uv.end(),
                    {{0.1f, 0.1f}, {0.9f, 0.1f}, {0.5f, 0.9f}, {0.1f, 0.1f}, {0.9f, 0.1f}, {0.5f, 0.9f}});
    s.add(plane, s.scene.page(16, 16), "floor");
    s.scene.commit();
    EXPECT_TRUE(kit::has_warning(kit::scene_warnings(s.scene), "floor", "2 triangles have no area"));
    const kit::Bake bake(s.scene, kit::settings(1));
    expect_finite_layers(bake);
    EXPECT_NEAR(kit::mean(bake.layer(AJAR_LAYER_IRRADIANCE)), pi, 1e-3);
}

TEST(HardMesh, EmptyMeshIsNamedAndHarmless) {
    SkyScene s;
    s.add({}, AJAR_NONE, "empty occluder");
    ajar_mesh_desc d;
    ajar_mesh_desc_init(&d);
    const float* layers[1] = {nullptr};
    d.uv_layer_count = 1;
    d.uv_layers = layers;
    uint32_t empty = 0;
    kit::check(ajar_scene_add_mesh(s.scene.handle(), &d, &empty));
    const uint32_t page = s.scene.page(16, 16);
    s.scene.instance(empty, s.white, page, "empty wall");
    s.add(kit::plane(2.0f, 0.0f), page, "floor");
    s.scene.commit();
    EXPECT_TRUE(kit::has_warning(kit::scene_warnings(s.scene), "empty wall", "no faces"));
    EXPECT_NEAR(kit::mean(kit::Bake(s.scene, kit::settings(1)).layer(AJAR_LAYER_IRRADIANCE)), pi, 1e-3);
}

TEST(HardMesh, EveryObjectWithoutMaterialIsNamedAndBlack) {
    SkyScene s;
    const uint32_t page = s.scene.page(16, 16), mesh = s.scene.mesh(kit::plane(2.0f, 0.0f)),
                   lid = s.scene.mesh(kit::plane(2.0f, -1.0f));
    ajar_instance_desc d;
    ajar_instance_desc_init(&d);
    uint32_t id;
    for (auto [name, which] : {std::pair{"bare floor", mesh}, {"bare cellar", lid}}) {
        d.name = name;
        d.mesh = which;
        d.surface = which == mesh ? AJAR_SURFACE_LIGHTMAP : AJAR_SURFACE_OCCLUDER;
        d.lightmap_layer = 0;
        d.page = page;
        kit::check(ajar_scene_add_instance(s.scene.handle(), &d, &id));
    }
    s.scene.commit();
    EXPECT_TRUE(kit::has_warning(kit::scene_warnings(s.scene), "bare floor", "no material"));
    EXPECT_TRUE(kit::has_warning(kit::scene_warnings(s.scene), "bare cellar", "no material"));
    const kit::Bake bake(s.scene, kit::settings(2));
    EXPECT_NEAR(kit::mean(bake.layer(AJAR_LAYER_IRRADIANCE)), pi, 1e-3);
    EXPECT_EQ(kit::mean(bake.layer(AJAR_LAYER_ALBEDO)), 0.0);
}

TEST(HardMesh, SliversGetTheLightOfTheirSurface) {
    SkyScene s;
    s.add(kit::sliver_strip(), s.scene.page(32, 32), "strip");
    s.scene.commit();
    const kit::Bake bake(s.scene, kit::settings(1));
    expect_finite_layers(bake);
    for (float v : bake.layer(AJAR_LAYER_IRRADIANCE).data) ASSERT_NEAR(v, pi, 1e-3);
}

TEST(HardMesh, CoplanarDuplicatesDoNotShadowEachOther) {
    kit::Scene scene;
    const uint32_t white = scene.diffuse({0.8f, 0.8f, 0.8f}), mesh = scene.mesh(kit::plane(3.0f, 1.37f));
    const uint32_t page = scene.page(32, 32), twin = scene.page(32, 32);
    scene.instance(mesh, white, page, "floor");
    scene.instance(mesh, white, twin, "floor again");
    ajar_light_desc sun = lamp(AJAR_LIGHT_SUN, "sun");
    sun.energy = 2.0f;
    scene.light(sun, std::array<double, 12>{0.8, 0, 0.6, 0, 0, 1, 0, 0, -0.6, 0, 0.8, 9}.data()); // slanted
    scene.commit();
    const kit::Bake bake(scene, kit::settings(1));
    for (uint32_t p : {page, twin})
        for (float v : bake.layer(AJAR_LAYER_IRRADIANCE, p).data) ASSERT_NEAR(v, 1.6, 1e-3);
}

// ---- lightmap UVs ----------------------------------------------------------------------------

/// Bakes a floor with UVs changed by the caller; returns the report, where UV warnings appear.
std::string report_with_uvs(void (*change)(kit::MeshData&)) {
    SkyScene s;
    kit::MeshData floor = kit::plane(2.0f, 0.0f);
    change(floor);
    s.add(floor, s.scene.page(32, 32), "odd floor");
    const uint32_t good = s.scene.page(8, 8);
    s.add(kit::plane(2.0f, -3.0f), good, "cellar");
    s.scene.commit();
    const kit::Bake bake(s.scene, kit::quick());
    expect_finite_layers(bake);
    expect_finite_layers(bake, good);
    return bake.report();
}

bool names(const std::string& report, const std::string& object, const std::string& text) {
    return report.find(object) != std::string::npos && report.find(text) != std::string::npos;
}

TEST(HardUv, OutsideOfThePageIsNamed) {
    for (float shift : {0.5f, -3.0f, 1e6f, 1e30f}) {
        static float by;
        by = shift;
        const std::string report = report_with_uvs([](kit::MeshData& m) {
            for (kit::Float2& uv : m.uv) uv[0] += by;
        });
        EXPECT_TRUE(names(report, "odd floor", by >= 1e30f ? "no area" : "outside the page")) << shift << report;
    }
}

TEST(HardUv, OverlapIsNamed) {
    const std::string report = report_with_uvs([](kit::MeshData& m) {
        for (int i = 0; i < 3; ++i) m.uv[3 + i] = m.uv[i]; // both triangles in one place
    });
    EXPECT_TRUE(names(report, "odd floor", "overlap")) << report;
}

TEST(HardUv, NoOverlapIsReportedForNeighboursInOneChart) {
    EXPECT_FALSE(names(report_with_uvs([](kit::MeshData&) {}), "odd floor", "overlap"));
}

TEST(HardUv, WithoutAreaIsNamed) {
    const std::string report = report_with_uvs([](kit::MeshData& m) {
        for (kit::Float2& uv : m.uv) uv = {0.4f, 0.4f};
    });
    EXPECT_TRUE(names(report, "odd floor", "no area in the lightmap UVs")) << report;
}

TEST(HardUv, MissingLayerIsRefusedByName) {
    SkyScene s;
    kit::MeshData bare = kit::plane(2.0f, 0.0f);
    bare.uv.clear();
    s.add(bare, s.scene.page(8, 8), "raw wall");
    EXPECT_EQ(ajar_scene_commit(s.scene.handle()), AJAR_ERROR_INPUT);
    EXPECT_STREQ(ajar_error_culprit(), "raw wall");
}

TEST(HardUv, AChartInsideOneTexelIsLit) {
    SkyScene s;
    kit::MeshData pebble;
    pebble.quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {5.2f / 16, 5.3f / 16}, {5.7f / 16, 5.8f / 16});
    s.add(pebble, s.scene.page(16, 16), "pebble");
    s.scene.commit();
    const kit::Bake bake(s.scene, kit::settings(1));
    EXPECT_EQ(bake.layer(AJAR_LAYER_VALIDITY).at(5, 5), 1.0f);
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
            EXPECT_NEAR(bake.layer(AJAR_LAYER_IRRADIANCE).at(5 + dx, 5 + dy), pi, 1e-3) << dx << dy;
    EXPECT_EQ(bake.layer(AJAR_LAYER_VALIDITY).at(12, 12), 0.0f);
}

// ---- lights ----------------------------------------------------------------------------------

TEST(HardLight, WhatSumsCannotHoldIsRefusedByNameAndTheRestIsRight) {
    for (const float watts : {1e34f, 3e37f}) {
        kit::Scene scene;
        scene.instance(scene.mesh(kit::plane(2.0f, 0.0f)), scene.diffuse({0, 0, 0}), scene.page(8, 8));
        ajar_light_desc d = lamp(AJAR_LIGHT_SUN, "star");
        d.energy = watts;
        uint32_t id;
        const ajar_result result = ajar_scene_add_light(scene.handle(), &d, &id);
        if (watts > 1e34f) {
            EXPECT_EQ(result, AJAR_ERROR_INPUT);
            EXPECT_STREQ(ajar_error_culprit(), "star");
            continue;
        }
        scene.commit();
        EXPECT_NEAR(kit::Bake(scene, kit::settings(0, 4096)).layer(AJAR_LAYER_IRRADIANCE).at(4, 4) / watts, 1.0f, 1e-3);
    }
}

TEST(HardLight, ValuesThatAreNotFiniteAreRefusedByName) {
    kit::Scene scene;
    float ajar_light_desc::*const fields[] = {&ajar_light_desc::energy,     &ajar_light_desc::radius,
                                              &ajar_light_desc::spot_angle, &ajar_light_desc::spot_blend,
                                              &ajar_light_desc::sun_angle,  &ajar_light_desc::size_x,
                                              &ajar_light_desc::size_y,     &ajar_light_desc::spread};
    uint32_t id;
    for (float bad : {kNan, kInf, -kInf}) {
        for (auto field : fields) {
            ajar_light_desc d = lamp(AJAR_LIGHT_SPOT, "broken lamp");
            d.*field = bad;
            EXPECT_EQ(ajar_scene_add_light(scene.handle(), &d, &id), AJAR_ERROR_INPUT);
            EXPECT_STREQ(ajar_error_culprit(), "broken lamp");
        }
        ajar_light_desc d = lamp(AJAR_LIGHT_SUN, "broken sun");
        d.color[2] = bad;
        EXPECT_EQ(ajar_scene_add_light(scene.handle(), &d, &id), AJAR_ERROR_INPUT);
        d.color[2] = 1.0f;
        d.transform[7] = bad;
        EXPECT_EQ(ajar_scene_add_light(scene.handle(), &d, &id), AJAR_ERROR_INPUT);
        EXPECT_STREQ(ajar_error_culprit(), "broken sun");
    }
}

TEST(HardLight, PowerZeroOrLessGivesExactlyNothing) {
    kit::Scene scene;
    scene.instance(scene.mesh(kit::plane(2.0f, 0.0f)), scene.diffuse({1, 1, 1}), scene.page(8, 8));
    scene.point_light({0, 0, 1}, 0.0f);
    scene.point_light({0, 0, 1}, -100.0f, 0.1f);
    scene.commit();
    const kit::Bake bake(scene, kit::settings(2));
    expect_finite_layers(bake);
    for (float v : bake.layer(AJAR_LAYER_IRRADIANCE).data) EXPECT_EQ(v, 0.0f);
}

TEST(HardLight, NegativeLightIsNothingAndNamed) {
    kit::Scene scene;
    scene.instance(scene.mesh(kit::plane(2.0f, 0.0f)), scene.diffuse({1, 1, 1}), scene.page(8, 8), "floor");
    ajar_light_desc d = lamp(AJAR_LIGHT_POINT, "dark lamp");
    d.energy = -100.0f;
    scene.light(d, kit::translation(0, 0, 1).data());
    scene.instance(scene.mesh(kit::plane(1.0f, 1.0f, false)), scene.emitter({-3, 2, 2}), AJAR_NONE, "glow");
    scene.sky_image(scene.texture({-1, 2, 2, 1, -1, 2, 2, 1}, 2, 1), {1, 1, 1});
    scene.commit();
    const auto warnings = kit::scene_warnings(scene);
    EXPECT_TRUE(kit::has_warning(warnings, "dark lamp", "negative"));
    EXPECT_TRUE(kit::has_warning(warnings, "material", "negative"));
    EXPECT_TRUE(kit::has_warning(warnings, "texture", "2 texels of the sky's image are below 0"));
    const kit::Bake bake(scene, kit::settings(1));
    expect_finite_layers(bake);
    const kit::Layer e = bake.layer(AJAR_LAYER_IRRADIANCE);
    for (size_t i = 0; i < e.data.size(); i += 3) {
        EXPECT_EQ(e.data[i], 0.0f);
        EXPECT_GT(e.data[i + 1], 0.0f);
    }
}

TEST(HardLight, WhatDiffuseRaysDoNotSeeNeitherShinesNorReflects) {
    // A glowing white sheet over a floor, itself lit from below: seen, it brightens the floor in both ways.
    for (const bool seen : {true, false}) {
        kit::Scene scene;
        scene.instance(scene.mesh(kit::plane(2.0f, 0.0f)), scene.diffuse({0, 0, 0}), scene.page(8, 8), "floor");
        scene.visibility = seen ? AJAR_VISIBLE_GATHER | AJAR_VISIBLE_SHADOW : AJAR_VISIBLE_SHADOW;
        scene.instance(scene.mesh(kit::plane(0.5f, 1.0f, false)), scene.emitter({3, 3, 3}, {0.8f, 0.8f, 0.8f}),
                       scene.page(8, 8), "sheet");
        scene.point_light({0, 0, 0.9f}, 500.0f, 0.0f, true);
        scene.commit();
        ajar_settings s = kit::settings(1);
        s.check_points = 64;
        const kit::Bake bake(scene, s);
        for (const float v : bake.layer(AJAR_LAYER_IRRADIANCE, 0).data) {
            if (seen)
                EXPECT_GT(v, 0.1f);
            else
                EXPECT_EQ(v, 0.0f);
        }
    }
}

TEST(HardLight, SizesOfZeroAreFinite) {
    for (uint32_t type :
         {AJAR_LIGHT_POINT, AJAR_LIGHT_SPOT, AJAR_LIGHT_SUN, AJAR_LIGHT_AREA_RECTANGLE, AJAR_LIGHT_AREA_ELLIPSE}) {
        kit::Scene scene;
        scene.instance(scene.mesh(kit::plane(2.0f, 0.0f)), scene.diffuse({1, 1, 1}), scene.page(8, 8));
        ajar_light_desc d = lamp(type, "tiny");
        d.size_x = d.size_y = d.spread = d.spot_angle = d.sun_angle = 0.0f;
        scene.light(d, kit::translation(0, 0, 1).data());
        scene.light(d, std::array<double, 12>{}.data()); // no orientation at all, on the surface
        scene.commit();
        expect_finite_layers(kit::Bake(scene, kit::quick()));
    }
}

TEST(HardLight, OneMillimetreFromASurfaceIsFiniteAndRightFurtherAway) {
    kit::Scene scene;
    scene.instance(scene.mesh(kit::plane(2.0f, 0.0f)), scene.diffuse({0.5f, 0.5f, 0.5f}), scene.page(33, 33));
    scene.point_light({0, 0, 0.001f}, 1000.0f);
    scene.commit();
    const kit::Bake bake(scene, kit::settings(1));
    expect_finite_layers(bake);
    const kit::Layer e = bake.layer(AJAR_LAYER_IRRADIANCE);
    EXPECT_GT(e.at(16, 16), 1e5f);
    const double r = 10.0 / 33.0 * 2.0; // ten texels away
    EXPECT_NEAR(e.at(26, 16) / (1000.0 / (4 * pi) * 0.001 / (r * r * r)), 1.0, 0.02);
    EXPECT_NE(word(bake.layer(AJAR_LAYER_AHD), 16, 16, 0), 0u);
}

TEST(HardLight, InsideAWallItLightsNothing) {
    kit::Scene scene;
    const uint32_t white = scene.diffuse({0.8f, 0.8f, 0.8f});
    scene.instance(scene.mesh(kit::box({-2, -2, 0}, {2, 2, 3}, true)), white, scene.page(48, 48), "room");
    scene.instance(scene.mesh(kit::box({-0.1f, -2.1f, -0.1f}, {0.1f, 2.1f, 3.1f}, false)), white, AJAR_NONE, "wall");
    for (float radius : {0.0f, 0.05f}) scene.point_light({0, 0.3f, 1.5f}, 100.0f, radius);
    scene.commit();
    const kit::Bake bake(scene, kit::quick());
    const kit::Layer e = bake.layer(AJAR_LAYER_IRRADIANCE), validity = bake.layer(AJAR_LAYER_VALIDITY);
    double lit = 0.0;
    for (size_t i = 0; i < validity.data.size(); ++i)
        if (validity.data[i] == 1.0f) lit = std::max<double>(lit, e.data[3 * i]);
    // Texels that the wall cuts have positions inside it.
    EXPECT_TRUE(kit::all_finite(e));
    EXPECT_EQ(e.at(4, 4), 0.0f);
    EXPECT_EQ(lit, 0.0) << "valid texels see a light that sits in a closed wall";
}

TEST(HardLight, HugePowersStayFinite) {
    for (float watts : {1e12f, 1e30f}) {
        kit::Scene scene;
        scene.instance(scene.mesh(kit::plane(2.0f, 0.0f)), scene.diffuse({0.5f, 0.5f, 0.5f}), scene.page(8, 8));
        scene.point_light({0, 0, 1}, watts, 0.1f);
        scene.commit();
        const kit::Bake bake(scene, kit::settings(2));
        EXPECT_TRUE(kit::all_finite(bake.layer(AJAR_LAYER_IRRADIANCE))) << watts;
        EXPECT_NEAR(bake.layer(AJAR_LAYER_IRRADIANCE).at(4, 4) / watts, 1.0 / (4 * pi), 0.01) << watts;
        EXPECT_TRUE(kit::all_finite(bake.layer(AJAR_LAYER_STDERR))) << watts;
    }
}

// ---- rooms -----------------------------------------------------------------------------------

TEST(HardRoom, BlackWithoutLight) {
    kit::Scene scene;
    scene.instance(scene.mesh(kit::box({0, 0, 0}, {2, 2, 2}, true)), scene.diffuse({0, 0, 0}), scene.page(32, 32));
    scene.commit();
    ajar_settings s = kit::settings(2);
    s.noise_target = 0.05f;
    s.keep_sh = s.stitch_seams = 1;
    const kit::Bake bake(scene, s);
    expect_finite_layers(bake);
    for (float v : bake.layer(AJAR_LAYER_IRRADIANCE).data) ASSERT_EQ(v, 0.0f);
    for (float v : bake.layer(AJAR_LAYER_SH).data) ASSERT_EQ(v, 0.0f);
    const kit::Layer packed = bake.layer(AJAR_LAYER_AHD);
    for (uint32_t i = 0; i < 32; ++i) {
        EXPECT_EQ(word(packed, i, i, 0), 0u);
        EXPECT_EQ(word(packed, i, i, 1), 0xffff8080u) << "ratio 1, direction z";
    }
}

TEST(HardRoom, AlbedoOneIsClampedAndFinite) {
    kit::Scene scene;
    scene.instance(scene.mesh(kit::box({0, 0, 0}, {2, 2, 2}, true)), scene.emitter({1, 1, 1}, {1, 1, 1}),
                   scene.page(32, 32), "mirror room");
    scene.commit();
    constexpr uint32_t kBounces = 64;
    const kit::Bake bake(scene, kit::settings(kBounces, 64));
    const kit::Layer albedo = bake.layer(AJAR_LAYER_ALBEDO);
    EXPECT_LT(albedo.at(4, 4), 1.0f);
    EXPECT_GT(albedo.at(4, 4), 0.9f);
    const double rho = albedo.at(4, 4), expected = pi * (1.0 - std::pow(rho, kBounces + 1)) / (1.0 - rho);
    EXPECT_NEAR(bake.layer(AJAR_LAYER_IRRADIANCE).at(4, 4) / expected, 1.0, 1e-3);
    EXPECT_NE(bake.report().find("mirror room"), std::string::npos) << "clamping is named";
}

double brightest(const kit::Layer& e) {
    double most = 0.0;
    for (float v : e.data) most = std::max<double>(most, v);
    return most;
}

TEST(HardRoom, FiveMillimetreWallLeaksNothing) {
    kit::Scene scene;
    const uint32_t white = scene.diffuse({0.9f, 0.9f, 0.9f});
    const uint32_t bright = scene.page(48, 48), dark = scene.page(48, 48);
    scene.instance(scene.mesh(kit::box({0, 0, 0}, {2, 2, 2}, true)), white, bright, "bright room");
    scene.instance(scene.mesh(kit::box({2.005f, 0, 0}, {4, 2, 2}, true)), white, dark, "dark room");
    scene.point_light({1.5f, 1.0f, 1.0f}, 1000.0f, 0.1f);
    scene.commit();
    const kit::Bake bake(scene, kit::settings(4, 512));
    EXPECT_GT(kit::mean(bake.layer(AJAR_LAYER_IRRADIANCE, bright)), 10.0);
    EXPECT_EQ(brightest(bake.layer(AJAR_LAYER_IRRADIANCE, dark)), 0.0);
}

TEST(HardRoom, FiveMillimetrePartitionInsideOneRoom) {
    kit::Scene scene;
    const uint32_t white = scene.diffuse({0.9f, 0.9f, 0.9f});
    kit::MeshData floor, shell = kit::box({-2, -1, -0.01f}, {2, 1, 2}, true);
    floor.quad({-2, -1, 0}, {2, -1, 0}, {2, 1, 0}, {-2, 1, 0}, {0, 0}, {1, 1});
    const uint32_t page = scene.page(40, 20);
    scene.instance(scene.mesh(floor), white, page, "floor");
    scene.instance(scene.mesh(shell), white, AJAR_NONE, "shell");
    scene.instance(scene.mesh(kit::box({0.0475f, -1, -0.01f}, {0.0525f, 1, 2}, false)), white, AJAR_NONE,
                   "partition"); // ends flush with the shell
    scene.point_light({-1, 0, 1.5f}, 1000.0f, 0.1f);
    scene.commit();
    const kit::Layer e = kit::Bake(scene, kit::settings(3, 512)).layer(AJAR_LAYER_IRRADIANCE);
    EXPECT_GT(kit::mean(e, 0, 0, 19, 20), 10.0);
    for (uint32_t y = 0; y < 20; ++y)
        for (uint32_t x = 21; x < 40; ++x) EXPECT_EQ(e.at(x, y), 0.0f) << x << ' ' << y;
}

TEST(HardRoom, TexelHalfUnderABoxKeepsTheLightOfItsVisibleHalf) {
    SkyScene s;
    constexpr uint32_t kSize = 32; // texels of 0.125 m; the box covers x in [-0.5625, 0.5625]: half texels
    s.add(kit::plane(4.0f, 0.0f), s.scene.page(kSize, kSize), "floor");
    s.scene.instance(s.scene.mesh(kit::box({-0.5625f, -0.5625f, 0}, {0.5625f, 0.5625f, 0.3f}, false)),
                     s.scene.diffuse({0, 0, 0}), AJAR_NONE, "crate");
    s.scene.commit();
    const kit::Bake bake(s.scene, kit::settings(0, 1024));
    const kit::Layer e = bake.layer(AJAR_LAYER_IRRADIANCE), validity = bake.layer(AJAR_LAYER_VALIDITY);
    // Columns 11 and 20 lie half under the crate.
    for (uint32_t y = 14; y < 18; ++y) {
        // 0.794 is the ratio of the visible half's own mean (numerical integration).
        EXPECT_NEAR(e.at(11, y) / e.at(10, y), 0.794, 0.08) << y;
        EXPECT_NEAR(e.at(20, y) / e.at(21, y), 0.794, 0.08) << y;
        EXPECT_EQ(validity.at(10, y), 1.0f);
        for (uint32_t x = 13; x < 19; ++x) EXPECT_EQ(validity.at(x, y), 0.5f) << x << ' ' << y;
    }
    for (float v : e.data) EXPECT_GT(v, 0.2f) << "nothing stays black under the crate";
}

TEST(HardRoom, TexelHalfUnderAPlateKeepsTheLightOfItsVisibleHalf) {
    SkyScene s;
    constexpr uint32_t kSize = 32; // texels of 0.125 m; the plate covers half of column 11 and hangs 1 cm above it
    s.add(kit::plane(4.0f, 0.0f), s.scene.page(kSize, kSize), "floor");
    s.scene.instance(s.scene.mesh(kit::box({-0.5625f, -0.5625f, 0.010f}, {0.5625f, 0.5625f, 0.012f}, false)),
                     s.scene.diffuse({0, 0, 0}), AJAR_NONE, "plate");
    s.scene.commit();
    const kit::Layer e = kit::Bake(s.scene, kit::settings(0, 1024)).layer(AJAR_LAYER_IRRADIANCE);
    for (uint32_t y = 14; y < 18; ++y) {
        // The plate's edge takes 8 % of the light from the visible half (a strip's form factor, averaged).
        EXPECT_NEAR(e.at(11, y) / e.at(8, y), 0.92, 0.04) << y;
        EXPECT_LT(e.at(13, y), 0.1f) << "wholly under it";
    }
}

TEST(HardRoom, AMillionToOneBetweenNeighbouringRooms) {
    kit::Scene scene;
    const uint32_t grey = scene.diffuse({0.5f, 0.5f, 0.5f});
    uint32_t page[2];
    for (int i = 0; i < 2; ++i) {
        page[i] = scene.page(32, 32);
        const auto x = 2.5f * static_cast<float>(i);
        scene.instance(scene.mesh(kit::box({x, 0, 0}, {x + 2, 2, 2}, true)), grey, page[i], "room");
        scene.point_light({x + 1, 1, 1.5f}, i == 0 ? 1000.0f : 0.001f);
    }
    scene.commit();
    const kit::Bake bake(scene, kit::settings(2, 256));
    const double bright = kit::mean(bake.layer(AJAR_LAYER_IRRADIANCE, page[0])),
                 dim = kit::mean(bake.layer(AJAR_LAYER_IRRADIANCE, page[1]));
    EXPECT_NEAR(dim / bright * 1e6, 1.0, 0.02); // four standard deviations of ten seeds
}

// ---- scale -----------------------------------------------------------------------------------

TEST(HardScale, TooWideASceneIsRefusedNamingTheFarObject) {
    SkyScene s;
    s.add(kit::plane(2.0f, 0.0f), s.scene.page(8, 8), "floor");
    s.scene.instance(s.scene.mesh(kit::plane(2.0f, 0.0f)), s.white, AJAR_NONE, "lost satellite",
                     kit::translation(1e5, 0, 0).data());
    EXPECT_EQ(ajar_scene_commit(s.scene.handle()), AJAR_ERROR_INPUT);
    EXPECT_STREQ(ajar_error_culprit(), "lost satellite");
}

TEST(HardScale, OneStrayVertexFarFromALevelAtThousandsOfMetresIsNamed) {
    SkyScene s; // the level lies further from zero than the stray object does from the level
    s.scene.instance(s.scene.mesh(kit::plane(2.0f, 0.0f)), s.white, s.scene.page(8, 8), "level",
                     kit::translation(2e5, 0, 0).data());
    s.scene.instance(s.scene.mesh(kit::plane(3.0f, 0.0f)), s.white, AJAR_NONE, "level too",
                     kit::translation(2e5 + 4, 0, 0).data());
    s.scene.instance(s.scene.mesh(kit::plane(2.0f, 0.0f)), s.white, AJAR_NONE, "stray",
                     kit::translation(1e5, 0, 0).data());
    EXPECT_EQ(ajar_scene_commit(s.scene.handle()), AJAR_ERROR_INPUT);
    EXPECT_STREQ(ajar_error_culprit(), "stray");
}

TEST(HardScale, OverflowingTransformsAreRefusedOrLeftOut) {
    for (double huge : {1e30, 1e200, 1e308}) {
        SkyScene s;
        s.add(kit::plane(2.0f, 0.0f), s.scene.page(8, 8), "floor");
        s.scene.instance(s.scene.mesh(kit::plane(2.0f, 0.0f)), s.white, AJAR_NONE, "monster",
                         std::array<double, 12>{huge, 0, 0, 0, 0, huge, 0, 0, 0, 0, huge, 0}.data());
        EXPECT_EQ(ajar_scene_commit(s.scene.handle()), AJAR_ERROR_INPUT) << huge;
        EXPECT_STREQ(ajar_error_culprit(), "monster");
    }
}

} // namespace
