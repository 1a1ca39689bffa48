// SPDX-License-Identifier: GPL-3.0-or-later
// ajar_reference_*: what is refused, and how a job ends.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "room_kit.h"

namespace {

ajar_reference_settings good() { return kit::reference_settings(1, 10, 4); }

TEST(ReferenceAbi, SettingsOutOfRangeAreRefused) {
    kit::Scene scene;
    kit::fill_room(scene);
    ajar_reference r = nullptr;
    using Change = std::function<void(ajar_reference_settings&)>;
    const std::vector<Change> changes = {
        [](auto& s) { s.points = 0; },       [](auto& s) { s.bounces = 257; },
        [](auto& s) { s.batches = 3; },      [](auto& s) { s.time_limit = -1.0f; },
        [](auto& s) { s.time_limit = NAN; }, [](auto& s) { s.choice = 2; },
        [](auto& s) { s.normal[0] = 1.0f; }, [](auto& s) { s.normal[2] = -1.0f; },
        [](auto& s) { s.weight_count = 1; }, [](auto& s) { s.threads = 5000; },
    };
    for (size_t i = 0; i < changes.size(); ++i) {
        ajar_reference_settings s = good();
        changes[i](s);
        EXPECT_EQ(ajar_reference_start(scene.handle(), &s, &r), AJAR_ERROR_ARGUMENT) << i;
        EXPECT_EQ(r, nullptr);
    }
    ajar_reference_settings s = good();
    s.struct_size = 4;
    EXPECT_EQ(ajar_reference_start(scene.handle(), &s, &r), AJAR_ERROR_STRUCT_SIZE);
}

TEST(ReferenceAbi, WeightsMustFitTheirElements) {
    kit::Scene scene;
    scene.element(AJAR_ELEMENT_LIGHT_SET, "lamp");
    scene.element(AJAR_ELEMENT_TOGGLE, "crate");
    kit::fill_room(scene);
    ajar_reference_settings s = good();
    ajar_reference r = nullptr;
    float weights[2] = {3.0f, 1.5f};
    s.weight_count = 2;
    s.weights = weights;
    EXPECT_EQ(ajar_reference_start(scene.handle(), &s, &r), AJAR_ERROR_ARGUMENT) << "a toggle above 1";
    weights[1] = 1.0f;
    EXPECT_EQ(ajar_reference_start(scene.handle(), &s, &r), AJAR_OK);
    EXPECT_EQ(ajar_reference_release(&r), AJAR_OK);
    EXPECT_EQ(r, nullptr);
}

TEST(ReferenceAbi, NeedsACommittedSceneAndALightmap) {
    kit::Scene open, bare;
    ajar_reference_settings s = good();
    ajar_reference r = nullptr;
    EXPECT_EQ(ajar_reference_start(open.handle(), &s, &r), AJAR_ERROR_STATE);
    EXPECT_EQ(ajar_reference_start(nullptr, &s, &r), AJAR_ERROR_HANDLE);
    bare.commit();
    ASSERT_EQ(ajar_reference_start(bare.handle(), &s, &r), AJAR_OK);
    EXPECT_EQ(ajar_reference_wait(r, -1.0), AJAR_ERROR_INPUT);
    char text[200] = {}, culprit[50] = {};
    EXPECT_EQ(ajar_reference_error(r, text, sizeof(text), culprit, sizeof(culprit)), AJAR_OK);
    EXPECT_NE(std::string(text), "");
    ajar_reference_release(&r);
}

TEST(ReferenceAbi, CancelEndsItAndResultsNeedSuccess) {
    kit::Scene scene;
    kit::fill_room(scene);
    ajar_reference_settings s = good();
    s.batches = 1000000;
    ajar_reference r = nullptr;
    ASSERT_EQ(ajar_reference_start(scene.handle(), &s, &r), AJAR_OK);
    std::vector<ajar_reference_point> points(10);
    uint32_t batches = 0;
    EXPECT_EQ(ajar_reference_read(r, points.data(), 10, &batches), AJAR_RUNNING);
    EXPECT_EQ(ajar_reference_wait(r, 0.0), AJAR_RUNNING);
    EXPECT_EQ(ajar_reference_cancel(r), AJAR_OK);
    EXPECT_EQ(ajar_reference_wait(r, -1.0), AJAR_CANCELLED);
    EXPECT_EQ(ajar_reference_read(r, points.data(), 10, &batches), AJAR_ERROR_STATE);
    ajar_reference_release(&r);
    EXPECT_EQ(ajar_reference_cancel(r), AJAR_ERROR_HANDLE);
}

TEST(ReferenceAbi, BuffersAndPointsAreChecked) {
    kit::Scene scene;
    kit::fill_room(scene);
    ajar_reference_settings s = good();
    ajar_reference r = nullptr;
    ASSERT_EQ(ajar_reference_start(scene.handle(), &s, &r), AJAR_OK);
    ASSERT_EQ(ajar_reference_wait(r, -1.0), AJAR_OK);
    std::vector<ajar_reference_point> points(10);
    uint32_t batches = 0;
    EXPECT_EQ(ajar_reference_read(r, points.data(), 9, &batches), AJAR_ERROR_BUFFER);
    EXPECT_EQ(ajar_reference_read(r, nullptr, 10, &batches), AJAR_ERROR_BUFFER);
    EXPECT_EQ(ajar_reference_read(r, points.data(), 10, nullptr), AJAR_ERROR_ARGUMENT);
    ASSERT_EQ(ajar_reference_read(r, points.data(), 10, &batches), AJAR_OK);
    EXPECT_EQ(batches, 4u);
    ajar_progress progress;
    ajar_progress_init(&progress);
    ASSERT_EQ(ajar_reference_poll(r, &progress), AJAR_OK);
    EXPECT_EQ(progress.result, AJAR_OK);
    EXPECT_EQ(progress.rays, 10u * 4u * AJAR_REFERENCE_BATCH_PATHS);
    for (const auto& p : points) {
        EXPECT_LT(p.x, 48u);
        EXPECT_LT(p.y, 48u);
        EXPECT_GT(p.irradiance[0], 0.0f);
    }
    ajar_reference_release(&r);
}

} // namespace
