// SPDX-License-Identifier: GPL-3.0-or-later
// A finished bake is checked by brute force.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "scene_kit.h"

namespace {

/// A closed room with a lamp, a box in it.
void build_room(kit::Scene& scene) {
    const uint32_t grey = scene.diffuse({0.5f, 0.6f, 0.4f}), page = scene.page(48, 48);
    scene.instance(scene.mesh(kit::box({-2, -2, 0}, {2, 2, 3}, true)), grey, page, "room");
    ajar_light_desc lamp;
    ajar_light_desc_init(&lamp);
    lamp.name = "lamp";
    lamp.role = AJAR_ROLE_STATIC;
    lamp.energy = 60.0f;
    lamp.size_x = 0.1f;
    const double at[12] = {1, 0, 0, 0.5, 0, 1, 0, 0.3, 0, 0, 1, 2.0};
    scene.light(lamp, at);
    scene.commit();
}

nlohmann::json report_of(uint32_t check_points) {
    kit::Scene scene;
    build_room(scene);
    ajar_settings s = kit::settings(3, 256);
    s.check_points = check_points;
    kit::Bake bake(scene, s);
    return nlohmann::json::parse(bake.report());
}

TEST(SelfCheck, BruteForceAgreesWithARightBake) {
    const nlohmann::json report = report_of(128);
    const auto& check = report.at("self_check");
    EXPECT_GT(check.at("points").get<int>(), 100);
    const double error = check.at("ratio_error");
    EXPECT_LT(error, 0.05);
    EXPECT_NEAR(check.at("ratio").get<double>(), 1.0, 4.0 * error + 0.01);
    EXPECT_LT(check.at("far_share").get<double>(), 0.1);
    EXPECT_LT(check.at("bounce_gain").get<double>(), 0.8);
    EXPECT_TRUE(report.at("warnings").empty());
}

TEST(SelfCheck, NothingIsCheckedUnlessAskedFor) { EXPECT_FALSE(report_of(0).contains("self_check")); }

} // namespace
