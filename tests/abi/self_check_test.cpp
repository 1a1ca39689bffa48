// SPDX-License-Identifier: GPL-3.0-or-later
// A finished bake is checked by brute force.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "room_kit.h"

namespace {

/// A closed room with a lamp, of a set unless that is AJAR_NONE; not committed.
void build_room_in(kit::Scene& scene, uint32_t set) {
    const uint32_t grey = scene.diffuse({0.5f, 0.6f, 0.4f}), page = scene.page(48, 48);
    scene.instance(scene.mesh(kit::box({-2, -2, 0}, {2, 2, 3}, true)), grey, page, "room");
    ajar_light_desc lamp;
    ajar_light_desc_init(&lamp);
    lamp.name = "lamp";
    lamp.role = AJAR_ROLE_STATIC;
    lamp.energy = 60.0f;
    lamp.size_x = 0.1f;
    const double at[12] = {1, 0, 0, 0.5, 0, 1, 0, 0.3, 0, 0, 1, 2.0};
    scene.current_set = set;
    scene.light(lamp, at);
    scene.current_set = AJAR_NONE;
}

void build_room(kit::Scene& scene, bool lamp_in_set = false) {
    build_room_in(scene, lamp_in_set ? scene.element(AJAR_ELEMENT_LIGHT_SET, "lamps") : AJAR_NONE);
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

/// Root mean square of the relative difference that seeds make to the light of all terms, per bake.
double spread(const std::vector<double>& a, const std::vector<double>& b) {
    double squares = 0.0, count = 0.0;
    for (size_t i = 0; i < a.size(); ++i) {
        const double mean = 0.5 * (a[i] + b[i]);
        if (mean <= 0.0) continue;
        squares += 0.5 * (a[i] - b[i]) * (a[i] - b[i]) / (mean * mean);
        count += 1.0;
    }
    return std::sqrt(squares / count);
}

TEST(Report, StatesTheErrorOfLightInSetsToo) {
    kit::Scene scene;
    build_room(scene, true);
    std::vector<double> light[2];
    double told = 0.0;
    for (uint32_t seed = 0; seed < 2; ++seed) {
        ajar_settings s = kit::settings(3, 256);
        s.seed = seed;
        const kit::Bake bake(scene, s);
        told += 0.5 * nlohmann::json::parse(bake.report()).at("error").at("estimated_rms").get<double>();
        const kit::Layer lit = bake.term(1, 48, 48), valid = bake.layer(AJAR_LAYER_VALIDITY);
        for (size_t i = 0; i < valid.data.size(); ++i)
            light[seed].push_back(valid.data[i] != 1.0f ? 0.0
                                                        : 0.2126 * lit.data[3 * i] + 0.7152 * lit.data[3 * i + 1] +
                                                              0.0722 * lit.data[3 * i + 2]);
    }
    EXPECT_NEAR(told / spread(light[0], light[1]), 1.0, 0.25);
}

TEST(Memory, ALimitThatElementsNeedMoreOfEndsTheBakeWithARemedy) {
    kit::Scene plain, elements;
    build_room(plain);
    build_room(elements, true);
    ajar_settings s = kit::settings(2, 64);
    s.memory_limit = 1e-4f; // 100 kB
    EXPECT_NO_THROW(kit::Bake(plain, s)) << "no element takes any";
    ajar_job job = nullptr;
    ASSERT_EQ(ajar_job_start(elements.handle(), &s, &job), AJAR_OK);
    EXPECT_EQ(ajar_job_wait(job, -1.0), AJAR_ERROR_MEMORY);
    char text[256], culprit[64];
    ASSERT_EQ(ajar_job_error(job, text, sizeof text, culprit, sizeof culprit), AJAR_OK);
    EXPECT_NE(std::string(text).find("keep threshold"), std::string::npos) << text;
    ajar_job_release(&job);
    s.memory_limit = 1.0f;
    EXPECT_NO_THROW(kit::Bake(elements, s));
    s.memory_limit = -1.0f;
    EXPECT_EQ(ajar_job_start(elements.handle(), &s, &job), AJAR_ERROR_ARGUMENT);
}

TEST(Report, MemoryIsOnlyForWhatTheSceneCallsFor) {
    kit::Scene plain, elements;
    build_room(plain);
    build_room(elements, true);
    const auto parts = [](const kit::Scene& scene) {
        const kit::Bake bake(scene, kit::settings(2, 64));
        return nlohmann::json::parse(bake.report()).at("memory_parts");
    };
    const nlohmann::json without = parts(plain), with = parts(elements);
    EXPECT_EQ(without.at("terms"), 0);
    EXPECT_EQ(without.at("spherical_harmonics_layers"), 0);
    EXPECT_GT(with.at("terms"), 48 * 48 * 4);
    EXPECT_GT(without.at("pages"), 48 * 48 * 4);
    EXPECT_EQ(without.at("receivers"), with.at("receivers"));
}

std::map<std::string, nlohmann::json> effects_by_name(const nlohmann::json& report) {
    std::map<std::string, nlohmann::json> out;
    for (const auto& effect : report.at("effects")) out[effect.at("name")] = effect;
    return out;
}

TEST(Report, SaysWhatTookTheTime) {
    kit::Scene scene;
    build_room(scene, true);
    ajar_settings s = kit::settings(3, 4096);
    const auto effects = effects_by_name(nlohmann::json::parse(kit::Bake(scene, s).report()));
    double sum = 0.0;
    for (const auto& [name, effect] : effects) {
        EXPECT_TRUE(effect.at("status") == "simulated" || !effect.contains("time_share")) << name;
        sum += effect.value("time_share", 0.0);
    }
    EXPECT_GT(effects.at("bounces").at("time_share").get<double>(), 0.1);
    EXPECT_GT(sum, 0.3);
    EXPECT_LE(sum, 1.0 + 1e-9);
}

TEST(Trial, PredictsATimeAndHoldsNoLight) {
    for (const bool set : {false, true}) {
        kit::Scene scene;
        build_room(scene, set);
        ajar_settings s = kit::settings(3, 256);
        s.trial = 1;
        s.check_points = 16;
        const kit::Bake trial(scene, s);
        const nlohmann::json report = nlohmann::json::parse(trial.report());
        EXPECT_GT(report.at("predicted_seconds").get<double>(), 0.0);
        EXPECT_GT(report.at("texels").get<int>(), 1000);
        const auto planned = effects_by_name(report);
        EXPECT_EQ(planned.at("light sets").at("status"), set ? "simulated" : "skipped");
        EXPECT_EQ(planned.at("doors").at("status"), "skipped");
        EXPECT_EQ(planned.at("bounces").at("status"), "simulated");
        s.trial = 0;
        const nlohmann::json done = nlohmann::json::parse(kit::Bake(scene, s).report());
        for (const auto& [name, effect] : effects_by_name(done))
            EXPECT_EQ(effect.at("status"), planned.at(name).at("status")) << name;
        for (const char* part : {"scene", "receivers", "light", "pages"}) {
            const double held = done.at("memory_parts").at(part),
                         expected = report.at("predicted_memory_parts").at(part);
            EXPECT_NEAR(expected / held, 1.0, 0.1) << part;
        }
        EXPECT_EQ(report.at("predicted_memory_parts").at("terms").get<int>() > 0, set);
        uint32_t width = 0, height = 0, channels = 0, count = 0;
        EXPECT_EQ(ajar_job_layer_size(trial.handle(), 0, AJAR_LAYER_IRRADIANCE, &width, &height, &channels),
                  AJAR_ERROR_STATE);
        EXPECT_EQ(ajar_job_term_count(trial.handle(), &count), AJAR_ERROR_STATE);
        EXPECT_EQ(ajar_job_write_package(trial.handle(), "/nonexistent/package", nullptr), AJAR_ERROR_STATE);
    }
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

TEST(SelfCheck, LooksAtWhatIsStored) {
    // A texel stores 65024 W/m^2 at most; the bake in memory knows no bound.
    kit::Scene scene;
    scene.instance(scene.mesh(kit::plane(1.0f, 0.0f, true)), scene.diffuse({0, 0, 0}), scene.page(16, 16), "floor");
    scene.point_light({0, 0, 2}, 65024.0f * 2.0f * 16.0f * 9.8696f * 4.0f, 0.0f); // twice that below the lamp
    scene.commit();
    ajar_settings s = kit::settings(0, 64);
    s.check_points = 64;
    const kit::Bake bake(scene, s);
    const nlohmann::json report = nlohmann::json::parse(bake.report());
    EXPECT_GT(bake.layer(AJAR_LAYER_IRRADIANCE).at(8, 8, 0), 1.5f * 65024.0f);
    EXPECT_LT(report.at("self_check").at("ratio").get<double>(), 0.9);
    EXPECT_NE(report.at("warnings").dump().find("the stored light"), std::string::npos) << report.at("warnings");
}

TEST(SelfCheck, JudgesElementsInSixStatesAndTellsThePackage) {
    // A lamp of a set and another beside it, a lid over a part of the floor that can be hidden.
    kit::Scene scene;
    const uint32_t grey = scene.diffuse({0.6f, 0.5f, 0.4f}), lid = scene.element(AJAR_ELEMENT_TOGGLE, "lid");
    build_room_in(scene, scene.element(AJAR_ELEMENT_LIGHT_SET, "lamps"));
    scene.point_light({-1, -0.5f, 2.5f}, 20.0f, 0.1f);
    scene.current_switch = lid;
    scene.instance(scene.mesh(kit::box({-1, -1, 0.8f}, {0, 0, 0.9f}, false)), grey, AJAR_NONE, "lid");
    scene.commit();
    ajar_settings s = kit::settings(3, 1024);
    s.combinations = AJAR_COMBINATIONS_ALL;
    s.check_points = 384;
    const kit::Bake bake(scene, s);
    const nlohmann::json report = nlohmann::json::parse(bake.report());
    const auto& check = report.at("self_check");
    EXPECT_TRUE(report.at("warnings").empty()) << report.at("warnings");
    ASSERT_EQ(check.at("states").size(), 6u) << "at the start all is on";
    double most = 0.0;
    for (const auto& state : check.at("states")) {
        const double off = std::abs(state.at("ratio").get<double>() - 1.0), error = state.at("ratio_error");
        EXPECT_GT(state.at("points").get<int>(), 50);
        // Texels round to 1.6 % at most; what is shadowed in one state and not in another has more noise than told.
        EXPECT_LT(off, 4.5 * error + 0.016) << state;
        most = std::max(most, off);
    }
    EXPECT_LT(most, 0.05);
    const kit::TempFolder folder;
    kit::check(ajar_job_write_package(bake.handle(), folder.path("package").c_str(), nullptr));
    const auto manifest = nlohmann::json::parse(kit::read_file(folder.path("package/manifest.json")));
    EXPECT_EQ(manifest.at("self_check").at("ratio"), check.at("ratio"));
    EXPECT_EQ(manifest.at("self_check").at("states"), check.at("states"));
    EXPECT_FALSE(manifest.at("self_check").contains("seconds"));
    s.check_points = 0;
    const kit::Bake unchecked(scene, s);
    kit::check(ajar_job_write_package(unchecked.handle(), folder.path("unchecked").c_str(), nullptr));
    EXPECT_EQ(kit::read_file(folder.path("package/terms.bin")), kit::read_file(folder.path("unchecked/terms.bin")));
}

TEST(SelfCheck, ABakeWithNoPlaceToLookAtIsKept) {
    // A floor inside a dark solid: nobody sees it.
    kit::Scene scene;
    const uint32_t grey = scene.diffuse({0.5f, 0.5f, 0.5f});
    scene.instance(scene.mesh(kit::plane(2.0f, 0.0f, true)), grey, scene.page(16, 16), "floor");
    scene.instance(scene.mesh(kit::box({-2, -2, -1}, {2, 2, 1}, false)), grey, AJAR_NONE, "solid");
    scene.point_light({0, 0, 3}, 10.0f, 0.05f);
    scene.commit();
    ajar_settings s = kit::settings(1, 64);
    s.check_points = 64;
    const kit::Bake bake(scene, s);
    const nlohmann::json report = nlohmann::json::parse(bake.report());
    const std::string why = report.at("self_check").at("not_checked");
    EXPECT_NE(why.find("in the open"), std::string::npos) << why;
    EXPECT_FALSE(report.at("self_check").contains("ratio"));
    ASSERT_EQ(report.at("warnings").size(), 1u);
    EXPECT_NE(report.at("warnings")[0].at("text").get<std::string>().find("not checked"), std::string::npos);
    EXPECT_EQ(bake.layer(AJAR_LAYER_IRRADIANCE).width, 16u);
}

TEST(SelfCheck, LightThatMovesToFinerTexelsDoesNotGrow) {
    // A lit floor of 8 x 8 texels under a ceiling of 64 x 64 that gets every other bounce: the mean over texels grows
    // from the second bounce to the third, the light does not.
    kit::Scene scene;
    const uint32_t grey = scene.diffuse({0.8f, 0.8f, 0.8f});
    scene.instance(scene.mesh(kit::plane(8.0f, 0.0f, true)), grey, scene.page(8, 8), "floor");
    scene.instance(scene.mesh(kit::plane(8.0f, 1.0f, false)), grey, scene.page(64, 64), "ceiling");
    ajar_light_desc lamp;
    ajar_light_desc_init(&lamp);
    lamp.name = "lamp", lamp.type = AJAR_LIGHT_SPOT, lamp.role = AJAR_ROLE_STATIC;
    lamp.energy = 100.0f, lamp.spot_angle = 2.0f;
    scene.light(lamp, kit::translation(0, 0, 0.9).data());
    scene.commit();
    ajar_settings s = kit::settings(4, 64);
    s.check_points = 16;
    const nlohmann::json report = nlohmann::json::parse(kit::Bake(scene, s).report());
    const auto& means = report.at("bounces").at("means");
    ASSERT_GT(means.at(3).get<double>(), means.at(2).get<double>());
    EXPECT_LT(report.at("self_check").at("bounce_gain").get<double>(), 0.8);
    for (const auto& w : report.at("warnings"))
        EXPECT_EQ(w.at("text").get<std::string>().find("grows"), std::string::npos);
}

TEST(SelfCheck, NothingIsCheckedUnlessAskedFor) { EXPECT_FALSE(report_of(0).contains("self_check")); }

} // namespace
