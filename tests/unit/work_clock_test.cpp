// SPDX-License-Identifier: GPL-3.0-or-later
// What a bake's time went into.
#include "base/work_clock.h"

#include <gtest/gtest.h>

#include "base/parallel.h"

namespace ajar {
namespace {

uint64_t seen(const WorkClock& clock, Effect e) {
    uint64_t sum = 0;
    const WorkClock::Counts counts = clock.counts();
    for (const auto& stage : counts) sum += stage[static_cast<size_t>(e)];
    return sum;
}

TEST(WorkClock, SeesTheThreadsOfItsOwnJob) {
    Progress progress, other;
    ThreadPool pool(2);
    const WorkClock clock(progress);
    const auto wait = [&](Progress& of, Effect effect) {
        const Working here(of.job(), effect);
        pool.for_each(2, of, [](size_t) { std::this_thread::sleep_for(std::chrono::milliseconds(60)); });
    };
    wait(progress, Effect::doors);
    wait(other, Effect::sky);
    EXPECT_GT(seen(clock, Effect::doors), 0u);
    EXPECT_EQ(seen(clock, Effect::sky), 0u);
    EXPECT_EQ(seen(clock, Effect::toggles), 0u);
}

TEST(WorkClock, ScopesGiveBackWhatWasBefore) {
    Worker& worker = Worker::mine();
    const Working outer(7, Effect::bounces);
    {
        const Working inner(Effect::doors);
        worker.set(Effect::toggles);
        EXPECT_EQ(worker.effect(), Effect::toggles);
    }
    EXPECT_EQ(worker.effect(), Effect::bounces);
}

TEST(WorkClock, SharesAreOfTheWholeTime) {
    WorkClock::Counts counts{};
    std::array<double, AJAR_STAGE_COUNT> seconds{};
    seconds[AJAR_STAGE_BOUNCES] = 1.0, seconds[AJAR_STAGE_GATHER] = 3.0;
    counts[AJAR_STAGE_BOUNCES][static_cast<size_t>(Effect::bounces)] = 5;
    counts[AJAR_STAGE_GATHER][static_cast<size_t>(Effect::bounces)] = 1;
    counts[AJAR_STAGE_GATHER][static_cast<size_t>(Effect::sky)] = 3;
    const auto shares = time_shares(counts, seconds);
    EXPECT_DOUBLE_EQ(shares[static_cast<size_t>(Effect::bounces)], 0.25 + 0.75 * 0.25);
    EXPECT_DOUBLE_EQ(shares[static_cast<size_t>(Effect::sky)], 0.75 * 0.75);
    EXPECT_DOUBLE_EQ(time_shares(counts, {})[static_cast<size_t>(Effect::sky)], 0.0);
}

} // namespace
} // namespace ajar
