// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <xmmintrin.h>

#include <atomic>
#include <thread>

#include "base/work_clock.h"

namespace ajar {

namespace {

// Denormals cost hundreds of cycles and carry nothing here; Embree asks for the same.
void flush_denormals() { _mm_setcsr(_mm_getcsr() | 0x8040); }

} // namespace

struct ThreadPool::Impl {
    explicit Impl(uint32_t threads)
        : limit(tbb::global_control::max_allowed_parallelism, threads), arena(static_cast<int>(threads)) {}
    tbb::global_control limit;
    tbb::task_arena arena;
};

ThreadPool::ThreadPool(uint32_t threads)
    : size_(threads != 0 ? threads : std::max(1u, std::thread::hardware_concurrency())) {
    impl_ = std::make_unique<Impl>(size_);
}

ThreadPool::~ThreadPool() = default;

void ThreadPool::for_each(size_t count, Progress& progress, const std::function<void(size_t)>& body, bool report) {
    std::atomic<size_t> done{0};
    progress.check_cancel();
    const Effect effect = Worker::mine().effect();
    const Working waits(0, effect);
    const auto one = [&](size_t i) {
        if (progress.cancelled()) return;
        flush_denormals();
        const Working here(progress.job(), effect);
        body(i);
        const size_t finished = done.fetch_add(1, std::memory_order_relaxed) + 1;
        if (report) progress.update(static_cast<float>(finished) / static_cast<float>(count));
    };
    impl_->arena.execute([&] { tbb::parallel_for(size_t{0}, count, one); });
    progress.check_cancel();
}

} // namespace ajar
