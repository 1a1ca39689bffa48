// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "api/self_check.h"
#include "api/task.h"
#include "base/work_clock.h"
#include "package/weight_polynomial.h"

namespace ajar {

/// What a finished job knows, for results and report.
struct JobOutput {
    BakedPages pages;
    std::vector<WeightTerm> weight_terms; ///< the terms that callers read
    LightmapReceivers receivers;
    BakeResult bake;
    std::vector<Warning> warnings;
    uint32_t emissive_triangles = 0;
    bool sky_sampled = false;
    SelfCheck check;
    WorkClock::Counts work{};
    /// Of a trial: what its bake would take, s.
    struct Prediction {
        double seconds = 0.0;
        std::array<double, AJAR_STAGE_COUNT> stages{};
    } prediction;
};

/// One bake on its own thread: runs the stages in order and keeps what came out.
class Job {
public:
    Job(std::shared_ptr<const Snapshot> scene, const ajar_settings& settings);

    Task& task() { return task_; }
    const Snapshot& scene() const { return *scene_; }
    const ajar_settings& settings() const { return settings_; }
    const Progress& progress() const { return task_.progress(); }
    double seconds() const { return task_.seconds(); }
    /// Throws AJAR_RUNNING or the job's failure unless it succeeded.
    const JobOutput& output() const;
    std::string report() const;

private:
    void watch(Progress& progress);
    void bake(Progress& progress);
    float time_for_passes(const Tracer& tracer, ThreadPool& pool, Progress& progress) const;
    void predict(const Tracer& tracer, ThreadPool& pool, Progress& progress, double seconds_to_store);

    std::shared_ptr<const Snapshot> scene_;
    ajar_settings settings_;
    JobOutput output_;
    Task task_; ///< last: it runs while the rest is there
};

/// Report of a finished job as JSON (schemas/report.schema.json).
std::string make_report(const Job& job);
/// That of a trial: its settings, and what the bake would do and take.
std::string make_trial_report(const Job& job, const JobOutput& output);

/// Throws Error(AJAR_ERROR_CPU) where the kernels' instructions are missing.
void check_cpu();

} // namespace ajar
