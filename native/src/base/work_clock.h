// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>

#include "base/progress.h"

namespace ajar {

/// What a thread works on, as far as the report tells it apart.
enum class Effect : uint8_t {
    rest,
    primary_lights,
    static_lights,
    emissive_surfaces,
    sky,
    transparency,
    unmapped_surfaces,
    bright_texels,
    light_sets,
    doors,
    toggles,
    bounces,
    seams
};
inline constexpr size_t kEffects = static_cast<size_t>(Effect::seams) + 1;

/// A thread's note of what it works on: a store, cheap enough for a kernel's inner loop.
class Worker {
public:
    /// That of the calling thread.
    static Worker& mine();

    Effect effect() const { return static_cast<Effect>(note_.load(std::memory_order_relaxed) & 0xff); }
    /// Another effect, for the same job.
    void set(Effect e) {
        note_.store((note_.load(std::memory_order_relaxed) & ~0xffu) | static_cast<uint32_t>(e),
                    std::memory_order_relaxed);
    }

private:
    friend class Working;
    friend class WorkClock;
    std::atomic<uint32_t> note_{0}; ///< job << 8 | effect; job 0: idle
};

/// From here to the end of its scope the calling thread works on an effect.
class Working {
public:
    explicit Working(Effect e) : worker_(Worker::mine()), before_(worker_.note_.load(std::memory_order_relaxed)) {
        worker_.set(e);
    }
    /// For a job, by its number; 0: idle.
    Working(uint32_t job, Effect e) : Working(e) {
        worker_.note_.store(job << 8 | static_cast<uint32_t>(e), std::memory_order_relaxed);
    }
    ~Working() { worker_.note_.store(before_, std::memory_order_relaxed); }
    Working(const Working&) = delete;
    Working& operator=(const Working&) = delete;

private:
    Worker& worker_;
    uint32_t before_;
};

/// Looks every few milliseconds at what the threads of a job work on: so the report can say what a bake's time went
/// into, at no cost to the kernels.
class WorkClock {
public:
    /// Watches until it ends. progress: the job's, must outlive it.
    explicit WorkClock(const Progress& progress);
    ~WorkClock();
    WorkClock(const WorkClock&) = delete;
    WorkClock& operator=(const WorkClock&) = delete;

    /// How often a thread was seen at an effect, by stage.
    using Counts = std::array<std::array<uint64_t, kEffects>, AJAR_STAGE_COUNT>;
    Counts counts() const;

private:
    void watch();
    void look();

    const Progress& progress_;
    mutable std::mutex mutex_;
    std::condition_variable end_;
    bool ended_ = false;
    Counts counts_{};
    std::thread thread_;
};

/// Parts of the whole time that went into each effect; together 1 or, where nothing was seen, less.
/// seconds: of each stage.
std::array<double, kEffects> time_shares(const WorkClock::Counts& counts,
                                         const std::array<double, AJAR_STAGE_COUNT>& seconds);

} // namespace ajar
