// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>

#include "base/error.h"

namespace ajar {

/// Thrown by check_cancel; ends a job with AJAR_CANCELLED.
struct Cancelled {};

/// What a running job shows to the outside. Written by the job, read by anyone, lock free.
class Progress {
public:
    using Clock = std::chrono::steady_clock;

    void start();
    /// Enters a stage whose share of the whole bake ends at end_fraction.
    void begin_stage(uint32_t stage, float end_fraction);
    /// Part of the current stage that is done, 0..1.
    void update(float stage_fraction);
    void add_rays(uint64_t count) { rays_.fetch_add(count, std::memory_order_relaxed); }

    void request_cancel() { cancel_.store(true, std::memory_order_relaxed); }
    bool cancelled() const { return cancel_.load(std::memory_order_relaxed); }
    void check_cancel() const {
        if (cancelled()) throw Cancelled{};
    }

    /// Number that tells this job from others, never 0.
    uint32_t job() const { return job_; }
    uint32_t stage() const { return stage_.load(std::memory_order_relaxed); }
    float fraction() const { return fraction_.load(std::memory_order_relaxed); }
    uint64_t rays() const { return rays_.load(std::memory_order_relaxed); }
    double elapsed() const;
    /// Seconds spent in each stage so far.
    double stage_seconds(uint32_t stage) const { return seconds_[stage].load(std::memory_order_relaxed); }

private:
    std::atomic<bool> cancel_{false};
    std::atomic<uint32_t> stage_{AJAR_STAGE_IDLE};
    std::atomic<float> fraction_{0.0f};
    std::atomic<uint64_t> rays_{0};
    std::array<std::atomic<double>, AJAR_STAGE_COUNT> seconds_{};
    const uint32_t job_ = next_job();
    static uint32_t next_job();
    float stage_begin_ = 0.0f, stage_end_ = 0.0f;
    Clock::time_point start_ = Clock::now(), stage_start_ = Clock::now();
};

} // namespace ajar
