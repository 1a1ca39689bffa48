// SPDX-License-Identifier: GPL-3.0-or-later
// The promises of ajar.h: checked sizes, handles, order of calls, buffers, texts, lifetimes.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <thread>

#include "room_kit.h"

extern "C" {
size_t ajar_test_c_size_of_closure(void);
size_t ajar_test_c_size_of_settings(void);
ajar_result ajar_test_c_empty_bake(void);
}

namespace {

template <class Handle>
Handle handle_at(uintptr_t value) {
    return reinterpret_cast<Handle>(value);
}

// ---- library and structs ---------------------------------------------------------------------

TEST(Library, VersionsAndTexts) {
    EXPECT_EQ(ajar_abi_version(), AJAR_ABI_VERSION);
    EXPECT_NE(std::string(ajar_version()), "");
    for (ajar_result code : std::initializer_list<ajar_result>{
             AJAR_OK, AJAR_CANCELLED, AJAR_RUNNING, AJAR_ERROR_ARGUMENT, AJAR_ERROR_INTERNAL, 77, INT32_MIN, INT32_MAX})
        EXPECT_STRNE(ajar_result_text(code), "") << code;
    EXPECT_STRNE(ajar_result_text(AJAR_ERROR_HANDLE), ajar_result_text(AJAR_ERROR_STATE));
    for (uint32_t stage : {0u, 5u, unsigned(AJAR_STAGE_COUNT), 0xffffffffu})
        EXPECT_STRNE(ajar_stage_name(stage), "") << stage;
}

TEST(Library, CAndCppAgreeAboutLayout) {
    EXPECT_EQ(ajar_test_c_size_of_closure(), sizeof(ajar_closure));
    EXPECT_EQ(ajar_test_c_size_of_settings(), sizeof(ajar_settings));
}

TEST(Library, AProgramInCGetsANamedErrorForAnEmptyScene) { EXPECT_EQ(ajar_test_c_empty_bake(), AJAR_ERROR_INPUT); }

template <class Struct>
void expect_init(void (*init)(Struct*)) {
    Struct value;
    std::memset(&value, 0xa5, sizeof(value));
    init(&value);
    EXPECT_EQ(value.struct_size, sizeof(Struct));
    Struct again;
    std::memset(&again, 0x5a, sizeof(again));
    init(&again);
    EXPECT_EQ(std::memcmp(&value, &again, sizeof(Struct)), 0) << "init leaves bytes of the caller";
    init(nullptr);
}

TEST(Structs, InitFillsEveryByteAndTheSize) {
    expect_init(ajar_texture_desc_init);
    expect_init(ajar_material_desc_init);
    expect_init(ajar_mesh_desc_init);
    expect_init(ajar_instance_desc_init);
    expect_init(ajar_light_desc_init);
    expect_init(ajar_sky_desc_init);
    expect_init(ajar_settings_init);
    expect_init(ajar_progress_init);
    expect_init(ajar_layout_settings_init);
    expect_init(ajar_layout_mesh_desc_init);
    ajar_input_init(nullptr);
    ajar_closure_init(nullptr);
}

/// call gets a description and must refuse every wrong struct_size, and NULL.
template <class Struct>
void expect_sizes_checked(Struct value, const std::function<ajar_result(const Struct*)>& call) {
    const uint32_t right = value.struct_size;
    for (uint32_t size : {0u, 1u, right - 1, right + 1, right * 2, 0x80000000u, 0xffffffffu}) {
        value.struct_size = size;
        EXPECT_EQ(call(&value), AJAR_ERROR_STRUCT_SIZE) << size;
        EXPECT_STRNE(ajar_error_message(), "");
    }
    EXPECT_EQ(call(nullptr), AJAR_ERROR_ARGUMENT);
}

TEST(Structs, WrongSizesAreRefusedByTheScene) {
    const kit::Scene scene;
    uint32_t id = 0;
    ajar_texture_desc texture;
    ajar_texture_desc_init(&texture);
    expect_sizes_checked<ajar_texture_desc>(texture,
                                            [&](auto* d) { return ajar_scene_add_texture(scene.handle(), d, &id); });
    ajar_material_desc material;
    ajar_material_desc_init(&material);
    expect_sizes_checked<ajar_material_desc>(material,
                                             [&](auto* d) { return ajar_scene_add_material(scene.handle(), d, &id); });
    ajar_mesh_desc mesh;
    ajar_mesh_desc_init(&mesh);
    expect_sizes_checked<ajar_mesh_desc>(mesh, [&](auto* d) { return ajar_scene_add_mesh(scene.handle(), d, &id); });
    ajar_instance_desc instance;
    ajar_instance_desc_init(&instance);
    expect_sizes_checked<ajar_instance_desc>(instance,
                                             [&](auto* d) { return ajar_scene_add_instance(scene.handle(), d, &id); });
    ajar_light_desc light;
    ajar_light_desc_init(&light);
    expect_sizes_checked<ajar_light_desc>(light, [&](auto* d) { return ajar_scene_add_light(scene.handle(), d, &id); });
    ajar_sky_desc sky;
    ajar_sky_desc_init(&sky);
    expect_sizes_checked<ajar_sky_desc>(sky, [&](auto* d) { return ajar_scene_set_sky(scene.handle(), d); });
}

TEST(Structs, WrongSizesAreRefusedByJobAndLayout) {
    kit::Scene scene;
    kit::fill_room(scene);
    ajar_job job = nullptr;
    expect_sizes_checked<ajar_settings>(kit::quick(), [&](auto* s) { return ajar_job_start(scene.handle(), s, &job); });
    EXPECT_EQ(job, nullptr);
    job = kit::start(scene, kit::quick());
    ajar_progress progress;
    ajar_progress_init(&progress);
    expect_sizes_checked<ajar_progress>(progress,
                                        [&](auto* p) { return ajar_job_poll(job, const_cast<ajar_progress*>(p)); });
    EXPECT_EQ(ajar_job_release(&job), AJAR_OK);
    ajar_layout layout = nullptr;
    ajar_layout_settings settings;
    ajar_layout_settings_init(&settings);
    expect_sizes_checked<ajar_layout_settings>(settings, [&](auto* s) { return ajar_layout_create(s, &layout); });
    ASSERT_EQ(ajar_layout_create(&settings, &layout), AJAR_OK);
    ajar_layout_mesh_desc mesh;
    ajar_layout_mesh_desc_init(&mesh);
    uint32_t id = 0;
    expect_sizes_checked<ajar_layout_mesh_desc>(mesh, [&](auto* d) { return ajar_layout_add_mesh(layout, d, &id); });
    EXPECT_EQ(ajar_layout_release(&layout), AJAR_OK);
}

// ---- handles ---------------------------------------------------------------------------------

void expect_scene_handle_refused(ajar_scene scene) {
    uint32_t value = 0;
    ajar_texture_desc texture;
    ajar_texture_desc_init(&texture);
    ajar_material_desc material;
    ajar_material_desc_init(&material);
    ajar_mesh_desc mesh;
    ajar_mesh_desc_init(&mesh);
    ajar_instance_desc instance;
    ajar_instance_desc_init(&instance);
    ajar_light_desc light;
    ajar_light_desc_init(&light);
    ajar_sky_desc sky;
    ajar_sky_desc_init(&sky);
    const ajar_settings settings = kit::quick();
    ajar_job job = nullptr;
    char text[8];
    EXPECT_EQ(ajar_scene_add_texture(scene, &texture, &value), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_scene_add_material(scene, &material, &value), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_scene_add_mesh(scene, &mesh, &value), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_scene_add_instance(scene, &instance, &value), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_scene_add_light(scene, &light, &value), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_scene_add_page(scene, 8, 8, &value), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_scene_set_sky(scene, &sky), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_scene_commit(scene), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_scene_warning_count(scene, &value), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_scene_warning(scene, 0, text, 8, text, 8), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_job_start(scene, &settings, &job), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_scene_release(&scene), AJAR_ERROR_HANDLE);
}

void expect_job_handle_refused(ajar_job job) {
    ajar_progress progress;
    ajar_progress_init(&progress);
    uint32_t w, h, c;
    float buffer[4];
    char text[8];
    uint64_t size = 8;
    EXPECT_EQ(ajar_job_poll(job, &progress), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_job_cancel(job), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_job_wait(job, 0.0), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_job_error(job, text, 8, text, 8), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_job_layer_size(job, 0, 0, &w, &h, &c), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_job_read_layer(job, 0, 0, buffer, 4), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_job_report(job, text, &size), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_job_write_package(job, "/nowhere", nullptr), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_job_release(&job), AJAR_ERROR_HANDLE);
}

void expect_layout_handle_refused(ajar_layout layout) {
    uint32_t a, b;
    float f[2];
    char text[8];
    ajar_layout_mesh_desc mesh;
    ajar_layout_mesh_desc_init(&mesh);
    EXPECT_EQ(ajar_layout_add_mesh(layout, &mesh, &a), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_layout_run(layout), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_layout_page_count(layout, &a), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_layout_page_size(layout, 0, &a, &b), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_layout_mesh_uv(layout, 0, f, 2), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_layout_user(layout, 0, 0, &a, f, f, f), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_layout_warning_count(layout, &a), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_layout_warning(layout, 0, text, 8, text, 8), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_layout_release(&layout), AJAR_ERROR_HANDLE);
}

TEST(Handles, NullAndRandomValuesAreRefused) {
    int local = 0;
    const uintptr_t values[] = {0, 1, 8, 0x1000, 0xdeadbeef, ~uintptr_t{0}, reinterpret_cast<uintptr_t>(&local)};
    for (uintptr_t v : values) {
        SCOPED_TRACE(v);
        expect_scene_handle_refused(handle_at<ajar_scene>(v));
        expect_job_handle_refused(handle_at<ajar_job>(v));
        expect_layout_handle_refused(handle_at<ajar_layout>(v));
    }
    EXPECT_EQ(ajar_scene_release(nullptr), AJAR_ERROR_ARGUMENT);
    EXPECT_EQ(ajar_job_release(nullptr), AJAR_ERROR_ARGUMENT);
    EXPECT_EQ(ajar_layout_release(nullptr), AJAR_ERROR_ARGUMENT);
}

TEST(Handles, StaleOnesAreRefusedForEver) {
    ajar_scene scene = nullptr;
    ASSERT_EQ(ajar_scene_create("gone", &scene), AJAR_OK);
    const ajar_scene stale = scene;
    ASSERT_EQ(ajar_scene_release(&scene), AJAR_OK);
    EXPECT_EQ(scene, nullptr);
    for (int i = 0; i < 100; ++i) { // handles are not reused
        ASSERT_EQ(ajar_scene_create("new", &scene), AJAR_OK);
        EXPECT_NE(scene, stale);
        ASSERT_EQ(ajar_scene_release(&scene), AJAR_OK);
    }
    expect_scene_handle_refused(stale);
}

TEST(Handles, AHandleOfOneKindIsForeignToTheOthers) {
    kit::Scene scene;
    kit::fill_room(scene);
    ajar_job job = kit::start(scene, kit::quick());
    ajar_layout layout = nullptr;
    ajar_layout_settings settings;
    ajar_layout_settings_init(&settings);
    ASSERT_EQ(ajar_layout_create(&settings, &layout), AJAR_OK);
    expect_scene_handle_refused(reinterpret_cast<ajar_scene>(job));
    expect_scene_handle_refused(reinterpret_cast<ajar_scene>(layout));
    expect_job_handle_refused(reinterpret_cast<ajar_job>(scene.handle()));
    expect_job_handle_refused(reinterpret_cast<ajar_job>(layout));
    expect_layout_handle_refused(reinterpret_cast<ajar_layout>(scene.handle()));
    expect_layout_handle_refused(reinterpret_cast<ajar_layout>(job));
    EXPECT_EQ(ajar_layout_release(&layout), AJAR_OK);
    EXPECT_EQ(ajar_job_release(&job), AJAR_OK);
}

TEST(Handles, SecondReleaseIsAnErrorNotACrash) {
    kit::Scene scene;
    kit::fill_room(scene);
    ajar_job job = kit::start(scene, kit::quick()), copy = job;
    EXPECT_EQ(ajar_job_release(&job), AJAR_OK);
    EXPECT_EQ(job, nullptr);
    EXPECT_EQ(ajar_job_release(&job), AJAR_ERROR_HANDLE);
    EXPECT_EQ(ajar_job_release(&copy), AJAR_ERROR_HANDLE);
    EXPECT_NE(copy, nullptr) << "a failed release keeps the caller's handle";
}

// ---- lifetimes -------------------------------------------------------------------------------

TEST(Lifetime, ReleaseWhileRunningCancelsAndReturnsSoon) {
    kit::Scene scene;
    kit::fill_room(scene);
    ajar_job job = kit::start(scene, kit::endless());
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_EQ(ajar_job_release(&job), AJAR_OK);
    EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(), 10.0);
}

TEST(Lifetime, ReleaseEndsAJobThatAnotherThreadWaitsFor) {
    kit::Scene scene;
    kit::fill_room(scene);
    ajar_job job = kit::start(scene, kit::endless());
    std::atomic<bool> waiting{false};
    ajar_result waited = AJAR_OK;
    std::thread waiter([&, handle = job] {
        waiting = true;
        waited = ajar_job_wait(handle, 60.0);
    });
    while (!waiting) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_EQ(ajar_job_release(&job), AJAR_OK);
    waiter.join();
    EXPECT_EQ(waited, AJAR_CANCELLED);
}

TEST(Lifetime, AJobOutlivesItsScene) {
    ajar_job job = nullptr;
    {
        kit::Scene scene;
        kit::fill_room(scene);
        job = kit::start(scene, kit::quick());
    }
    EXPECT_EQ(ajar_job_wait(job, -1.0), AJAR_OK);
    std::vector<float> e(3 * 48 * 48);
    EXPECT_EQ(ajar_job_read_layer(job, 0, AJAR_LAYER_IRRADIANCE, e.data(), e.size()), AJAR_OK);
    EXPECT_EQ(ajar_job_release(&job), AJAR_OK);
}

TEST(Lifetime, InputsAreCopied) {
    kit::Scene scene;
    const uint32_t material = scene.diffuse({0.5f, 0.5f, 0.5f});
    kit::MeshData plane = kit::plane(2.0f, 0.0f);
    const uint32_t mesh = scene.mesh(plane);
    std::fill(plane.positions.begin(), plane.positions.end(), kit::Float3{NAN, NAN, NAN});
    std::fill(plane.corners.begin(), plane.corners.end(), 0xffffffffu);
    scene.instance(mesh, material, scene.page(8, 8));
    scene.sky({1, 1, 1});
    scene.commit();
    EXPECT_TRUE(kit::scene_warnings(scene).empty());
    EXPECT_NEAR(kit::Bake(scene, kit::quick()).layer(AJAR_LAYER_IRRADIANCE).at(4, 4), 3.14159f, 1e-3f);
}

TEST(Lifetime, TwoJobsOfOneSceneRunAtOnceAndAgree) {
    kit::Scene scene;
    kit::fill_room(scene);
    ajar_job a = kit::start(scene, kit::quick()), b = kit::start(scene, kit::quick());
    EXPECT_EQ(ajar_job_wait(a, -1.0), AJAR_OK);
    EXPECT_EQ(ajar_job_wait(b, -1.0), AJAR_OK);
    std::vector<float> ea(3 * 48 * 48), eb(ea.size());
    EXPECT_EQ(ajar_job_read_layer(a, 0, AJAR_LAYER_IRRADIANCE, ea.data(), ea.size()), AJAR_OK);
    EXPECT_EQ(ajar_job_read_layer(b, 0, AJAR_LAYER_IRRADIANCE, eb.data(), eb.size()), AJAR_OK);
    EXPECT_EQ(ea, eb);
    ajar_job_release(&a);
    ajar_job_release(&b);
}

// ---- order of calls --------------------------------------------------------------------------

TEST(Order, NothingIsAddedToACommittedScene) {
    kit::Scene scene;
    kit::fill_room(scene);
    uint32_t id = 77;
    ajar_material_desc material;
    ajar_material_desc_init(&material);
    ajar_sky_desc sky;
    ajar_sky_desc_init(&sky);
    EXPECT_EQ(ajar_scene_add_material(scene.handle(), &material, &id), AJAR_ERROR_STATE);
    EXPECT_EQ(ajar_scene_add_page(scene.handle(), 8, 8, &id), AJAR_ERROR_STATE);
    EXPECT_EQ(ajar_scene_set_sky(scene.handle(), &sky), AJAR_ERROR_STATE);
    EXPECT_EQ(ajar_scene_commit(scene.handle()), AJAR_ERROR_STATE);
    EXPECT_EQ(id, 77u) << "a failed call writes no id";
}

TEST(Order, AnUncommittedSceneIsNotBaked) {
    kit::Scene scene;
    kit::fill_room(scene, {48, false});
    const ajar_settings s = kit::quick();
    ajar_job job = nullptr;
    EXPECT_EQ(ajar_job_start(scene.handle(), &s, &job), AJAR_ERROR_STATE);
    EXPECT_EQ(job, nullptr);
    scene.commit();
    EXPECT_EQ(ajar_job_start(scene.handle(), &s, &job), AJAR_OK);
    ajar_job_release(&job);
}

TEST(Order, ResultsBeforeTheEndAreRunning) {
    kit::Scene scene;
    kit::fill_room(scene);
    ajar_job job = kit::start(scene, kit::endless());
    uint32_t w, h, c;
    float buffer[4];
    uint64_t size = 0;
    const kit::TempFolder folder;
    EXPECT_EQ(ajar_job_wait(job, 0.0), AJAR_RUNNING);
    EXPECT_EQ(ajar_job_wait(job, NAN), AJAR_RUNNING);
    EXPECT_EQ(ajar_job_layer_size(job, 0, AJAR_LAYER_IRRADIANCE, &w, &h, &c), AJAR_RUNNING);
    EXPECT_EQ(ajar_job_read_layer(job, 0, AJAR_LAYER_IRRADIANCE, buffer, 4), AJAR_RUNNING);
    EXPECT_EQ(ajar_job_report(job, nullptr, &size), AJAR_RUNNING);
    EXPECT_EQ(ajar_job_write_package(job, folder.path("package").c_str(), nullptr), AJAR_RUNNING);
    EXPECT_TRUE(folder.entries().empty());
    EXPECT_EQ(ajar_job_release(&job), AJAR_OK);
}

TEST(Order, AFailedCommitCanBeRepaired) {
    kit::Scene scene;
    const uint32_t mesh = scene.mesh(kit::plane(1.0f, 0.0f));
    ajar_instance_desc d;
    ajar_instance_desc_init(&d);
    const uint32_t later = 0;
    d.name = "early bird";
    d.mesh = mesh;
    d.material_count = 1;
    d.materials = &later;
    uint32_t id;
    ASSERT_EQ(ajar_scene_add_instance(scene.handle(), &d, &id), AJAR_OK);
    EXPECT_EQ(ajar_scene_commit(scene.handle()), AJAR_ERROR_ARGUMENT);
    EXPECT_STREQ(ajar_error_culprit(), "early bird");
    scene.diffuse({1, 1, 1});
    EXPECT_EQ(ajar_scene_commit(scene.handle()), AJAR_OK);
}

} // namespace
