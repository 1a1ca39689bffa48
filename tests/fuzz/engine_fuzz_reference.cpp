// SPDX-License-Identifier: GPL-3.0-or-later
// Brute force.
#include "engine_fuzz.h"

ajar_reference_settings EngineFuzz::reference_settings(std::vector<float>& weights) {
    ajar_reference_settings s;
    ajar_reference_settings_init(&s);
    s.struct_size = size_of(sizeof(s));
    s.points = cheap(1 + pick(8));
    s.bounces = chance(0.97) ? pick(4) : integer() | 0x1000u;
    s.batches = AJAR_REFERENCE_MIN_BATCHES + pick(2) - (chance(0.97) ? 0 : AJAR_REFERENCE_MIN_BATCHES);
    s.time_limit = chance(0.8) ? 0.0f : scalar();
    if (chance(0.1)) s.batches = AJAR_NONE, s.time_limit = 1e-3f;
    s.seed = mostly(0, 0.8);
    s.point_seed = mostly(0, 0.8);
    s.threads = chance(0.97) ? 1 : integer() | 0x1000u;
    s.choice = mostly(pick(2), 0.97);
    s.texel_mean = pick(2);
    if (chance(0.1)) s.normal[pick(3)] = scalar();
    weights.resize(chance(0.6) ? 0 : 3 - pick(3));
    for (float& w : weights) w = chance(0.8) ? static_cast<float>(pick(5)) / 4.0f : scalar();
    s.weight_count = chance(0.97) || !weights.empty() ? static_cast<uint32_t>(weights.size()) : integer();
    s.weights = weights.empty() ? nullptr : maybe(weights.data());
    if (chance(0.2)) s.door_bounces = pick(3);
    return s;
}

void EngineFuzz::start_reference(ajar_scene scene) {
    if (bakes_left_ == 0) return;
    std::vector<float> weights;
    const ajar_reference_settings s = reference_settings(weights);
    ajar_reference reference = nullptr;
    const ajar_result result = ajar_reference_start(scene, maybe(&s), maybe(&reference));
    if (keep(references_, reference, result) != AJAR_OK) return;
    --bakes_left_;
    if (chance(0.2)) return;
    if (note(ajar_reference_wait(reference, -1.0)) == AJAR_OK) read_reference(reference);
}

void EngineFuzz::read_reference(ajar_reference reference) {
    std::vector<ajar_reference_point> points(chance(0.95) ? 8 : pick(8));
    uint32_t batches = 0;
    note(ajar_reference_read(reference, maybe(points.data()), points.size(), maybe(&batches)));
    for (const ajar_reference_point& p : points)
        expect_finite({p.irradiance[0], p.irradiance[1], p.irradiance[2], p.standard_error}, "a reference");
}

void EngineFuzz::reference_call() {
    const ajar_reference reference = some(references_);
    char text[64];
    ajar_progress progress;
    ajar_progress_init(&progress);
    progress.struct_size = size_of(sizeof(progress));
    switch (pick(7)) {
        case 0:
            return start_reference(some(scenes_));
        case 1:
            note(ajar_reference_poll(reference, maybe(&progress)));
            return;
        case 2:
            note(ajar_reference_cancel(reference));
            return;
        case 3:
            note(ajar_reference_wait(reference, chance(0.8) ? 0.01 : chance(0.5) ? -0.0 : double{scalar()}));
            return;
        case 4:
            note(ajar_reference_error(reference, maybe(text), pick(65), maybe(text), pick(65)));
            return;
        case 5:
            release(references_, ajar_reference_release);
            return;
        default:
            return read_reference(reference);
    }
}
