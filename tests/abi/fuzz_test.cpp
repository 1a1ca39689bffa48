// SPDX-License-Identifier: GPL-3.0-or-later
// Random calls with a fixed seed: whatever the arguments, a known code comes back and nothing
// crashes. Pointers are NULL or good, since a C function cannot tell others; counts never exceed
// the memory behind them.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "room_kit.h"

namespace {

class Fuzzer {
public:
    explicit Fuzzer(uint32_t seed) : random_(seed) {
        for (float& f : floats_) f = scalar();
        for (double& d : doubles_) d = scalar();
        for (uint32_t& i : indices_) i = chance(0.95) ? pick(8) : integer();
    }
    ~Fuzzer() {
        for (ajar_scene& s : scenes_) ajar_scene_release(&s);
        for (ajar_job& j : jobs_) ajar_job_release(&j);
        for (ajar_layout& l : layouts_) ajar_layout_release(&l);
    }
    void step();

private:
    static constexpr size_t kMemory = 512;

    uint32_t pick(uint32_t count) { return random_() % count; }
    bool chance(double p) { return std::uniform_real_distribution<>(0, 1)(random_) < p; }
    uint32_t integer() {
        constexpr uint32_t kOdd[] = {0, 1, 2, 3, 4, 16, 255, 0x7fffffffu, 0x80000000u, 0xfffffffeu, 0xffffffffu};
        return chance(0.7) ? kOdd[pick(std::size(kOdd))] : random_();
    }
    float scalar() {
        constexpr float kOdd[] = {0.0f,  -0.0f,  1.0f,    -1.0f,    0.5f,      1e-45f, 1e-30f,
                                  1e30f, -1e30f, 3.4e38f, INFINITY, -INFINITY, NAN};
        if (chance(0.25)) return kOdd[pick(std::size(kOdd))];
        return std::uniform_real_distribution<float>(-2.0f, 2.0f)(random_);
    }
    uint32_t size_of(size_t right) { return chance(0.93) ? static_cast<uint32_t>(right) : integer(); }
    template <class T>
    const T* maybe(const T* p) {
        return chance(0.95) ? p : nullptr;
    }
    template <class T>
    T* maybe(T* p) {
        return chance(0.95) ? p : nullptr;
    }
    template <class Handle>
    Handle some(const std::vector<Handle>& known) {
        if (known.empty() || chance(0.05)) return std::bit_cast<Handle>(uintptr_t{integer()});
        return known[pick(static_cast<uint32_t>(known.size()))];
    }
    const char* name() { return chance(0.1) ? nullptr : chance(0.1) ? "\xff\xfe bad utf-8" : "thing"; }
    void fill(double* m) {
        for (int i = 0; i < 12; ++i) m[i] = chance(0.8) ? (i % 5 == 0 ? 1.0 : 0.0) : scalar();
    }
    ajar_input input() {
        ajar_input in;
        ajar_input_init(&in);
        for (float& v : in.value) v = scalar();
        if (chance(0.3)) in.texture = pick(4);
        if (chance(0.2)) in.color_layer = pick(3);
        if (chance(0.05)) in.channel = integer();
        in.uv_layer = chance(0.9) ? 0 : integer();
        in.invert = integer();
        for (float& v : in.uv_transform) v = scalar();
        return in;
    }

    ajar_result scene_call();
    ajar_result add_mesh(ajar_scene scene);
    ajar_result add_instance(ajar_scene scene);
    ajar_result add_material(ajar_scene scene);
    ajar_result add_texture(ajar_scene scene);
    ajar_result add_light(ajar_scene scene);
    ajar_result start_job();
    ajar_result job_call();
    ajar_result layout_call();
    ajar_result add_layout_mesh(ajar_layout layout);
    template <class Handle>
    ajar_result release(std::vector<Handle>& known, ajar_result (*call)(Handle*));

    std::mt19937 random_;
    float floats_[kMemory];
    double doubles_[kMemory];
    uint32_t indices_[kMemory];
    std::vector<ajar_scene> scenes_;
    std::vector<ajar_job> jobs_;
    std::vector<ajar_layout> layouts_;
};

template <class Handle>
ajar_result Fuzzer::release(std::vector<Handle>& known, ajar_result (*call)(Handle*)) {
    if (known.empty() || chance(0.3)) {
        Handle random = std::bit_cast<Handle>(uintptr_t{integer()} << 32);
        return call(maybe(&random));
    }
    const size_t i = pick(static_cast<uint32_t>(known.size()));
    const ajar_result result = call(&known[i]);
    known.erase(known.begin() + static_cast<ptrdiff_t>(i));
    return result;
}

ajar_result Fuzzer::add_texture(ajar_scene scene) {
    ajar_texture_desc d;
    ajar_texture_desc_init(&d);
    d.struct_size = size_of(sizeof(d));
    d.name = name();
    d.width = chance(0.8) ? 1 + pick(8) : integer();
    d.height = chance(0.8) ? 1 + pick(8) : integer();
    d.texel = chance(0.95) ? pick(2) : integer();
    d.color = chance(0.95) ? pick(2) : integer();
    d.extend = chance(0.95) ? pick(3) : integer();
    d.texels = maybe(floats_);
    d.texel_bytes = uint64_t{4} * d.width * d.height * (d.texel == AJAR_TEXEL_F32 ? 4 : 1);
    if (d.texel_bytes > sizeof(floats_) || chance(0.05)) d.texel_bytes = integer() % sizeof(floats_);
    uint32_t id;
    return ajar_scene_add_texture(scene, maybe(&d), maybe(&id));
}

ajar_result Fuzzer::add_material(ajar_scene scene) {
    ajar_closure closures[AJAR_MAX_CLOSURES];
    for (ajar_closure& c : closures) {
        ajar_closure_init(&c);
        c.type = chance(0.95) ? pick(4) : integer();
        for (ajar_input* in : {&c.weight_a, &c.weight_b, &c.color, &c.strength, &c.metallic, &c.roughness})
            if (chance(0.5)) *in = input();
        c.specular = scalar();
    }
    ajar_material_desc d;
    ajar_material_desc_init(&d);
    d.struct_size = size_of(sizeof(d));
    d.name = name();
    d.closure_count = chance(0.9) ? pick(4) : integer();
    d.closures = maybe(closures);
    d.one_sided = integer();
    uint32_t id;
    return ajar_scene_add_material(scene, maybe(&d), maybe(&id));
}

ajar_result Fuzzer::add_mesh(ajar_scene scene) {
    const float* layers[2] = {maybe(floats_), maybe(floats_ + 20)};
    ajar_mesh_desc d;
    ajar_mesh_desc_init(&d);
    d.struct_size = size_of(sizeof(d));
    d.name = name();
    d.vertex_count = 8 + pick(32);
    d.triangle_count = pick(20);
    d.positions = maybe(floats_ + pick(200));
    d.corner_vertex = maybe(indices_ + pick(200));
    if (chance(0.3)) d.corner_normals = floats_ + 3;
    if (chance(0.3)) d.triangle_slot = indices_;
    d.uv_layer_count = pick(3);
    d.uv_layers = maybe(layers);
    d.color_layer_count = pick(2);
    d.color_layers = maybe(layers);
    uint32_t id;
    return ajar_scene_add_mesh(scene, maybe(&d), maybe(&id));
}

ajar_result Fuzzer::add_instance(ajar_scene scene) {
    ajar_instance_desc d;
    ajar_instance_desc_init(&d);
    d.struct_size = size_of(sizeof(d));
    d.name = name();
    d.mesh = chance(0.9) ? pick(3) : integer();
    fill(d.transform);
    const uint32_t materials[3] = {pick(2), pick(2), chance(0.95) ? 0 : integer()};
    d.material_count = pick(4);
    d.materials = maybe(materials);
    d.surface = chance(0.95) ? pick(2) : integer();
    d.visibility = integer();
    d.lightmap_layer = chance(0.95) ? 0 : integer();
    d.page = chance(0.95) ? 0 : integer();
    if (chance(0.1)) d.uv_scale[0] = scalar();
    if (chance(0.1)) d.uv_offset[1] = scalar();
    uint32_t id;
    return ajar_scene_add_instance(scene, maybe(&d), maybe(&id));
}

ajar_result Fuzzer::add_light(ajar_scene scene) {
    ajar_light_desc d;
    ajar_light_desc_init(&d);
    d.struct_size = size_of(sizeof(d));
    d.name = name();
    d.type = chance(0.95) ? pick(5) : integer();
    d.role = chance(0.95) ? pick(2) : integer();
    fill(d.transform);
    for (float* v : {&d.color[0], &d.energy, &d.radius, &d.spot_angle, &d.spot_blend, &d.sun_angle, &d.size_x,
                     &d.size_y, &d.spread})
        if (chance(0.3)) *v = scalar();
    d.casts_shadow = integer();
    uint32_t id;
    return ajar_scene_add_light(scene, maybe(&d), maybe(&id));
}

ajar_result Fuzzer::scene_call() {
    const ajar_scene scene = some(scenes_);
    uint32_t id;
    char text[16];
    ajar_sky_desc sky;
    switch (pick(14)) {
        case 0: {
            ajar_scene created = nullptr;
            const ajar_result result = ajar_scene_create(name(), maybe(&created));
            if (created != nullptr) scenes_.push_back(created);
            return result;
        }
        case 1:
            return chance(0.15) ? release(scenes_, ajar_scene_release) : AJAR_OK;
        case 2:
            return add_texture(scene);
        case 3:
            return add_material(scene);
        case 4:
        case 5:
            return add_mesh(scene);
        case 6:
        case 7:
            return add_instance(scene);
        case 8:
            return add_light(scene);
        case 9:
            return ajar_scene_add_page(scene, chance(0.9) ? 1 + pick(16) : integer(), chance(0.9) ? 1 + pick(16) : 0,
                                       maybe(&id));
        case 10:
            ajar_sky_desc_init(&sky);
            sky.struct_size = size_of(sizeof(sky));
            sky.type = chance(0.95) ? pick(3) : integer();
            for (float& c : sky.color) c = scalar();
            sky.texture = chance(0.8) ? pick(2) : integer();
            return ajar_scene_set_sky(scene, maybe(&sky));
        case 11:
            return chance(0.2) ? ajar_scene_commit(scene) : AJAR_OK;
        case 12:
            return ajar_scene_warning_count(scene, maybe(&id));
        default:
            return ajar_scene_warning(scene, integer(), maybe(text), pick(17), maybe(text), pick(17));
    }
}

ajar_result Fuzzer::start_job() {
    ajar_settings s = kit::quick();
    s.struct_size = size_of(sizeof(s));
    s.samples = chance(0.9) ? 8u : integer();
    s.bounce_samples = chance(0.9) ? 4u : integer();
    s.bounces = pick(3);
    s.direct_samples = 1 + pick(4);
    s.positions_per_texel = chance(0.9) ? 1 + pick(16) : integer();
    s.noise_target = chance(0.9) ? 0.0f : scalar();
    s.time_limit = chance(0.9) ? 0.0f : scalar();
    s.threads = chance(0.9) ? 1 : integer();
    s.keep_sh = pick(2);
    s.light_patches = pick(4);
    s.trial = pick(3);
    s.keep_bounces = pick(2);
    s.stitch_seams = pick(2);
    ajar_job job = nullptr;
    const ajar_result result = ajar_job_start(some(scenes_), maybe(&s), maybe(&job));
    if (job != nullptr) jobs_.push_back(job);
    return result;
}

ajar_result Fuzzer::job_call() {
    const ajar_job job = some(jobs_);
    uint32_t w, h, c;
    uint64_t size = pick(64);
    char text[64];
    ajar_progress progress;
    ajar_progress_init(&progress);
    progress.struct_size = size_of(sizeof(progress));
    switch (pick(9)) {
        case 0:
            return start_job();
        case 1:
            return ajar_job_poll(job, maybe(&progress));
        case 2:
            return chance(0.1) ? ajar_job_cancel(job) : AJAR_OK;
        case 3:
            return ajar_job_wait(job, chance(0.5) ? 0.01 : -0.0);
        case 4:
            return ajar_job_error(job, maybe(text), pick(65), maybe(text), pick(65));
        case 5:
            return release(jobs_, ajar_job_release);
        case 6:
            return ajar_job_layer_size(job, chance(0.9) ? 0 : integer(), chance(0.8) ? pick(20) : integer(), maybe(&w),
                                       maybe(&h), maybe(&c));
        case 7:
            return ajar_job_read_layer(job, chance(0.9) ? 0 : integer(), chance(0.8) ? pick(20) : integer(),
                                       maybe(floats_), pick(kMemory));
        default:
            return ajar_job_report(job, maybe(text), maybe(&size));
    }
}

ajar_result Fuzzer::add_layout_mesh(ajar_layout layout) {
    ajar_layout_mesh_desc d;
    ajar_layout_mesh_desc_init(&d);
    d.struct_size = size_of(sizeof(d));
    d.name = name();
    d.vertex_count = 8 + pick(32);
    d.corner_count = pick(60);
    d.polygon_count = pick(20);
    d.positions = maybe(floats_ + pick(200));
    d.corner_vertex = maybe(indices_ + pick(200));
    std::vector<uint32_t> start(20), count(20);
    for (uint32_t i = 0; i < 20; ++i)
        start[i] = chance(0.97) ? 3 * i : integer(), count[i] = chance(0.97) ? 3 : integer();
    d.polygon_start = maybe(start.data());
    d.polygon_size = maybe(count.data());
    if (chance(0.3)) d.corner_uv = floats_;
    d.user_count = pick(3);
    double transforms[36];
    for (int i = 0; i < 3; ++i) fill(transforms + 12 * i);
    d.user_transforms = maybe(transforms);
    if (chance(0.2)) d.user_texel_scale = floats_ + 7;
    uint32_t id;
    return ajar_layout_add_mesh(layout, maybe(&d), maybe(&id));
}

ajar_result Fuzzer::layout_call() {
    const ajar_layout layout = some(layouts_);
    uint32_t a, b;
    float f[2];
    char text[16];
    ajar_layout_settings s;
    ajar_layout created = nullptr;
    switch (pick(10)) {
        case 0: {
            ajar_layout_settings_init(&s);
            s.struct_size = size_of(sizeof(s));
            s.texels_per_meter = chance(0.8) ? 4.0f : scalar();
            s.atlas_size = chance(0.9) ? 64 : integer();
            s.padding = chance(0.9) ? 1 : integer();
            s.chart_angle = chance(0.9) ? 0.5f : scalar();
            const ajar_result result = ajar_layout_create(maybe(&s), maybe(&created));
            if (created != nullptr) layouts_.push_back(created);
            return result;
        }
        case 1:
            return chance(0.3) ? release(layouts_, ajar_layout_release) : AJAR_OK;
        case 2:
        case 3:
            return add_layout_mesh(layout);
        case 4:
            return ajar_layout_run(layout);
        case 5:
            return ajar_layout_page_count(layout, maybe(&a));
        case 6:
            return ajar_layout_page_size(layout, integer(), maybe(&a), maybe(&b));
        case 7:
            return ajar_layout_mesh_uv(layout, pick(3), maybe(floats_), pick(kMemory));
        case 8:
            return ajar_layout_user(layout, pick(3), integer(), maybe(&a), maybe(f), maybe(f), maybe(f));
        default:
            return ajar_layout_warning(layout, integer(), maybe(text), pick(17), maybe(text), pick(17));
    }
}

void Fuzzer::step() {
    const uint32_t kind = pick(10);
    const ajar_result result = kind < 6 ? scene_call() : kind < 8 ? job_call() : layout_call();
    ASSERT_LE(result, AJAR_RUNNING);
    ASSERT_GT(result, AJAR_ERROR_INTERNAL) << kit::last_failure();
    if (result < 0) {
        ASSERT_STRNE(ajar_error_message(), "");
    }
}

TEST(Fuzz, RandomCallsGiveCodes) {
    constexpr uint32_t kSeeds = 40, kCalls = 500;
    for (uint32_t seed = 1; seed <= kSeeds; ++seed) {
        SCOPED_TRACE(seed);
        Fuzzer fuzzer(seed);
        for (uint32_t i = 0; i < kCalls; ++i) {
            fuzzer.step();
            if (HasFatalFailure()) return;
        }
    }
}

} // namespace
