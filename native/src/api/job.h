// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "package/baked_pages.h"

namespace ajar {

/// What a finished job knows, for results and report.
struct JobOutput {
    BakedPages pages;
    LightmapReceivers receivers;
    BakeResult bake; ///< arrays per receiver that the pages copied are emptied
    std::vector<Warning> warnings;
    uint32_t emissive_triangles = 0;
    bool sky_sampled = false;
};

/// One bake on its own thread: runs the stages in order and keeps result and failure.
class Job {
public:
    Job(std::shared_ptr<const Snapshot> scene, const ajar_settings& settings);
    ~Job();

    void poll(ajar_progress& out) const;
    void cancel() { progress_.request_cancel(); }
    /// Result, or AJAR_RUNNING when timeout seconds (negative: forever) pass first.
    ajar_result wait(double timeout);
    ajar_result result() const;
    Warning failure() const;

    const Snapshot& scene() const { return *scene_; }
    const ajar_settings& settings() const { return settings_; }
    const Progress& progress() const { return progress_; }
    double seconds() const { return seconds_; }
    /// Throws AJAR_RUNNING or the job's failure unless it succeeded.
    const JobOutput& output() const;
    std::string report() const;

private:
    void run();
    void bake();
    void finish(ajar_result result, const std::string& message = {}, const std::string& culprit = {});

    std::shared_ptr<const Snapshot> scene_;
    ajar_settings settings_;
    Progress progress_;
    JobOutput output_;
    mutable std::mutex mutex_;
    std::condition_variable done_;
    ajar_result result_ = AJAR_RUNNING;
    Warning failure_;
    double seconds_ = 0.0;
    std::thread thread_;
};

/// Report of a finished job as JSON (schemas/report.schema.json).
std::string make_report(const Job& job);

/// Throws Error(AJAR_ERROR_CPU) where the kernels' instructions are missing.
void check_cpu();

} // namespace ajar
