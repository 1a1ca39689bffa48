// SPDX-License-Identifier: GPL-3.0-or-later
// Dim light of light sets is reflected by chance, so that rows stay short: rays must lower the noise of that too.
#include <gtest/gtest.h>

#include <cmath>

#include "scene_kit.h"
#include "statistics.h"

namespace {

constexpr uint32_t kSize = 48, kSeeds = 6;

/// Mean relative standard deviation over seeds of a corridor's texels, whose far end glows and is a light set.
double noise(uint32_t samples) {
    kit::Scene scene;
    const uint32_t page = scene.page(kSize, kSize);
    scene.instance(scene.mesh(kit::box({0, 0, 0}, {60, 3, 3}, true)), scene.diffuse({0.7f, 0.7f, 0.7f}), page);
    scene.current_set = scene.element(AJAR_ELEMENT_LIGHT_SET, "end");
    scene.instance(scene.mesh(kit::box({59.8f, 0.5f, 0.5f}, {59.9f, 2.5f, 2.5f}, false)), scene.emitter({99, 99, 99}),
                   AJAR_NONE, "end");
    scene.commit();
    std::vector<kit::Sample> texels(kSize * kSize);
    for (uint32_t seed = 0; seed < kSeeds; ++seed) {
        ajar_settings s = kit::settings(6, samples);
        s.seed = seed;
        const kit::Bake bake(scene, s);
        const kit::Layer set = bake.term(1, kSize, kSize, page), base = bake.term(0, kSize, kSize, page);
        for (size_t i = 0; i < texels.size(); ++i) texels[i].add(set.data[3 * i] + base.data[3 * i]);
    }
    double sum = 0.0, count = 0.0;
    for (const kit::Sample& t : texels)
        if (t.mean() > 0.0) sum += std::sqrt(t.variance()) / t.mean(), count += 1.0;
    return sum / count;
}

TEST(Pruning, ItsNoiseFallsWithTheRays) {
    const double few = noise(256), many = noise(4096);
    EXPECT_LT(many, 0.5 * few) << few << " and " << many << "; 16 times the rays alone: a quarter";
}

} // namespace
