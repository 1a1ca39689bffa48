// SPDX-License-Identifier: GPL-3.0-or-later
// Light that few rays find: how noisy it is, and whether a bake says so.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "scene_kit.h"

namespace {

constexpr uint32_t kSize = 48, kSeeds = 4;

/// A room of 4 x 4 x 3 m; one wall has a square hole in the middle of it, if that is above 0 m wide.
kit::MeshData room(float hole) {
    kit::MeshData mesh = kit::box({-2, -2, 0}, {2, 2, 3}, true);
    if (!(hole > 0.0f)) return mesh;
    // The wall at x = 2 is the fourth face: its two triangles and cell of the UVs give way to four strips.
    const size_t first = 6 * 3;
    mesh.corners.erase(mesh.corners.begin() + first, mesh.corners.begin() + first + 6);
    mesh.uv.erase(mesh.uv.begin() + first, mesh.uv.begin() + first + 6);
    const float low = 1.5f - hole / 2, high = 1.5f + hole / 2, side = hole / 2;
    const auto strip = [&](float y0, float y1, float z0, float z1) {
        const auto uv = [](float y, float z) {
            return kit::Float2{0.02f + 0.29f * (y + 2) / 4, 0.52f + 0.46f * z / 3};
        };
        mesh.quad({2, y0, z0}, {2, y0, z1}, {2, y1, z1}, {2, y1, z0}, uv(y0, z0), uv(y1, z1));
    };
    strip(-2, -side, 0, 3), strip(side, 2, 0, 3), strip(-side, side, 0, low), strip(-side, side, high, 3);
    return mesh;
}

struct Noise {
    double is = 0.0, stated = 0.0; ///< middle of the seeds
};

double middle(std::vector<double> v) {
    std::sort(v.begin(), v.end());
    return v[v.size() / 2];
}

using Build = std::function<void(kit::Scene&)>;

/// The relative root mean square error of a scene's bakes with few rays, where no texel counts as more than all wrong,
/// and what they state. truth: a scene with the same light that is less noisy.
Noise noise_of(const Build& build, const Build& truth, ajar_settings settings) {
    const auto layer = [](const Build& b, const ajar_settings& s, kit::Layer& light, kit::Layer& valid) {
        kit::Scene scene;
        b(scene);
        scene.commit();
        const kit::Bake bake(scene, s);
        light = bake.layer(AJAR_LAYER_IRRADIANCE), valid = bake.layer(AJAR_LAYER_VALIDITY);
        return nlohmann::json::parse(bake.report())["error"]["estimated_rms"].get<double>();
    };
    kit::Layer exact, valid, light;
    ajar_settings fine = settings;
    fine.samples = 4096, fine.direct_samples = 1024, fine.bounce_samples = 512, fine.seed = 99;
    layer(truth, fine, exact, valid);
    std::vector<double> levels, is, stated;
    for (uint32_t i = 0; i < kSize * kSize; ++i)
        if (valid.data[i] == 1.0f) levels.push_back(exact.data[3 * i]);
    const double dark = 0.01 * middle(levels);
    for (settings.seed = 0; settings.seed < kSeeds; ++settings.seed) {
        stated.push_back(layer(build, settings, light, valid));
        double sum = 0.0;
        for (uint32_t i = 0; i < kSize * kSize; ++i) {
            if (valid.data[i] != 1.0f) continue;
            const double d = (light.data[3 * i] - exact.data[3 * i]) / (exact.data[3 * i] + dark);
            sum += std::min(d * d, 1.0) / static_cast<double>(levels.size());
        }
        is.push_back(std::sqrt(sum));
    }
    return {middle(is), middle(stated)};
}

Noise noise_of(const Build& build, uint32_t samples) { return noise_of(build, build, kit::settings(3, samples)); }

void add_room(kit::Scene& s, float hole = 0.0f) {
    s.instance(s.mesh(room(hole)), s.diffuse({0.6f, 0.6f, 0.6f}), s.page(kSize, kSize));
}

TEST(Noise, BrightTexelsThatChartsShareOutAreAimedAt) {
    // Charts end within texels, and two triangles share those on a diagonal.
    const Noise n = noise_of(
        [](kit::Scene& s) {
            add_room(s);
            s.point_light({1.9f, 1.9f, 2.9f}, 100.0f);
        },
        64);
    EXPECT_LT(n.is, 0.12);
    EXPECT_NEAR(n.stated / n.is, 1.0, 0.25) << n.stated << " is " << n.is;
}

TEST(Noise, OfASmallOpeningIsStatedWhereMostTexelsMissIt) {
    // The sky through a hole is as bright as a lamp in its place, which is aimed at.
    const Build sky = [](kit::Scene& s) {
        add_room(s, 0.15f);
        s.sky({100, 100, 100});
    };
    const Build lamp = [](kit::Scene& s) {
        add_room(s, 0.15f);
        kit::MeshData panel;
        panel.quad({2, -0.075f, 1.425f}, {2, -0.075f, 1.575f}, {2, 0.075f, 1.575f}, {2, 0.075f, 1.425f}, {0, 0},
                   {1, 1});
        s.instance(s.mesh(panel), s.emitter({100, 100, 100}), AJAR_NONE);
    };
    for (const uint32_t samples : {64u, 256u}) {
        const Noise n = noise_of(sky, lamp, kit::settings(3, samples));
        EXPECT_GT(n.is, 0.2) << "the scene is no test";
        EXPECT_NEAR(n.stated / n.is, 1.0, 0.25) << n.stated << " is " << n.is;
    }
}

} // namespace
