// SPDX-License-Identifier: GPL-3.0-or-later
#include "api/job.h"

#include <chrono>
#include <cstdio>
#include <numeric>

#include "api/cut_report.h"
#include "encode/ahd.h"
#include "pass/flipped_sides.h"
#include "pass/term_bake.h"
#include "pass/twin_check.h"

namespace ajar {

namespace {

/// Seconds that storing the light of one texel takes, of one term: its costly part, tried on made-up light.
double seconds_to_store(uint32_t threads) {
    constexpr uint32_t kTried = 256;
    constexpr double kWithTheRest = 2.0; // filling, seams, copies
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    float sum = 0.0f;
    for (uint32_t i = 0; i < kTried; ++i) {
        float sh[kShCount];
        const float x = unit_float(hash32(2 * i)) - 0.5f, y = unit_float(hash32(2 * i + 1)) - 0.5f;
        sh_basis(x, y, std::sqrt(1.0f - x * x - y * y), sh);
        sum += fit_ahd(Vec3(1.0f), sh).ratio;
    }
    const double each = std::chrono::duration<double>(Clock::now() - start).count() / kTried;
    return std::isfinite(sum) ? kWithTheRest * each / threads : 0.0; // always; keeps the trial from being left out
}

/// Receivers, bounces and the fewest rays take their time, however short the limit.
void warn_of_lateness(const ajar_settings& settings, double seconds, const std::string& scene,
                      std::vector<Warning>& warnings) {
    constexpr double kLate = 1.1;
    if (!(settings.time_limit > 0.0f) || seconds <= kLate * settings.time_limit) return;
    char text[160];
    std::snprintf(text, sizeof text,
                  "took %.0f s although its time limit is %.0f s: even the fewest rays take that long; lower the texel "
                  "density or the bounces",
                  seconds, settings.time_limit);
    warnings.push_back({scene, text});
}

} // namespace

Job::Job(std::shared_ptr<const Snapshot> scene, const ajar_settings& settings)
    : scene_(std::move(scene)), settings_(settings), task_([this](Progress& progress) { watch(progress); }) {}

void Job::watch(Progress& progress) {
    const WorkClock clock(progress);
    const Working here(progress.job(), Effect::rest);
    bake(progress);
    output_.work = clock.counts();
}

void Job::bake(Progress& progress) {
    ThreadPool pool(settings_.threads);
    const Snapshot& scene = *scene_;
    output_.warnings = scene.warnings;
    progress.begin_stage(AJAR_STAGE_ACCEL, 0.01f);
    const Tracer tracer(scene);
    progress.begin_stage(AJAR_STAGE_RECEIVERS, 0.06f);
    const Coverage coverage = rasterize(scene, pool, progress);
    const std::vector<Behind> behind = find_solids(scene, tracer);
    output_.receivers = make_receivers(scene, tracer, coverage, behind, settings_.positions_per_texel, pool, progress,
                                       output_.warnings);
    if (output_.receivers.count() == 0)
        throw Error(AJAR_ERROR_INPUT, "nothing in the scene has lightmap texels; mark a mesh as lightmapped",
                    scene.name);
    for (Warning& w : find_flipped_sides(scene, tracer, behind, pool, progress))
        output_.warnings.push_back(std::move(w));
    const SurfaceTable surfaces(scene, behind);
    const EmitterSet emitters(scene, pool, progress);
    output_.emissive_triangles = emitters.emissive_triangles();
    output_.sky_sampled = emitters.sky_emitter() != EmitterSet::kNone;
    const LampSpots spots(scene, tracer, surfaces, emitters);
    const GatherScene gather{scene, tracer, surfaces, emitters, output_.receivers, progress, &spots};
    const double store = settings_.time_limit > 0.0f || settings_.trial != 0 ? seconds_to_store(pool.size()) : 0.0;
    ajar_settings passes = settings_;
    passes.time_limit = time_for_passes(tracer, pool, progress);
    output_.bake = scene.elements.empty() ? Baker(gather, passes, pool, progress, store).run()
                                          : TermBaker(gather, passes, pool, progress, store).run();
    if (settings_.trial != 0) return predict(tracer, pool, progress, store);
    progress.begin_stage(AJAR_STAGE_POST, 0.97f);
    output_.pages = make_pages(scene, output_.receivers, output_.bake, settings_, pool, progress);
    std::vector<std::vector<uint32_t>> products;
    for (const BakedTerm& t : output_.pages.terms) products.push_back(t.elements);
    output_.weight_terms = in_weights(package_content(scene, output_.pages, settings_).elements, products);
    for (Warning& w : cut_warnings(scene, output_.bake.terms.cut, settings_.combinations))
        output_.warnings.push_back(std::move(w));
    for (const Warning& w : output_.pages.warnings) output_.warnings.push_back(w);
    warn_of_lateness(settings_, progress.elapsed(), scene.name, output_.warnings);
    if (settings_.check_points == 0) return;
    output_.check =
        check_bake(scene, tracer, output_.receivers, output_.bake, output_.pages, settings_, pool, progress);
    for (Warning& w : check_warnings(output_.check, scene.name)) output_.warnings.push_back(std::move(w));
}

/// The time limit less what the self-check will take, by a few of its points. 0: none.
float Job::time_for_passes(const Tracer& tracer, ThreadPool& pool, Progress& progress) const {
    constexpr uint32_t kOfPoints = 16;
    if (!(settings_.time_limit > 0.0f) || settings_.trial != 0 || settings_.check_points < kOfPoints)
        return settings_.time_limit;
    ajar_settings few = settings_;
    few.check_points /= kOfPoints;
    const double check = kOfPoints * try_check(*scene_, tracer, few, pool, progress);
    return static_cast<float>(std::max(settings_.time_limit - check, 0.1 * settings_.time_limit));
}

/// What a bake takes: the trial's own time, with the passes that it only tried a part of as long as all of them.
void Job::predict(const Tracer& tracer, ThreadPool& pool, Progress& progress, double seconds_to_store) {
    progress.begin_stage(AJAR_STAGE_POST, 1.0f);
    const TrialTimes& t = output_.bake.trial;
    auto& stages = output_.prediction.stages;
    for (uint32_t i = 0; i < AJAR_STAGE_COUNT; ++i) stages[i] = progress.stage_seconds(i);
    stages[AJAR_STAGE_BOUNCES] = t.bounces;
    stages[AJAR_STAGE_GATHER] = t.gather + check_seconds(output_.receivers.tiles.size(), settings_.bounces,
                                                         stages[AJAR_STAGE_DIRECT] + t.bounces, t.gather);
    stages[AJAR_STAGE_ENCODE] = seconds_to_store * (output_.receivers.count() + t.lights);
    double seconds = std::accumulate(stages.begin(), stages.end(), 0.0);
    if (settings_.check_points != 0) seconds += try_check(*scene_, tracer, settings_, pool, progress);
    if (settings_.time_limit > 0.0f) seconds = std::min<double>(seconds, settings_.time_limit);
    output_.prediction.seconds = seconds;
}

const JobOutput& Job::output() const {
    task_.require_success();
    if (settings_.trial != 0)
        throw Error(AJAR_ERROR_STATE, "this job was a trial and baked no light; read its report", scene_->name);
    return output_;
}

std::string Job::report() const {
    task_.require_success();
    return settings_.trial != 0 ? make_trial_report(*this, output_) : make_report(*this);
}

void check_cpu() {
#ifdef AJAR_REQUIRES_AVX2
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma"))
        throw Error(AJAR_ERROR_CPU, "this build of Ajar needs a processor with AVX2; build it with -DAJAR_ARCH=x86-64");
#endif
}

} // namespace ajar
