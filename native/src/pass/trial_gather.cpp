// SPDX-License-Identifier: GPL-3.0-or-later
#include "pass/trial_gather.h"

#include <atomic>
#include <numeric>

namespace ajar {

namespace {

constexpr double kSeconds = 1.5;
constexpr size_t kTilesPerThread = 16; ///< of a round: the wait for the slowest must not count much
constexpr double kGolden = 0.6180339887;

/// A step through n tiles that visits all and soon lies everywhere.
size_t spread_step(size_t n) {
    auto step = std::max<size_t>(static_cast<size_t>(kGolden * static_cast<double>(n)), 1);
    while (std::gcd(step, n) != 1) ++step;
    return step;
}

} // namespace

uint32_t trial_bounce_samples(uint32_t wanted) { return std::min(wanted, std::max(wanted / 4, 16u)); }

void gather_some(const LightmapReceivers& receivers, ThreadPool& pool, Progress& progress,
                 const std::function<size_t(size_t)>& finish_tile, TrialTimes& times) {
    const size_t n = receivers.tiles.size(), step = spread_step(n), round = kTilesPerThread * pool.size();
    const double start = progress.elapsed();
    std::atomic<size_t> lights{0};
    double done = 0.0;
    size_t next = 0;
    while (next < n && progress.elapsed() - start < kSeconds) {
        const size_t count = std::min(round, n - next);
        pool.for_each(
            count, progress, [&](size_t k) { lights += finish_tile((next + k) * step % n); }, false);
        for (size_t k = 0; k < count; ++k) done += receivers.tiles[(next + k) * step % n].count;
        next += count;
    }
    const double whole = receivers.count() / std::max(done, 1.0);
    times.gather = whole * (progress.elapsed() - start);
    times.lights = whole * static_cast<double>(lights);
}

} // namespace ajar
