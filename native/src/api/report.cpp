// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/resource.h>

#include <nlohmann/json.hpp>

#include "api/check_report.h"
#include "api/cut_report.h"
#include "api/effects.h"
#include "api/job.h"
#include "api/memory_report.h"
#include "pass/bake_parts.h"

namespace ajar {

namespace {

using nlohmann::json;

json settings_json(const ajar_settings& s) {
    return {{"bounces", s.bounces},
            {"noise_target", s.noise_target},
            {"time_limit", s.time_limit},
            {"samples", s.samples},
            {"bounce_samples", s.bounce_samples},
            {"direct_samples", s.direct_samples},
            {"positions_per_texel", s.positions_per_texel},
            {"combinations", s.combinations},
            {"term_threshold", s.term_threshold},
            {"door_rays", s.door_rays},
            {"check_points", s.check_points},
            {"memory_limit", s.memory_limit},
            {"light_patches", s.light_patches},
            {"seed", s.seed},
            {"threads", s.threads},
            {"stitch_seams", s.stitch_seams != 0},
            {"keep_sh", s.keep_sh != 0},
            {"overlap_pictures", s.overlap_pictures != 0}};
}

json seconds_json(const Job& job) {
    json stages = json::object();
    for (uint32_t s = AJAR_STAGE_RECEIVERS; s < AJAR_STAGE_DONE; ++s)
        stages[ajar_stage_name(s)] = job.progress().stage_seconds(s);
    return {{"total", job.seconds()}, {"stages", stages}};
}

/// Relative standard errors of valid texels with everything open, present and lit, sorted; dark texels count
/// against a floor of 1% of the median (algorithms.md 10.4).
std::vector<float> relative_errors(const JobOutput& o) {
    std::vector<float> levels;
    for (size_t r = 0; r < o.receivers.count(); ++r)
        levels.push_back(o.bake.total.empty() ? luminance(o.pages.irradiance[o.receivers.texel[r]]) : o.bake.total[r]);
    if (levels.empty()) return {};
    const float floor = dark_level(levels);
    std::vector<float> errors;
    for (size_t r = 0; r < levels.size(); ++r) {
        if (o.pages.validity[o.receivers.texel[r]] != 1.0f || !(levels[r] + floor > 0.0f)) continue;
        float error = o.bake.all_on_error()[r], level = levels[r] + floor;
        if (!o.bake.missed.empty()) { // most texels lack it, few have far too much, and none counts as more than 1
            const float missed = o.bake.missed[r], part = o.bake.missed_error[r];
            error = std::sqrt(std::max(error * error - part * part, 0.0f) + missed * missed), level += missed;
        }
        errors.push_back(std::min(error / level, 1.0f));
    }
    std::sort(errors.begin(), errors.end());
    return errors;
}

json error_json(const Job& job, const JobOutput& o) {
    const std::vector<float> e = relative_errors(o);
    double squares = 0.0, within = 0.0;
    for (const float v : e) squares += double(v) * v, within += v <= job.settings().noise_target;
    const auto at = [&](double q) {
        return e.empty() ? 0.0
                         : double(e[std::min(e.size() - 1, static_cast<size_t>(q * static_cast<double>(e.size())))]);
    };
    const double rms = e.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(e.size()));
    double traced = 0.0; // half the noise takes four times the rays, of the final gather and of what it reflects
    for (const uint32_t s : {AJAR_STAGE_DIRECT, AJAR_STAGE_BOUNCES, AJAR_STAGE_GATHER})
        traced += job.progress().stage_seconds(s);
    json out = {{"estimated_rms", rms},
                {"p50", at(0.5)},
                {"p95", at(0.95)},
                {"target", job.settings().noise_target},
                {"share_reached",
                 e.empty() || job.settings().noise_target <= 0.0f ? 0.0 : within / static_cast<double>(e.size())},
                {"calibration", o.bake.calibration.factor},
                {"spread", o.bake.calibration.spread},
                {"next_step", {{"noise", rms / 2.0}, {"seconds", job.seconds() + 3.0 * traced}}}};
    if (o.bake.calibration.is_unsure()) out["unknown"] = "few bright samples";
    return out;
}

json bounces_json(const Job& job, const JobOutput& o) {
    double total = 0.0;
    for (const double m : o.bake.bounce_means) total += m;
    const auto& means = o.bake.bounce_means;
    return {
        {"count", job.settings().bounces}, {"means", means}, {"last_share", total > 0.0 ? means.back() / total : 0.0}};
}

/// Light of every product of elements: where it is kept, how exact it is, what was left out.
json terms_json(const Snapshot& s, const BakedPages& pages) {
    json terms = json::array();
    for (const BakedTerm& t : pages.terms) {
        json names = json::array();
        for (const uint32_t e : t.elements) names.push_back(s.elements[e].name);
        terms.push_back({{"elements", names},
                         {"texels", t.texel.size()},
                         {"signed", t.is_signed},
                         {"relative_error", t.relative_error},
                         {"discarded", t.discarded}});
    }
    return terms;
}

/// What the threshold left out of all terms together, and how many terms share a texel.
json terms_total_json(const Snapshot& s, const BakedPages& pages, const CutLight& cut) {
    std::vector<uint32_t> count(s.texel_count(), 0);
    for (const BakedTerm& t : pages.terms)
        for (const uint32_t texel : t.texel) ++count[texel];
    TexelSummary summary;
    for (const uint32_t n : count)
        if (n > 0) summary.add(n, 0.0);
    return {{"discarded", pages.discarded}, {"cut", cut_json(s, cut)}, {"overlap", overlap_json(summary)}};
}

json receivers_json(const JobOutput& o) {
    const double count = std::max(1u, o.receivers.count());
    return {{"texels", o.receivers.count()},
            {"invalid", o.pages.invalid_texels},
            {"invalid_share", static_cast<double>(o.pages.invalid_texels) / count},
            {"albedo_clamped", o.receivers.clamped_albedo},
            {"positions_pushed_out", o.receivers.pushed_positions},
            {"range_clamped", o.pages.clamped_texels}};
}

json memory_json(const MemoryParts& bytes_of) {
    json parts = json::object();
    for (const auto& [name, bytes] : bytes_of) parts[name] = bytes;
    return parts;
}

std::array<double, AJAR_STAGE_COUNT> stage_seconds(const Job& job) {
    std::array<double, AJAR_STAGE_COUNT> seconds{};
    for (uint32_t s = 0; s < AJAR_STAGE_COUNT; ++s) seconds[s] = job.progress().stage_seconds(s);
    return seconds;
}

uint64_t peak_memory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<uint64_t>(usage.ru_maxrss) * 1024;
}

} // namespace

std::string make_report(const Job& job) {
    const JobOutput& o = job.output();
    json warnings = json::array();
    for (const Warning& w : o.warnings) warnings.push_back({{"culprit", w.culprit}, {"text", w.text}});
    const double seconds = std::max(job.seconds(), 1e-9);
    json report = {
        {"version", 1},
        {"generator", std::string("Ajar ") + AJAR_VERSION_TEXT},
        {"name", job.scene().name},
        {"result", "success"},
        {"settings", settings_json(job.settings())},
        {"seconds", seconds_json(job)},
        {"rays",
         {{"total", job.progress().rays()}, {"per_second", static_cast<double>(job.progress().rays()) / seconds}}},
        {"receivers", receivers_json(o)},
        {"error", error_json(job, o)},
        {"bounces", bounces_json(job, o)},
        {"time_limited", o.bake.time_limited},
        {"effects", effects_json(job, o, stage_seconds(job))},
        {"terms", terms_json(job.scene(), o.pages)},
        {"terms_total", terms_total_json(job.scene(), o.pages, o.bake.terms.cut)},
        {"warnings", warnings},
        {"memory_bytes", peak_memory()},
        {"memory_parts", memory_json(memory_parts(job.scene(), o))}};
    if (job.settings().check_points != 0) report["self_check"] = check_report_json(o.check);
    return report.dump(2, ' ', false, json::error_handler_t::replace);
}

std::string make_trial_report(const Job& job, const JobOutput& o) {
    json stages = json::object();
    for (uint32_t s = AJAR_STAGE_RECEIVERS; s < AJAR_STAGE_DONE; ++s)
        stages[ajar_stage_name(s)] = o.prediction.stages[s];
    const json report = {
        {"version", 1},
        {"generator", std::string("Ajar ") + AJAR_VERSION_TEXT},
        {"name", job.scene().name},
        {"result", "trial"},
        {"settings", settings_json(job.settings())},
        {"texels", o.receivers.count()},
        {"predicted_seconds", o.prediction.seconds},
        {"predicted_stages", stages},
        {"predicted_light_records", std::llround(o.bake.trial.lights)},
        {"predicted_memory_parts", memory_json(predicted_memory_parts(job.scene(), o, job.settings()))},
        {"effects", effects_json(job, o, o.prediction.stages)}};
    return report.dump(2, ' ', false, json::error_handler_t::replace);
}

} // namespace ajar
