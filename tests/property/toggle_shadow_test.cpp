// SPDX-License-Identifier: GPL-3.0-or-later
// The edge of a toggle's shadow is as smooth as that of a fixed thing's.
#include <gtest/gtest.h>

#include <cmath>

#include "scene_kit.h"

namespace {

constexpr uint32_t kSize = 48;

/// A lamp, all of whose light belongs to a set, and a slab above the floor: a toggle, or just there.
struct Slab {
    kit::Scene scene;
    uint32_t floor;

    explicit Slab(bool toggle) {
        const uint32_t set = scene.element(AJAR_ELEMENT_LIGHT_SET, "lamp"),
                       slab = toggle ? scene.element(AJAR_ELEMENT_TOGGLE, "slab") : AJAR_NONE;
        const uint32_t grey = scene.diffuse({0.5f, 0.5f, 0.5f});
        floor = scene.page(kSize, kSize);
        scene.instance(scene.mesh(kit::plane(6.0f, 0.0f)), grey, floor);
        scene.current_switch = slab;
        scene.instance(scene.mesh(kit::box({-0.8f, -0.5f, 1.0f}, {0.7f, 0.9f, 1.1f}, false)), grey, AJAR_NONE);
        scene.current_switch = AJAR_NONE;
        scene.current_set = set;
        scene.point_light({0.3f, -0.2f, 3}, 100.0f, 0.05f);
        scene.commit();
    }
};

/// All light on the floor.
std::vector<double> light(const Slab& slab, uint32_t seed) {
    ajar_settings s = kit::settings(1, 1024);
    s.direct_samples = 1024;
    s.noise_target = 0.035f;
    s.positions_per_texel = 8;
    s.seed = seed;
    const kit::Bake bake(slab.scene, s);
    std::vector<double> sum(3 * kSize * kSize, 0.0);
    for (uint32_t t = 0; t < bake.terms().size(); ++t) {
        const kit::Layer l = bake.term(t, kSize, kSize, slab.floor);
        for (size_t i = 0; i < sum.size(); ++i) sum[i] += l.data[i];
    }
    return sum;
}

double rms(const std::vector<double>& a, const std::vector<double>& b) {
    double squares = 0.0;
    for (size_t i = 0; i < a.size(); ++i) squares += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(squares / static_cast<double>(a.size()));
}

TEST(ToggleShadow, EdgesAreAsSmoothAsThoseOfFixedThings) {
    const Slab toggle(true), fixed(false);
    const std::vector<double> whole = light(fixed, 1);
    EXPECT_LT(rms(light(toggle, 3), whole), 1.3 * rms(light(fixed, 2), whole));
}

} // namespace
