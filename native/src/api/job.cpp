// SPDX-License-Identifier: GPL-3.0-or-later
#include "api/job.h"

#include <chrono>
#include <new>

#include "pass/term_bake.h"

namespace ajar {

Job::Job(std::shared_ptr<const Snapshot> scene, const ajar_settings& settings)
    : scene_(std::move(scene)), settings_(settings) {
    progress_.start();
    thread_ = std::thread([this] { run(); });
}

Job::~Job() {
    cancel();
    if (thread_.joinable()) thread_.join();
}

void Job::run() {
    try {
        bake();
        progress_.begin_stage(AJAR_STAGE_DONE, 1.0f);
        seconds_ = progress_.elapsed();
        finish(AJAR_OK);
    } catch (const Cancelled&) {
        finish(AJAR_CANCELLED, "the bake was cancelled");
    } catch (const Error& e) {
        finish(e.code(), e.what(), e.culprit());
    } catch (const std::bad_alloc&) {
        finish(AJAR_ERROR_MEMORY, "not enough memory; lower the texel density or the atlas size");
    } catch (const std::exception& e) {
        finish(AJAR_ERROR_INTERNAL, e.what());
    } catch (...) {
        finish(AJAR_ERROR_INTERNAL, "unknown failure");
    }
}

void Job::bake() {
    ThreadPool pool(settings_.threads);
    const Snapshot& scene = *scene_;
    output_.warnings = scene.warnings;
    progress_.begin_stage(AJAR_STAGE_ACCEL, 0.01f);
    const Tracer tracer(scene);
    progress_.begin_stage(AJAR_STAGE_RECEIVERS, 0.06f);
    const Coverage coverage = rasterize(scene, pool, progress_);
    output_.receivers =
        make_receivers(scene, tracer, coverage, settings_.positions_per_texel, pool, progress_, output_.warnings);
    if (output_.receivers.count() == 0)
        throw Error(AJAR_ERROR_INPUT, "nothing in the scene has lightmap texels; mark a mesh as lightmapped",
                    scene.name);
    const SurfaceTable surfaces(scene);
    const EmitterSet emitters(scene, pool, progress_);
    output_.emissive_triangles = emitters.emissive_triangles();
    output_.sky_sampled = emitters.sky_emitter() != EmitterSet::kNone;
    const GatherScene gather{scene, tracer, surfaces, emitters, output_.receivers, progress_};
    output_.bake = scene.elements.empty() ? Baker(gather, settings_, pool, progress_).run()
                                          : TermBaker(gather, settings_, pool, progress_).run();
    progress_.begin_stage(AJAR_STAGE_POST, 0.97f);
    output_.pages = make_pages(scene, output_.receivers, output_.bake, settings_, pool, progress_);
}

void Job::finish(ajar_result result, const std::string& message, const std::string& culprit) {
    const std::scoped_lock lock(mutex_);
    result_ = result;
    failure_ = {culprit, message};
    done_.notify_all();
}

ajar_result Job::result() const {
    const std::scoped_lock lock(mutex_);
    return result_;
}

Warning Job::failure() const {
    const std::scoped_lock lock(mutex_);
    return failure_;
}

ajar_result Job::wait(double timeout) {
    std::unique_lock lock(mutex_);
    const auto ended = [&] { return result_ != AJAR_RUNNING; };
    if (timeout < 0.0)
        done_.wait(lock, ended);
    else
        done_.wait_for(lock, std::chrono::duration<double>(std::min(timeout, 1e6)), ended);
    return result_;
}

void Job::poll(ajar_progress& out) const {
    out.stage = progress_.stage();
    out.fraction = progress_.fraction();
    out.elapsed = static_cast<float>(progress_.elapsed());
    // Early fractions say little; a guess from them would jump about.
    out.remaining = out.fraction > 0.1f ? out.elapsed * (1.0f - out.fraction) / out.fraction : -1.0f;
    out.result = result();
    out.rays = progress_.rays();
}

const JobOutput& Job::output() const {
    const ajar_result r = result();
    if (r == AJAR_RUNNING) throw Error(AJAR_RUNNING, "the bake is still running; wait for it first");
    if (r != AJAR_OK) throw Error(AJAR_ERROR_STATE, "the bake did not finish: " + failure().text, failure().culprit);
    return output_;
}

std::string Job::report() const {
    output();
    return make_report(*this);
}

void check_cpu() {
#ifdef AJAR_REQUIRES_AVX2
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma"))
        throw Error(AJAR_ERROR_CPU, "this build of Ajar needs a processor with AVX2; build it with -DAJAR_ARCH=x86-64");
#endif
}

} // namespace ajar
