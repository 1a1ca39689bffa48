// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/progress.h"

#include <algorithm>

namespace ajar {

namespace {

double seconds_since(Progress::Clock::time_point then) {
    return std::chrono::duration<double>(Progress::Clock::now() - then).count();
}

} // namespace

uint32_t Progress::next_job() {
    static std::atomic<uint32_t> last{0};
    return last.fetch_add(1, std::memory_order_relaxed) % 0xffffff + 1;
}

void Progress::start() {
    start_ = stage_start_ = Clock::now();
    stage_.store(AJAR_STAGE_IDLE, std::memory_order_relaxed);
    fraction_.store(0.0f, std::memory_order_relaxed);
}

void Progress::begin_stage(uint32_t stage, float end_fraction) {
    check_cancel();
    seconds_[this->stage()].fetch_add(seconds_since(stage_start_), std::memory_order_relaxed);
    stage_start_ = Clock::now();
    stage_begin_ = stage_end_;
    stage_end_ = std::max(stage_begin_, end_fraction);
    fraction_.store(stage_begin_, std::memory_order_relaxed);
    stage_.store(stage, std::memory_order_relaxed);
}

void Progress::update(float stage_fraction) {
    const float f = stage_begin_ + (stage_end_ - stage_begin_) * std::clamp(stage_fraction, 0.0f, 1.0f);
    // Threads report out of order and a stage may loop more than once: the bar only rises.
    for (float shown = fraction();
         shown < f && !fraction_.compare_exchange_weak(shown, f, std::memory_order_relaxed);) {
    }
}

double Progress::elapsed() const { return seconds_since(start_); }

} // namespace ajar
