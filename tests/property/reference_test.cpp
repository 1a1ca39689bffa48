// SPDX-License-Identifier: GPL-3.0-or-later
// Baker and reference integrator share no sampling and must still agree.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "room_kit.h"
#include "statistics.h"

namespace {

constexpr uint32_t kSize = 48;

ajar_settings fine(uint32_t bounces) {
    ajar_settings s = kit::settings(bounces, 1024);
    s.bounce_samples = 256;
    s.direct_samples = 256;
    s.term_threshold = 0.0f;
    s.combinations = AJAR_COMBINATIONS_ALL;
    return s;
}

/// Light of a bake at the given weights: base plus terms.
class Lightmaps {
public:
    Lightmaps(const kit::Scene& scene, const ajar_settings& settings, std::vector<float> weights)
        : bake_(scene, settings), terms_(bake_.terms()), weights_(std::move(weights)) {}

    const kit::Layer& light(uint32_t page) {
        auto [it, is_new] = pages_.try_emplace(page);
        if (is_new) it->second = sum(page);
        return it->second;
    }
    const kit::Layer& layer(uint32_t which, uint32_t page) {
        auto [it, is_new] = layers_.try_emplace({which, page});
        if (is_new) it->second = bake_.layer(which, page);
        return it->second;
    }

private:
    kit::Layer sum(uint32_t page) const {
        kit::Layer out = bake_.layer(AJAR_LAYER_IRRADIANCE, page);
        for (uint32_t t = 1; t < terms_.size(); ++t) {
            float w = 1.0f;
            for (uint32_t e = 0; e < terms_[t].element_count; ++e) w *= weights_[terms_[t].elements[e]];
            if (w == 0.0f) continue;
            const kit::Layer l = bake_.term(t, out.width, out.height, page);
            for (size_t i = 0; i < out.data.size(); ++i) out.data[i] += w * l.data[i];
        }
        return out;
    }
    kit::Bake bake_;
    std::vector<ajar_term_info> terms_;
    std::vector<float> weights_;
    std::map<uint32_t, kit::Layer> pages_;
    std::map<std::pair<uint32_t, uint32_t>, kit::Layer> layers_;
};

/// Differences of bake and reference at points that the bake calls valid.
struct Agreement {
    kit::Sample difference; ///< over the mean light
    double rms = 0.0;       ///< beyond the reference's own noise, over the mean light
};

Agreement compare(Lightmaps& maps, const std::vector<ajar_reference_point>& points) {
    double level = 0.0, squares = 0.0, count = 0.0;
    std::vector<double> differences;
    for (const ajar_reference_point& p : points) {
        if (maps.layer(AJAR_LAYER_VALIDITY, p.page).at(p.x, p.y) != 1.0f) continue;
        const kit::Layer& l = maps.light(p.page);
        const auto luminance = [](double r, double g, double b) { return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
        const double d = luminance(l.at(p.x, p.y, 0) - p.irradiance[0], l.at(p.x, p.y, 1) - p.irradiance[1],
                                   l.at(p.x, p.y, 2) - p.irradiance[2]);
        level += luminance(p.irradiance[0], p.irradiance[1], p.irradiance[2]);
        squares += d * d - double{p.standard_error} * p.standard_error;
        differences.push_back(d);
        count += 1.0;
    }
    level /= count;
    Agreement a;
    for (const double d : differences) a.difference.add(d / level);
    a.rms = std::sqrt(std::max(0.0, squares / count)) / level;
    return a;
}

void expect_agreement(const kit::Scene& scene, uint32_t bounces, const std::vector<float>& weights,
                      uint32_t points = 400, uint32_t batches = 48) {
    ajar_reference_settings s = kit::reference_settings(bounces, points, batches);
    s.choice = AJAR_CHOICE_TEXEL;
    s.weight_count = static_cast<uint32_t>(weights.size());
    s.weights = weights.data();
    Lightmaps maps(scene, fine(bounces), weights);
    const Agreement a = compare(maps, kit::trace(scene, s));
    EXPECT_GT(a.difference.count(), 0.8 * points);
    EXPECT_NEAR(a.difference.mean(), 0.0, 0.006 + 3.0 * a.difference.error());
    EXPECT_LT(a.difference.error(), 0.01) << "too noisy to say anything";
    EXPECT_LT(a.rms, 0.06);
}

TEST(Reference, AgreesOnARoomWithAnUnmappedBox) {
    for (const uint32_t bounces : {0u, 1u, 4u}) {
        SCOPED_TRACE(bounces);
        kit::Scene scene;
        kit::fill_room(scene);
        expect_agreement(scene, bounces, {});
    }
}

TEST(Reference, AgreesUnderSkyAndTintedGlass) {
    // A box lit through a red pane in its lid, with a turned sheet (seen from its back) inside.
    kit::Scene scene;
    const uint32_t page = scene.page(kSize, kSize), white = scene.diffuse({0.7f, 0.7f, 0.7f});
    kit::MeshData room = kit::box({-2, -2, 0}, {2, 2, 3}, true), open;
    for (size_t c = 0; c < room.corners.size(); ++c) {
        if (c / 6 == 1) continue; // the ceiling
        open.corners.push_back(static_cast<uint32_t>(open.positions.size()));
        open.positions.push_back(room.positions[room.corners[c]]);
        open.uv.push_back(room.uv[c]);
    }
    scene.instance(scene.mesh(open), white, page, "room");
    ajar_closure glass;
    ajar_closure_init(&glass);
    glass.type = AJAR_CLOSURE_TRANSPARENT;
    glass.color.value[1] = glass.color.value[2] = 0.3f;
    scene.instance(scene.mesh(kit::plane(4.0f, 3.0f, false)), scene.material({glass}), AJAR_NONE, "glass");
    kit::MeshData sheet;
    sheet.quad({-1, -1, 1}, {-1, 1, 1}, {0.5f, 1, 1}, {0.5f, -1, 1}, {0, 0}, {1, 1});
    scene.instance(scene.mesh(sheet), white, scene.page(kSize, kSize), "sheet");
    scene.sky({2, 2, 2});
    scene.point_light({1, 1, 4}, 200.0f, 0.1f);
    scene.commit();
    expect_agreement(scene, 3, {});
}

/// Two rooms with a door between them, a crate that can be hidden and a lamp that can be switched.
struct Rooms {
    kit::Scene scene;
    Rooms() {
        const uint32_t lamp = scene.element(AJAR_ELEMENT_LIGHT_SET, "lamp"),
                       door = scene.element(AJAR_ELEMENT_DOOR, "door"),
                       crate = scene.element(AJAR_ELEMENT_TOGGLE, "crate");
        const uint32_t white = scene.diffuse({0.7f, 0.65f, 0.6f});
        add(kit::box({-3, -2, 0}, {3, 2, 3}, true), white);
        add(kit::box({-0.1f, -2, -0.1f}, {0.1f, -0.6f, 3.1f}, false), white);
        add(kit::box({-0.1f, 0.6f, -0.1f}, {0.1f, 2, 3.1f}, false), white);
        scene.current_switch = door;
        // No lightmap: its edges stand closer to the walls than a texel is wide.
        scene.instance(scene.mesh(kit::box({-0.05f, -0.55f, 0.05f}, {0.05f, 0.55f, 2.95f}, false)),
                       scene.diffuse({0.8f, 0.2f, 0.1f}), AJAR_NONE);
        scene.current_switch = crate;
        add(kit::box({1.0f, -0.5f, 0.3f}, {1.8f, 0.5f, 1.2f}, false), scene.diffuse({0.1f, 0.7f, 0.2f}));
        scene.current_switch = AJAR_NONE;
        scene.current_set = lamp;
        scene.point_light({-1.5f, 0.3f, 2.5f}, 100.0f, 0.05f);
        scene.current_set = AJAR_NONE;
        scene.point_light({2.5f, -1.5f, 0.5f}, 10.0f, 0.05f, true);
        scene.commit();
    }
    void add(const kit::MeshData& data, uint32_t material) {
        scene.instance(scene.mesh(data), material, scene.page(kSize, kSize));
    }
};

TEST(Reference, AgreesInStatesOfLampDoorAndToggle) {
    for (const std::vector<float>& weights :
         {std::vector<float>{1, 0, 1}, {1, 1, 0}, {0.5f, 1, 1}, {2.0f, 0.4f, 0.7f}}) {
        SCOPED_TRACE(testing::PrintToString(weights));
        expect_agreement(Rooms().scene, 3, weights, 300, 48);
    }
}

TEST(Reference, LightThatStopsBehindADoorIsPartOfAllLight) {
    const Rooms rooms;
    const auto trace = [&](const std::vector<float>& weights, uint32_t door_bounces) {
        ajar_reference_settings s = kit::reference_settings(6, 400, 16);
        s.weight_count = 3, s.weights = weights.data(), s.door_bounces = door_bounces;
        return kit::trace(rooms.scene, s);
    };
    const std::vector<float> open{1, 1, 1}, shut{1, 0, 1};
    const auto closed = trace(shut, AJAR_NONE);
    // The dim room's points: what comes through the door can only add to their light.
    const auto light = [&](const std::vector<ajar_reference_point>& points) {
        double sum = 0.0;
        for (size_t i = 0; i < points.size(); ++i)
            sum += closed[i].irradiance[0] < 0.5f ? points[i].irradiance[0] : 0.0;
        return sum;
    };
    const double none = light(closed), direct = light(trace(open, 0)), one = light(trace(open, 1)),
                 six = light(trace(open, 6)), all = light(trace(open, AJAR_NONE));
    EXPECT_GT(none, 0.0);
    EXPECT_LT(none, 0.97 * direct);
    EXPECT_LT(direct, 0.97 * one);
    EXPECT_LT(one, 0.97 * all);
    EXPECT_NEAR(six, all, 1e-6 * all) << "the same paths";
    EXPECT_EQ(light(trace(shut, 1)), none);
}

TEST(Reference, ChoosesNoPlaceThatNobodySees) {
    // A pillar between floor and ceiling, a crate without a bottom, and a plate just above the floor: only under
    // them it is black.
    kit::Scene scene;
    kit::fill_room(scene, {kSize, false});
    const uint32_t grey = scene.diffuse({0.5f, 0.5f, 0.5f});
    scene.instance(scene.mesh(kit::box({1.2f, -1.5f, 0}, {1.8f, -0.9f, 3}, false)), grey, AJAR_NONE, "pillar");
    kit::MeshData crate = kit::box({-1.8f, 0.6f, 0}, {-0.8f, 1.6f, 1}, false);
    crate.corners.erase(crate.corners.begin(), crate.corners.begin() + 6);
    crate.uv.erase(crate.uv.begin(), crate.uv.begin() + 6);
    scene.instance(scene.mesh(crate), grey, AJAR_NONE, "crate");
    scene.instance(scene.mesh(kit::box({0.2f, 0.4f, 1e-4f}, {1.4f, 1.6f, 2e-4f}, false)), grey, AJAR_NONE, "plate");
    scene.commit();
    ajar_reference_settings s = kit::reference_settings(2, 500, 4);
    for (const uint32_t texel_mean : {0u, 1u}) {
        s.texel_mean = texel_mean;
        for (const auto& p : kit::trace(scene, s)) EXPECT_GT(p.irradiance[0], 0.0f) << p.x << ' ' << p.y;
    }
}

TEST(Reference, ALampInsideAClosedMeshMakesARoomOfItWhicheverWayItFaces) {
    kit::Sample light[2];
    for (const bool inside : {false, true}) {
        kit::Scene scene;
        const uint32_t grey = scene.diffuse({0.6f, 0.6f, 0.6f});
        scene.instance(scene.mesh(kit::plane(3.0f, 0.1f, true)), grey, scene.page(16, 16), "floor");
        scene.instance(scene.mesh(kit::box({-2, -2, 0}, {2, 2, 3}, inside)), grey, AJAR_NONE, "shell");
        scene.point_light({0.3f, 0.2f, 2.0f}, 50.0f, 0.1f);
        scene.commit();
        for (const auto& p : kit::trace(scene, kit::reference_settings(4, 200, 16))) light[inside].add(p.irradiance[0]);
    }
    const double error = std::hypot(light[0].error(), light[1].error());
    EXPECT_NEAR(light[0].mean(), light[1].mean(), 4.0 * error); // the same places: far closer than by chance
    EXPECT_GT(light[0].mean(), 1.0);
}

TEST(Reference, LightPassesAnyNumberOfClearPanes) {
    kit::Scene scene;
    scene.instance(scene.mesh(kit::plane(1.0f, 0.0f, true)), scene.diffuse({0.5f, 0.5f, 0.5f}), scene.page(8, 8));
    ajar_closure clear;
    ajar_closure_init(&clear);
    clear.type = AJAR_CLOSURE_TRANSPARENT;
    const uint32_t glass = scene.material({clear});
    for (int i = 0; i < 300; ++i)
        scene.instance(scene.mesh(kit::plane(400.0f, 0.1f + 0.01f * static_cast<float>(i), true)), glass, AJAR_NONE);
    scene.sky({1, 1, 1});
    scene.commit();
    for (const auto& p : kit::trace(scene, kit::reference_settings(0, 50, 4)))
        EXPECT_NEAR(p.irradiance[0], 3.14159265f, 1e-3f);
}

TEST(Reference, ReflectsAsMuchAsItsMaterialSays) {
    // Inside a closed sphere the light of bounce k is albedo^k of the first one's: the baker cuts albedo at 0.95.
    kit::Scene scene;
    const float radius = 1.0f, albedo = 0.98f;
    scene.instance(scene.mesh(kit::sphere_inside(radius, 4)), scene.emitter({1, 1, 1}, {albedo, albedo, albedo}),
                   scene.page(64, 64));
    scene.commit();
    kit::Sample light;
    for (const auto& p : kit::trace(scene, kit::reference_settings(20, 60, 16))) light.add(p.irradiance[0]);
    double expected = 0.0;
    for (int k = 0; k <= 20; ++k) expected += 3.14159265 * std::pow(albedo, k);
    EXPECT_NEAR(light.mean() / expected, 1.0, 0.01 + 4.0 * light.error() / expected);
}

TEST(Reference, IsTheSameForAnyNumberOfThreadsAndDiffersBySeed) {
    kit::Scene scene;
    kit::fill_room(scene);
    ajar_reference_settings s = kit::reference_settings(2, 50, 4);
    s.threads = 1;
    const auto one = kit::trace(scene, s);
    s.threads = 3;
    const auto three = kit::trace(scene, s);
    s.seed = 1;
    const auto other = kit::trace(scene, s);
    for (size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(one[i].irradiance[0], three[i].irradiance[0]);
        EXPECT_NE(one[i].irradiance[0], other[i].irradiance[0]);
        EXPECT_EQ(one[i].x, other[i].x) << "the seed of the paths must not move the points";
    }
}

TEST(Reference, ItsErrorIsTheSpreadOfItsAnswers) {
    kit::Scene scene;
    kit::fill_room(scene);
    ajar_reference_settings s = kit::reference_settings(2, 300, 32);
    const auto a = kit::trace(scene, s);
    s.seed = 9;
    const auto b = kit::trace(scene, s);
    double seen = 0.0, told = 0.0;
    for (size_t i = 0; i < a.size(); ++i) {
        const auto luminance = [](const auto& p) {
            return 0.2126 * p.irradiance[0] + 0.7152 * p.irradiance[1] + 0.0722 * p.irradiance[2];
        };
        const double d = luminance(a[i]) - luminance(b[i]);
        seen += d * d;
        told += double{a[i].standard_error} * a[i].standard_error + double{b[i].standard_error} * b[i].standard_error;
    }
    EXPECT_NEAR(std::sqrt(seen / told), 1.0, 0.15);
}

} // namespace
