// SPDX-License-Identifier: GPL-3.0-or-later
// Cancelling at any moment ends the job soon, leaves nothing behind and harms no later bake. The
// bound here is loose, for busy machines; the benchmark measures the promised second.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "room_kit.h"

namespace {

constexpr double kPatience = 5.0; // s

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

ajar_progress poll(ajar_job job) {
    ajar_progress p;
    ajar_progress_init(&p);
    kit::check(ajar_job_poll(job, &p));
    return p;
}

/// Waits until the job has reached the stage.
void await_stage(ajar_job job, uint32_t stage) {
    const auto begin = Clock::now();
    while (poll(job).stage < stage && seconds_since(begin) < 60.0)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ASSERT_GE(poll(job).stage, stage);
}

void expect_cancelled(ajar_job job) {
    const auto begin = Clock::now();
    EXPECT_EQ(ajar_job_cancel(job), AJAR_OK);
    EXPECT_EQ(ajar_job_wait(job, 2 * kPatience), AJAR_CANCELLED);
    EXPECT_LT(seconds_since(begin), kPatience);
    EXPECT_EQ(poll(job).result, AJAR_CANCELLED);
}

void expect_no_results(ajar_job job) {
    const kit::TempFolder folder;
    uint32_t w, h, c;
    uint64_t size = 0;
    EXPECT_EQ(ajar_job_layer_size(job, 0, AJAR_LAYER_IRRADIANCE, &w, &h, &c), AJAR_ERROR_STATE);
    EXPECT_EQ(ajar_job_report(job, nullptr, &size), AJAR_ERROR_STATE);
    EXPECT_EQ(ajar_job_write_package(job, folder.path("package").c_str(), nullptr), AJAR_ERROR_STATE);
    EXPECT_TRUE(folder.entries().empty());
}

class Cancel : public ::testing::TestWithParam<uint32_t> {
protected:
    void SetUp() override {
        kit::fill_room(scene_);
        endless_ = kit::endless();
        endless_.threads = GetParam();
    }
    void cancel_in(uint32_t stage, const ajar_settings& settings) {
        ajar_job job = kit::start(scene_, settings);
        await_stage(job, stage);
        EXPECT_EQ(poll(job).result, AJAR_RUNNING);
        expect_cancelled(job);
        expect_no_results(job);
        EXPECT_EQ(ajar_job_release(&job), AJAR_OK);
    }
    kit::Scene scene_;
    ajar_settings endless_;
};

TEST_P(Cancel, AtTheStart) { cancel_in(AJAR_STAGE_IDLE, endless_); }

TEST_P(Cancel, InTheBounces) {
    ajar_settings s = endless_;
    s.bounce_samples = 1u << 14;
    cancel_in(AJAR_STAGE_BOUNCES, s);
}

TEST_P(Cancel, InTheFinalGather) { cancel_in(AJAR_STAGE_GATHER, endless_); }

TEST_P(Cancel, AtRandomMomentsOfAShortBake) {
    ajar_settings s = kit::quick();
    s.threads = GetParam();
    for (int i = 0; i < 12; ++i) {
        ajar_job job = kit::start(scene_, s);
        std::this_thread::sleep_for(std::chrono::milliseconds(7 * i));
        EXPECT_EQ(ajar_job_cancel(job), AJAR_OK);
        const ajar_result result = ajar_job_wait(job, kPatience);
        EXPECT_TRUE(result == AJAR_CANCELLED || result == AJAR_OK) << result;
        if (result == AJAR_CANCELLED) expect_no_results(job);
        EXPECT_EQ(ajar_job_release(&job), AJAR_OK);
    }
}

TEST_P(Cancel, AfterTheEndChangesNothing) {
    ajar_settings s = kit::quick();
    s.threads = GetParam();
    const kit::Bake bake(scene_, s);
    EXPECT_EQ(ajar_job_cancel(bake.handle()), AJAR_OK);
    EXPECT_EQ(ajar_job_wait(bake.handle(), 0.0), AJAR_OK);
    EXPECT_TRUE(kit::all_finite(bake.layer(AJAR_LAYER_IRRADIANCE)));
}

TEST_P(Cancel, ThenRerunGivesTheSameBytesAsAFreshBake) {
    ajar_settings s = kit::quick();
    s.threads = GetParam();
    const kit::Layer fresh = kit::Bake(scene_, s).layer(AJAR_LAYER_IRRADIANCE);
    cancel_in(AJAR_STAGE_DIRECT, endless_);
    EXPECT_EQ(kit::Bake(scene_, s).layer(AJAR_LAYER_IRRADIANCE).data, fresh.data);
}

TEST_P(Cancel, ManyTimesAndFromManyThreads) {
    ajar_job job = kit::start(scene_, endless_);
    await_stage(job, AJAR_STAGE_DIRECT);
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i)
        threads.emplace_back([job] {
            for (int k = 0; k < 50; ++k) {
                ajar_job_cancel(job);
                poll(job);
            }
            EXPECT_EQ(ajar_job_wait(job, kPatience), AJAR_CANCELLED);
        });
    for (std::thread& t : threads) t.join();
    EXPECT_EQ(ajar_job_release(&job), AJAR_OK);
}

INSTANTIATE_TEST_SUITE_P(Threads, Cancel, ::testing::Values(1u, 2u),
                         [](const auto& info) { return std::to_string(info.param); });

} // namespace
