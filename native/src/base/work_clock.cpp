// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/work_clock.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace ajar {

namespace {

constexpr auto kTick = std::chrono::milliseconds(2);

/// All threads that ever noted something and still run.
struct Registry {
    std::mutex mutex;
    std::vector<Worker*> workers;
};

/// Never destroyed: threads of the pool may end after static objects.
Registry& registry() {
    static Registry& r = *new Registry;
    return r;
}

struct Registration {
    Worker worker;

    Registration() {
        const std::scoped_lock lock(registry().mutex);
        registry().workers.push_back(&worker);
    }
    ~Registration() {
        const std::scoped_lock lock(registry().mutex);
        std::erase(registry().workers, &worker);
    }
};

} // namespace

Worker& Worker::mine() {
    thread_local Registration registration;
    return registration.worker;
}

WorkClock::WorkClock(const Progress& progress) : progress_(progress), thread_([this] { watch(); }) {}

WorkClock::~WorkClock() {
    {
        const std::scoped_lock lock(mutex_);
        ended_ = true;
    }
    end_.notify_all();
    thread_.join();
}

void WorkClock::watch() {
    std::unique_lock lock(mutex_);
    while (!end_.wait_for(lock, kTick, [this] { return ended_; })) look();
}

void WorkClock::look() {
    auto& stage = counts_[std::min<uint32_t>(progress_.stage(), AJAR_STAGE_COUNT - 1)];
    const std::scoped_lock lock(registry().mutex);
    for (const Worker* w : registry().workers) {
        const uint32_t note = w->note_.load(std::memory_order_relaxed);
        if (note >> 8 == progress_.job()) ++stage[std::min<size_t>(note & 0xff, kEffects - 1)];
    }
}

WorkClock::Counts WorkClock::counts() const {
    const std::scoped_lock lock(mutex_);
    return counts_;
}

std::array<double, kEffects> time_shares(const WorkClock::Counts& counts,
                                         const std::array<double, AJAR_STAGE_COUNT>& seconds) {
    std::array<double, kEffects> shares{};
    const double whole = std::accumulate(seconds.begin(), seconds.end(), 0.0);
    for (size_t s = 0; s < counts.size(); ++s) {
        const auto seen = std::accumulate(counts[s].begin(), counts[s].end(), uint64_t{0});
        for (size_t e = 0; seen != 0 && whole > 0.0 && e < kEffects; ++e)
            shares[e] += seconds[s] / whole * static_cast<double>(counts[s][e]) / static_cast<double>(seen);
    }
    return shares;
}

} // namespace ajar
