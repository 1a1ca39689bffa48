// SPDX-License-Identifier: GPL-3.0-or-later
// Any number of light sets in one room, from the bake through the package to the run-time's pages.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "ajar_runtime.h"
#include "room_kit.h"

namespace {

constexpr uint32_t kSize = 36;

/// A grey room with lamps at fixed random places under its ceiling, each a light set or all of them static.
void fill_hall(kit::Scene& scene, uint32_t lamps, bool in_sets) {
    scene.instance(scene.mesh(kit::box({-2, -2, 0}, {2, 2, 3}, true)), scene.diffuse({0.5f, 0.5f, 0.5f}),
                   scene.page(kSize, kSize));
    std::mt19937 random(1);
    std::uniform_real_distribution<float> place(-1.5f, 1.5f);
    for (uint32_t i = 0; i < lamps; ++i) {
        if (in_sets) scene.current_set = scene.element(AJAR_ELEMENT_LIGHT_SET, "set " + std::to_string(i));
        const float x = place(random), y = place(random);
        scene.point_light({x, y, 2.5f}, 10.0f, 0.05f);
    }
    scene.commit();
}

/// Irradiance of the package's page with the sets at these weights.
class Pages {
public:
    explicit Pages(const std::string& package) {
        EXPECT_EQ(ajar_runtime_open(package.c_str(), &runtime_), AJAR_RUNTIME_OK) << ajar_runtime_error_message();
    }
    ~Pages() { ajar_runtime_release(&runtime_); }
    Pages(const Pages&) = delete;

    std::vector<float> at(const std::vector<float>& weights) {
        for (uint32_t e = 0; e < weights.size(); ++e)
            EXPECT_EQ(ajar_runtime_set_weight(runtime_, e, weights[e]), AJAR_RUNTIME_OK);
        EXPECT_EQ(ajar_runtime_update(runtime_, nullptr), AJAR_RUNTIME_OK);
        std::vector<float> light(3 * kSize * kSize);
        EXPECT_EQ(ajar_runtime_read_irradiance(runtime_, 0, 3, light.data(), light.size()), AJAR_RUNTIME_OK);
        return light;
    }

private:
    ajar_runtime runtime_ = nullptr;
};

struct Agreement {
    double ratio, ratio_error, rms;
};

/// Pages against a bake of the same light over its valid texels; the error is that of the bake's noise.
Agreement compare(const std::vector<float>& pages, const kit::Bake& truth) {
    const kit::Layer light = truth.layer(AJAR_LAYER_IRRADIANCE), error = truth.layer(AJAR_LAYER_STDERR),
                     validity = truth.layer(AJAR_LAYER_VALIDITY);
    double sum = 0.0, expected = 0.0, variance = 0.0, squares = 0.0, count = 0.0;
    for (size_t i = 0; i < validity.data.size(); ++i) {
        if (validity.data[i] != 1.0f) continue;
        sum += pages[3 * i], expected += light.data[3 * i];
        variance += error.data[i] * error.data[i];
        squares += std::pow(pages[3 * i] / light.data[3 * i] - 1.0, 2.0), count += 1.0;
    }
    return {sum / expected, std::sqrt(variance) / expected, std::sqrt(squares / count)};
}

TEST(ManySets, AllOfThemTogetherAreTheRoom) {
    for (const uint32_t lamps : {24u, 40u, 100u, 300u}) {
        kit::Scene sets, fixed;
        fill_hall(sets, lamps, true);
        fill_hall(fixed, lamps, false);
        const kit::TempFolder folder;
        const kit::Bake bake(sets, kit::settings(1, 64));
        kit::check(ajar_job_write_package(bake.handle(), folder.path("package").c_str(), nullptr));
        ajar_settings s = kit::settings(1, 64);
        s.direct_samples = 4096; // lamps of one group are chosen among; sets are sampled one by one
        const kit::Bake truth(fixed, s);
        const Agreement a = compare(Pages(folder.path("package")).at(std::vector<float>(lamps, 1.0f)), truth);
        std::printf("%u sets: %.4f of the light, error %.4f, rms of texels %.4f\n", lamps, a.ratio, a.ratio_error,
                    a.rms);
        // Both share the light of the bounce at few texels: more than independent noise of each texel.
        EXPECT_NEAR(a.ratio, 1.0, 0.002 + 5.0 * a.ratio_error) << lamps;
        EXPECT_LT(a.rms, 0.03) << lamps;
    }
}

TEST(ManySets, EachOfThemIsThere) {
    constexpr uint32_t kLamps = 40;
    kit::Scene scene;
    fill_hall(scene, kLamps, true);
    const kit::TempFolder folder;
    const kit::Bake bake(scene, kit::settings(1, 64));
    kit::check(ajar_job_write_package(bake.handle(), folder.path("package").c_str(), nullptr));
    Pages pages(folder.path("package"));
    const kit::Layer validity = bake.layer(AJAR_LAYER_VALIDITY);
    for (uint32_t t = 1; t < bake.terms().size(); ++t) {
        std::vector<float> weights(kLamps, 0.0f);
        weights.at(bake.terms()[t].elements[0]) = 1.0f;
        const std::vector<float> light = pages.at(weights);
        const kit::Layer term = bake.term(t, kSize, kSize);
        double sum = 0.0, expected = 0.0;
        for (size_t i = 0; i < validity.data.size(); ++i)
            if (validity.data[i] == 1.0f) sum += light[3 * i], expected += term.data[3 * i];
        EXPECT_NEAR(sum / expected, 1.0, 0.003) << t; // of 6 bits, rounded; the mean of a thousand texels
    }
}

} // namespace
