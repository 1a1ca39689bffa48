// SPDX-License-Identifier: GPL-3.0-or-later
// Bakes and what is read of them.
#include <filesystem>

#include "ajar_runtime.h"
#include "engine_fuzz.h"

ajar_settings EngineFuzz::settings() {
    ajar_settings s;
    ajar_settings_init(&s);
    s.struct_size = size_of(sizeof(s));
    s.bounces = chance(0.97) ? pick(4) : integer() | 0x1000u;
    s.samples = cheap(8u << pick(4));
    s.bounce_samples = cheap(4u << pick(3));
    s.direct_samples = cheap(1 + pick(8));
    s.positions_per_texel = cheap(chance(0.9) ? 1 + pick(4) : 16);
    s.noise_target = chance(0.6) ? 0.0f : chance(0.8) ? static_cast<float>(1 + pick(16)) / 64.0f : scalar();
    if (chance(0.2)) s.time_limit = chance(0.8) ? static_cast<float>(1 + pick(8)) / 256.0f : scalar();
    s.seed = mostly(0, 0.8);
    s.threads = chance(0.97) ? 1 : integer() | 0x1000u;
    s.stitch_seams = pick(2);
    s.keep_sh = pick(2);
    s.keep_bounces = pick(2);
    s.combinations = mostly(2 - pick(3), 0.97);
    if (chance(0.3)) s.term_threshold = chance(0.7) ? 0.0f : scalar();
    if (chance(0.3)) s.door_rays = static_cast<float>(pick(5)) / 4.0f;
    if (chance(0.1)) s.door_rays = scalar();
    if (chance(0.1)) s.check_points = cheap(1 + pick(4));
    s.light_patches = mostly(pick(3), 0.97);
    s.trial = chance(0.9) ? 0 : 1 + pick(2);
    if (chance(0.05)) s.memory_limit = scalar();
    s.overlap_pictures = pick(2);
    return s;
}

void EngineFuzz::start_job(ajar_scene scene) {
    if (bakes_left_ == 0) return;
    const ajar_settings s = settings();
    ajar_job job = nullptr;
    const ajar_result result = ajar_job_start(scene, maybe(&s), maybe(&job));
    if (keep(jobs_, job, result) != AJAR_OK) return;
    --bakes_left_;
    if (chance(0.2)) return;
    if (note(ajar_job_wait(job, -1.0)) == AJAR_OK) read_job(job);
}

void EngineFuzz::read_layer(ajar_job job, uint32_t page, uint32_t layer) {
    uint32_t width = 0, height = 0, channels = 0;
    if (note(ajar_job_layer_size(job, page, layer, maybe(&width), maybe(&height), maybe(&channels))) != AJAR_OK) return;
    // Exactly the size needed, or a sanitizer would not see what is written past it.
    std::vector<float> buffer(size_t{width} * height * channels - (chance(0.97) ? 0 : 1));
    note(ajar_job_read_layer(job, page, layer, maybe(buffer.data()), buffer.size()));
    if (layer != AJAR_LAYER_AHD) expect_finite(buffer, "a layer"); // AHD are bits
}

void EngineFuzz::read_term(ajar_job job, uint32_t term) {
    ajar_term_info info;
    ajar_term_info_init(&info);
    info.struct_size = size_of(sizeof(info));
    note(ajar_job_term(job, term, maybe(&info)));
    uint32_t width = 0, height = 0, channels = 0;
    const uint32_t page = mostly(0);
    note(ajar_job_layer_size(job, page, AJAR_LAYER_IRRADIANCE, &width, &height, &channels));
    std::vector<float> buffer(size_t{width} * height * 3);
    note(ajar_job_read_term(job, term, page, maybe(buffer.data()), buffer.size()));
    expect_finite(buffer, "a term");
}

void EngineFuzz::read_report(ajar_job job) {
    uint64_t size = 0;
    if (note(ajar_job_report(job, nullptr, maybe(&size))) != AJAR_OK) return;
    std::vector<char> text(size - (size == 0 || chance(0.95) ? 0 : 1));
    size = text.size();
    note(ajar_job_report(job, maybe(text.data()), &size));
}

/// What the engine writes, the run-time library must open.
void EngineFuzz::open_package(const std::string& folder) {
    if (!std::filesystem::exists(folder + "/terms.bin")) return; // nothing changes in it
    ajar_runtime runtime = nullptr;
    if (ajar_runtime_open(folder.c_str(), &runtime) != AJAR_RUNTIME_OK ||
        ajar_runtime_update(runtime, nullptr) != AJAR_RUNTIME_OK)
        broken_ = std::string("a package that the run-time library refuses: ") + ajar_runtime_error_message();
    ajar_runtime_release(&runtime);
}

void EngineFuzz::write_package(ajar_job job) {
    const std::string folder = folder_ + "/package";
    const std::string others[] = {folder + "/sub/sub", "", folder + "/manifest.json"};
    const std::string chosen = chance(0.9) ? folder : others[pick(std::size(others))];
    const char* const kExtras[] = {nullptr, "{}", "{\"a\":[1,null,\"b\"]}", "", "[1]", "{\"a\":", "\xff"};
    if (note(ajar_job_write_package(job, maybe(chosen.c_str()), kExtras[pick(std::size(kExtras))])) == AJAR_OK)
        open_package(chosen);
}

void EngineFuzz::read_job(ajar_job job) {
    for (uint32_t layer = 0; layer <= AJAR_LAYER_AHD; ++layer) read_layer(job, 0, layer);
    read_layer(job, mostly(pick(2)), mostly(AJAR_LAYER_BOUNCE + pick(4), 0.8));
    uint32_t terms = 0;
    note(ajar_job_term_count(job, maybe(&terms)));
    for (uint32_t term = 0; term < terms; ++term) read_term(job, mostly(term, 0.97));
    if (chance(0.7)) read_report(job);
    if (chance(0.5)) write_package(job);
}

void EngineFuzz::job_call() {
    const ajar_job job = some(jobs_);
    char text[64];
    ajar_progress progress;
    ajar_progress_init(&progress);
    progress.struct_size = size_of(sizeof(progress));
    switch (pick(9)) {
        case 0:
            return start_job(some(scenes_));
        case 1:
            note(ajar_job_poll(job, maybe(&progress)));
            return;
        case 2:
            note(ajar_job_cancel(job));
            return;
        case 3:
            note(ajar_job_wait(job, chance(0.8) ? 0.01 : chance(0.5) ? -0.0 : double{scalar()}));
            return;
        case 4:
            note(ajar_job_error(job, maybe(text), pick(65), maybe(text), pick(65)));
            return;
        case 5:
            release(jobs_, ajar_job_release);
            return;
        case 6:
            return write_package(job);
        case 7:
            return read_term(job, integer());
        default:
            return read_job(job);
    }
}
