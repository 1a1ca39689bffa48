// SPDX-License-Identifier: GPL-3.0-or-later
// The promises of ajar.h about values: ranges, buffers, texts, progress.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <thread>

#include "room_kit.h"

namespace {

// ---- ranges ----------------------------------------------------------------------------------

TEST(Ranges, IdsThatWereNotAddedAreRefusedByName) {
    kit::Scene scene;
    const uint32_t mesh = scene.mesh(kit::plane(1.0f, 0.0f));
    ajar_instance_desc d;
    ajar_instance_desc_init(&d);
    d.name = "shelf";
    uint32_t id;
    d.mesh = mesh + 1;
    EXPECT_EQ(ajar_scene_add_instance(scene.handle(), &d, &id), AJAR_ERROR_ARGUMENT);
    EXPECT_STREQ(ajar_error_culprit(), "shelf");
    d.mesh = mesh;
    d.material_count = 3;
    EXPECT_EQ(ajar_scene_add_instance(scene.handle(), &d, &id), AJAR_ERROR_ARGUMENT) << "materials is NULL";
    d.material_count = 0;
    d.surface = 2;
    EXPECT_EQ(ajar_scene_add_instance(scene.handle(), &d, &id), AJAR_ERROR_ARGUMENT);
    d.surface = AJAR_SURFACE_LIGHTMAP;
    d.transform[3] = INFINITY;
    EXPECT_EQ(ajar_scene_add_instance(scene.handle(), &d, &id), AJAR_ERROR_INPUT);
    EXPECT_STREQ(ajar_error_culprit(), "shelf");
}

TEST(Ranges, AMaterialIdOneTooLargeIsRefusedBesideAnObjectWithoutMaterial) {
    kit::Scene scene;
    const uint32_t mesh = scene.mesh(kit::plane(1.0f, 0.0f)), bad = scene.diffuse({1, 1, 1}) + 1;
    ajar_instance_desc d;
    ajar_instance_desc_init(&d);
    uint32_t id;
    d.mesh = mesh;
    d.name = "bare";
    ASSERT_EQ(ajar_scene_add_instance(scene.handle(), &d, &id), AJAR_OK);
    d.name = "wrong";
    d.material_count = 1;
    d.materials = &bad;
    ASSERT_EQ(ajar_scene_add_instance(scene.handle(), &d, &id), AJAR_OK);
    EXPECT_EQ(ajar_scene_commit(scene.handle()), AJAR_ERROR_ARGUMENT);
    EXPECT_STREQ(ajar_error_culprit(), "wrong");
}

TEST(Ranges, TexturesAndPagesHaveSizes) {
    kit::Scene scene;
    uint32_t id;
    for (auto [w, h] : {std::pair{0u, 8u}, {8u, 0u}, {0xffffffffu, 8u}, {16385u, 8u}})
        EXPECT_EQ(ajar_scene_add_page(scene.handle(), w, h, &id), AJAR_ERROR_ARGUMENT) << w << 'x' << h;
    EXPECT_EQ(ajar_scene_add_page(scene.handle(), 8, 8, nullptr), AJAR_ERROR_ARGUMENT);
    const uint8_t texels[16] = {};
    ajar_texture_desc d;
    ajar_texture_desc_init(&d);
    d.name = "brick";
    d.width = d.height = 2;
    d.texels = texels;
    for (uint64_t bytes : {uint64_t{0}, uint64_t{15}, uint64_t{17}, ~uint64_t{0}}) {
        d.texel_bytes = bytes;
        EXPECT_EQ(ajar_scene_add_texture(scene.handle(), &d, &id), AJAR_ERROR_ARGUMENT) << bytes;
        EXPECT_STREQ(ajar_error_culprit(), "brick");
    }
    d.texel_bytes = 16;
    EXPECT_EQ(ajar_scene_add_texture(scene.handle(), &d, &id), AJAR_OK);
    d.width = 0xffffffffu;
    EXPECT_EQ(ajar_scene_add_texture(scene.handle(), &d, &id), AJAR_ERROR_ARGUMENT);
}

TEST(Ranges, MeshCountsAndIndicesAreChecked) {
    kit::Scene scene;
    uint32_t id;
    const float positions[9] = {};
    uint32_t corners[3] = {0, 1, 3};
    ajar_mesh_desc d;
    ajar_mesh_desc_init(&d);
    d.name = "statue";
    d.vertex_count = 3;
    d.triangle_count = 1;
    EXPECT_EQ(ajar_scene_add_mesh(scene.handle(), &d, &id), AJAR_ERROR_ARGUMENT);
    d.positions = positions;
    EXPECT_EQ(ajar_scene_add_mesh(scene.handle(), &d, &id), AJAR_ERROR_ARGUMENT);
    d.corner_vertex = corners;
    EXPECT_EQ(ajar_scene_add_mesh(scene.handle(), &d, &id), AJAR_ERROR_ARGUMENT) << "vertex 3 of 3";
    EXPECT_STREQ(ajar_error_culprit(), "statue");
    corners[2] = 2;
    d.uv_layer_count = 1;
    EXPECT_EQ(ajar_scene_add_mesh(scene.handle(), &d, &id), AJAR_ERROR_ARGUMENT);
    const float* no_layer[1] = {nullptr};
    d.uv_layers = no_layer;
    EXPECT_EQ(ajar_scene_add_mesh(scene.handle(), &d, &id), AJAR_ERROR_ARGUMENT);
    d.uv_layer_count = 0;
    d.triangle_count = 0xffffffffu;
    EXPECT_EQ(ajar_scene_add_mesh(scene.handle(), &d, &id), AJAR_ERROR_ARGUMENT);
    d.triangle_count = 1;
    EXPECT_EQ(ajar_scene_add_mesh(scene.handle(), &d, &id), AJAR_OK);
}

TEST(Ranges, MaterialsHaveFewClosuresOfKnownTypes) {
    kit::Scene scene;
    uint32_t id;
    std::vector<ajar_closure> closures(AJAR_MAX_CLOSURES + 1);
    for (ajar_closure& c : closures) ajar_closure_init(&c);
    ajar_material_desc d;
    ajar_material_desc_init(&d);
    d.name = "paint";
    d.closure_count = AJAR_MAX_CLOSURES + 1;
    d.closures = closures.data();
    EXPECT_EQ(ajar_scene_add_material(scene.handle(), &d, &id), AJAR_ERROR_ARGUMENT);
    d.closure_count = AJAR_MAX_CLOSURES;
    EXPECT_EQ(ajar_scene_add_material(scene.handle(), &d, &id), AJAR_OK);
    closures[3].type = 4;
    EXPECT_EQ(ajar_scene_add_material(scene.handle(), &d, &id), AJAR_ERROR_ARGUMENT);
    EXPECT_STREQ(ajar_error_culprit(), "paint");
    closures[3].type = 0;
    d.closures = nullptr;
    EXPECT_EQ(ajar_scene_add_material(scene.handle(), &d, &id), AJAR_ERROR_ARGUMENT);
}

TEST(Ranges, SettingsAreChecked) {
    kit::Scene scene;
    kit::fill_room(scene);
    const auto refused = [&](auto&& change) {
        ajar_settings s = kit::quick();
        change(s);
        ajar_job job = nullptr;
        const ajar_result result = ajar_job_start(scene.handle(), &s, &job);
        if (job != nullptr) ajar_job_release(&job);
        return result == AJAR_ERROR_ARGUMENT;
    };
    EXPECT_TRUE(refused([](ajar_settings& s) { s.samples = 0; }));
    EXPECT_TRUE(refused([](ajar_settings& s) { s.samples = 48; }));
    EXPECT_TRUE(refused([](ajar_settings& s) { s.samples = 1u << 31; }));
    EXPECT_TRUE(refused([](ajar_settings& s) { s.bounce_samples = 3; }));
    EXPECT_TRUE(refused([](ajar_settings& s) { s.direct_samples = 0; }));
    EXPECT_TRUE(refused([](ajar_settings& s) { s.positions_per_texel = 17; }));
    EXPECT_TRUE(refused([](ajar_settings& s) { s.positions_per_texel = 0; }));
    EXPECT_TRUE(refused([](ajar_settings& s) { s.noise_target = NAN; }));
    EXPECT_TRUE(refused([](ajar_settings& s) { s.noise_target = -1.0f; }));
    EXPECT_TRUE(refused([](ajar_settings& s) { s.time_limit = NAN; }));
    EXPECT_TRUE(refused([](ajar_settings& s) { s.bounces = 0xffffffffu; }));
    EXPECT_TRUE(refused([](ajar_settings& s) { s.threads = 0xffffffffu; }));
    EXPECT_FALSE(refused([](ajar_settings&) {}));
}

TEST(Ranges, PagesAndLayersOfAResult) {
    kit::Scene scene;
    kit::fill_room(scene);
    const kit::Bake bake(scene, kit::quick());
    uint32_t w, h, c;
    EXPECT_EQ(ajar_job_layer_size(bake.handle(), 1, AJAR_LAYER_IRRADIANCE, &w, &h, &c), AJAR_ERROR_ARGUMENT);
    for (uint32_t layer : {7u, 15u, unsigned(AJAR_LAYER_BOUNCE), 1000u, 0xffffffffu})
        EXPECT_EQ(ajar_job_layer_size(bake.handle(), 0, layer, &w, &h, &c), AJAR_ERROR_ARGUMENT) << layer;
    EXPECT_EQ(ajar_job_layer_size(bake.handle(), 0, AJAR_LAYER_SH, &w, &h, &c), AJAR_ERROR_ARGUMENT)
        << "keep_sh is off";
    EXPECT_EQ(ajar_job_layer_size(bake.handle(), 0, AJAR_LAYER_STDERR, nullptr, &h, &c), AJAR_ERROR_ARGUMENT);
}

// ---- buffers and texts -----------------------------------------------------------------------

TEST(Buffers, TooSmallIsRefusedAndNothingIsWrittenPastTheEnd) {
    kit::Scene scene;
    kit::fill_room(scene, {16, true});
    const kit::Bake bake(scene, kit::quick());
    std::vector<float> buffer(16 * 16 * 3 + 1, -7.0f);
    const uint64_t needed = buffer.size() - 1;
    EXPECT_EQ(ajar_job_read_layer(bake.handle(), 0, AJAR_LAYER_IRRADIANCE, buffer.data(), needed - 1),
              AJAR_ERROR_BUFFER);
    EXPECT_EQ(ajar_job_read_layer(bake.handle(), 0, AJAR_LAYER_IRRADIANCE, nullptr, needed), AJAR_ERROR_BUFFER);
    EXPECT_EQ(buffer[0], -7.0f);
    EXPECT_EQ(ajar_job_read_layer(bake.handle(), 0, AJAR_LAYER_IRRADIANCE, buffer.data(), needed), AJAR_OK);
    EXPECT_NE(buffer[needed - 1], -7.0f);
    EXPECT_EQ(buffer[needed], -7.0f);
}

TEST(Buffers, TheReportTellsTheSizeItNeeds) {
    kit::Scene scene;
    kit::fill_room(scene, {16, true});
    const kit::Bake bake(scene, kit::quick());
    uint64_t size = 0;
    EXPECT_EQ(ajar_job_report(bake.handle(), nullptr, nullptr), AJAR_ERROR_ARGUMENT);
    ASSERT_EQ(ajar_job_report(bake.handle(), nullptr, &size), AJAR_OK);
    const uint64_t needed = size;
    std::vector<char> text(needed);
    size = needed - 1;
    EXPECT_EQ(ajar_job_report(bake.handle(), text.data(), &size), AJAR_ERROR_BUFFER);
    EXPECT_EQ(size, needed);
    ASSERT_EQ(ajar_job_report(bake.handle(), text.data(), &size), AJAR_OK);
    EXPECT_EQ(text.back(), 0);
    EXPECT_EQ(std::strlen(text.data()) + 1, needed);
}

TEST(Settings, ATimeLimitThatNothingCanKeepIsSaid) {
    kit::Scene scene;
    kit::fill_room(scene);
    ajar_settings s = kit::quick();
    s.time_limit = 1e-4f;
    const kit::Bake bake(scene, s);
    EXPECT_TRUE(kit::all_finite(bake.layer(AJAR_LAYER_IRRADIANCE)));
    EXPECT_NE(bake.report().find("its time limit"), std::string::npos);
}

TEST(Texts, AreCutToTheSizeGivenAndTerminated) {
    kit::Scene scene;
    kit::MeshData plane = kit::plane(1.0f, 0.0f);
    plane.positions[1][0] = NAN;
    scene.instance(scene.mesh(plane), scene.diffuse({1, 1, 1}), scene.page(8, 8), "broken plane");
    scene.commit();
    char text[512], culprit[64];
    ASSERT_EQ(ajar_scene_warning(scene.handle(), 0, text, sizeof(text), culprit, sizeof(culprit)), AJAR_OK);
    const std::string whole = text;
    EXPECT_STREQ(culprit, "broken plane");
    for (uint64_t size = 1; size <= whole.size() + 1; ++size) {
        std::vector<char> exact(size, 'x'); // a fresh allocation, so that a sanitizer sees one byte too many
        ASSERT_EQ(ajar_scene_warning(scene.handle(), 0, exact.data(), size, nullptr, 0), AJAR_OK);
        EXPECT_EQ(std::string(exact.data()), whole.substr(0, size - 1));
    }
    EXPECT_EQ(ajar_scene_warning(scene.handle(), 0, text, 0, nullptr, 5), AJAR_OK);
    EXPECT_EQ(ajar_scene_warning(scene.handle(), 1000, text, 10, culprit, 10), AJAR_ERROR_ARGUMENT);
}

TEST(Texts, TheLastErrorBelongsToItsThread) {
    kit::Scene scene;
    ajar_light_desc d;
    ajar_light_desc_init(&d);
    d.name = "lamp A";
    d.energy = NAN;
    uint32_t id;
    ASSERT_EQ(ajar_scene_add_light(scene.handle(), &d, &id), AJAR_ERROR_INPUT);
    const std::string message = ajar_error_message();
    EXPECT_STREQ(ajar_error_culprit(), "lamp A");
    std::thread([&] {
        EXPECT_STREQ(ajar_error_message(), "");
        EXPECT_EQ(ajar_scene_release(nullptr), AJAR_ERROR_ARGUMENT);
        EXPECT_STRNE(ajar_error_message(), message.c_str());
    }).join();
    EXPECT_EQ(message, ajar_error_message());
    EXPECT_STREQ(ajar_error_culprit(), "lamp A");
}

TEST(Texts, AJobKeepsItsOwnFailure) {
    kit::Scene scene("hollow");
    scene.commit();
    ajar_job job = kit::start(scene, kit::quick());
    EXPECT_EQ(ajar_job_wait(job, -1.0), AJAR_ERROR_INPUT);
    EXPECT_STREQ(ajar_error_culprit(), "hollow");
    ajar_scene_release(nullptr); // another failure on this thread
    char text[256], culprit[64];
    ASSERT_EQ(ajar_job_error(job, text, sizeof(text), culprit, sizeof(culprit)), AJAR_OK);
    EXPECT_STREQ(culprit, "hollow");
    EXPECT_NE(std::string(text).find("lightmap"), std::string::npos);
    uint64_t size = 0;
    EXPECT_EQ(ajar_job_report(job, nullptr, &size), AJAR_ERROR_STATE);
    ajar_job_release(&job);
}

TEST(Progress, RisesToOneAndEndsWithTheResult) {
    kit::Scene scene;
    kit::fill_room(scene);
    ajar_settings s = kit::quick();
    s.samples = 256;
    ajar_job job = kit::start(scene, s);
    ajar_progress p;
    ajar_progress_init(&p);
    float fraction = 0.0f;
    uint32_t stage = 0;
    do {
        ASSERT_EQ(ajar_job_poll(job, &p), AJAR_OK);
        EXPECT_GE(p.fraction, fraction);
        EXPECT_LE(p.fraction, 1.0f);
        EXPECT_LT(p.stage, unsigned(AJAR_STAGE_COUNT));
        fraction = p.fraction;
        stage = p.stage;
        std::this_thread::yield();
    } while (p.result == AJAR_RUNNING);
    EXPECT_EQ(p.result, AJAR_OK);
    ASSERT_EQ(ajar_job_poll(job, &p), AJAR_OK);
    EXPECT_EQ(p.stage, unsigned(AJAR_STAGE_DONE)) << stage;
    EXPECT_EQ(p.fraction, 1.0f);
    EXPECT_GT(p.rays, 48u * 48u * 256u / 2);
    ajar_job_release(&job);
}

} // namespace
