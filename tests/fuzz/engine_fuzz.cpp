// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine_fuzz.h"

#include <cmath>

namespace {

constexpr uint32_t kTooMany[] = {0x80000000u, 0x7fffffffu, 0xfffffffeu, 0xffffffffu};

/// For whoever reads the report of a failure.
std::string last_failure() { return std::string(ajar_error_message()) + " [" + ajar_error_culprit() + "]"; }

} // namespace

EngineFuzz::EngineFuzz(ByteSource& bytes, std::string folder) : bytes_(bytes), folder_(std::move(folder)) {
    // From one byte, or most of libFuzzer's would go here; poke() changes single numbers.
    ByteSource fill(bytes_.byte());
    for (float& f : wild_) f = fill.scalar();
    for (float& f : calm_) f = static_cast<float>(fill.byte()) / 64.0f - 2.0f;
    for (float& f : unit_) f = static_cast<float>(fill.byte()) / 255.0f;
    for (uint32_t& i : indices_) i = fill.chance(0.99) ? fill.pick(8) : fill.integer();
}

EngineFuzz::~EngineFuzz() {
    for (ajar_scene& s : scenes_) ajar_scene_release(&s);
    for (ajar_job& j : jobs_) ajar_job_release(&j);
    for (ajar_reference& r : references_) ajar_reference_release(&r);
    for (ajar_layout& l : layouts_) ajar_layout_release(&l);
}

uint32_t EngineFuzz::cheap(uint32_t usual) {
    if (chance(0.97)) return usual;
    return chance(0.5) ? 0 : kTooMany[pick(std::size(kTooMany))];
}

const char* EngineFuzz::name() {
    static const std::string kLong(300, 'x');
    if (chance(0.9)) return "thing";
    const char* const kNames[] = {nullptr, "", "\xff\xfe bad utf-8", "a/b\"\\\n", kLong.c_str()};
    return kNames[pick(std::size(kNames))];
}

void EngineFuzz::transform(double* m) {
    const uint32_t kind = pick(8);
    for (int i = 0; i < 12; ++i) {
        const bool moves = i % 4 == 3, stretches = i % 5 == 0;
        m[i] = stretches ? 1.0 : 0.0;
        if ((kind == 4 && moves) || (kind == 5 && (moves || stretches)) || kind == 6) m[i] = pick(256) / 64.0 - 2.0;
        if (kind == 7 && chance(0.3)) m[i] = scalar();
    }
}

const float* EngineFuzz::numbers(size_t count) {
    const float* const kinds[] = {calm_, calm_, calm_, unit_, wild_};
    const float* const kind = kinds[pick(std::size(kinds))];
    any_wild_ |= kind == wild_;
    return kind + pick(256) % (kMemory - count + 1);
}

const float* EngineFuzz::unit_numbers(size_t count) {
    return chance(0.9) ? unit_ + pick(256) % (kMemory - count + 1) : numbers(count);
}

const uint32_t* EngineFuzz::indices(size_t count) { return indices_ + pick(256) % (kMemory - count + 1); }

void EngineFuzz::poke() {
    const uint32_t at = (pick(2) << 8) + pick(256);
    float* const kinds[] = {calm_, unit_, wild_};
    if (chance(0.7))
        kinds[pick(3)][at] = scalar();
    else
        indices_[at] = mostly(pick(8), 0.7);
}

ajar_result EngineFuzz::note(ajar_result result) {
    std::string rule;
    if (result > AJAR_RUNNING)
        rule = "an unknown code " + std::to_string(result);
    else if (result <= AJAR_ERROR_INTERNAL)
        rule = "an internal error: " + last_failure();
    else if (result < 0 && *ajar_error_message() == 0)
        rule = "an error without a message, code " + std::to_string(result);
    if (broken_.empty()) broken_ = rule;
    return result;
}

void EngineFuzz::expect_finite(const std::vector<float>& light, const char* what) {
    if (any_wild_ || bytes_.wild()) return;
    for (const float v : light)
        if (!std::isfinite(v)) broken_ = std::string(what) + " that is not finite, from ordinary numbers";
}

void EngineFuzz::library_call() {
    if (ajar_abi_version() != AJAR_ABI_VERSION || *ajar_version() == 0) broken_ = "the library denies its version";
    if (ajar_result_text(static_cast<ajar_result>(integer())) == nullptr) broken_ = "no text for a code";
    if (ajar_stage_name(integer()) == nullptr) broken_ = "no name for a stage";
    ajar_settings_init(nullptr);
    ajar_progress_init(nullptr);
    ajar_term_info_init(nullptr);
    ajar_reference_settings_init(nullptr);
    ajar_layout_settings_init(nullptr);
    ajar_input_init(nullptr);
}

std::string EngineFuzz::step() {
    broken_.clear();
    const uint32_t kind = pick(32);
    if (kind < 7)
        room();
    else if (kind < 15)
        scene_call();
    else if (kind < 20)
        job_call();
    else if (kind < 23)
        reference_call();
    else if (kind < 26)
        atlas();
    else if (kind < 29)
        layout_call();
    else if (kind < 31)
        poke();
    else
        library_call();
    return broken_;
}
