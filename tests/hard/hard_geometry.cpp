// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes that bakers stumble over: thin walls, slivers, doubled faces, charts smaller than a texel.
#include "hard_case.h"

namespace hard {
namespace {

double thin_wall(const Variant& v) {
    Stage s(v);
    const uint32_t white = s.scene.diffuse({0.9f, 0.9f, 0.9f});
    const uint32_t bright = s.object(kit::box({0, 0, 0}, {2, 2, 2}, true), white, 24),
                   dark = s.object(kit::box({2.005f, 0, 0}, {4, 2, 2}, true), white, 24);
    s.point({1.5f, 1, 1}, 1000, 0.1f);
    s.scene.commit();
    const kit::Bake bake(s.scene, s.settings(4, 128));
    return largest(s.irradiance(bake, dark)) / mean(s.irradiance(bake, bright));
}

double slivers(const Variant& v) {
    Stage s(v);
    const uint32_t page = s.object(kit::sliver_strip(), s.scene.diffuse({0.8f, 0.8f, 0.8f}), 16);
    s.sky(1.0);
    s.scene.commit();
    return worst(s.irradiance(kit::Bake(s.scene, s.settings(1, 128)), page), pi);
}

double coplanar_twins(const Variant& v) {
    Stage s(v);
    const uint32_t white = s.scene.diffuse({0.8f, 0.8f, 0.8f});
    const uint32_t page = s.object(kit::plane(3.0f, 1.37f), white, 16),
                   twin = s.object(kit::plane(3.0f, 1.37f), white, 16);
    s.sun(0.9, 2.0);
    s.scene.commit();
    const kit::Bake bake(s.scene, s.settings(2, 64));
    const double expected = 2.0 * std::sin(0.9);
    return std::max(worst(s.irradiance(bake, page), expected), worst(s.irradiance(bake, twin), expected));
}

double chart_in_a_texel(const Variant& v) {
    Stage s(v);
    kit::MeshData pebble;
    pebble.quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {5.2f / 16, 5.3f / 16}, {5.7f / 16, 5.8f / 16});
    const uint32_t page = s.object(pebble, s.scene.diffuse({0.8f, 0.8f, 0.8f}), 16);
    s.sky(1.0);
    s.scene.commit();
    return std::abs(s.irradiance(kit::Bake(s.scene, s.settings(1, 64)), page).at(5, 5) / pi - 1.0);
}

double white_furnace(const Variant& v) {
    Stage s(v);
    // Reflectance is clamped to 0.95; every surface emits 1.
    std::vector<ajar_closure> closures(2);
    for (ajar_closure& c : closures) ajar_closure_init(&c);
    closures[0].type = AJAR_CLOSURE_DIFFUSE;
    closures[1].type = AJAR_CLOSURE_EMISSION;
    for (int i = 0; i < 3; ++i) closures[0].color.value[i] = 1.0f, closures[1].color.value[i] = float(v.light);
    const uint32_t page = s.object(kit::box({-1, -1, -1}, {1, 1, 1}, true), s.scene.material(closures), 24);
    s.scene.commit();
    constexpr int kBounces = 6;
    double expected = 0.0;
    for (int b = 0; b <= kBounces; ++b) expected += pi * std::pow(0.95, b);
    const kit::Bake bake(s.scene, s.settings(kBounces, 64));
    const Layer e = s.irradiance(bake, page), valid = bake.layer(AJAR_LAYER_VALIDITY, page);
    double most = 0.0;
    for (size_t i = 0; i < valid.data.size(); ++i)
        if (valid.data[i] == 1.0f) most = std::max(most, std::abs(e.data[3 * i] / expected - 1.0));
    return most;
}

double dark_room(const Variant& v) {
    Stage s(v);
    const uint32_t page = s.object(kit::box({-1, -1, -1}, {1, 1, 1}, true), s.scene.diffuse({0.5f, 0.5f, 0.5f}), 16);
    s.scene.commit();
    return largest(s.irradiance(kit::Bake(s.scene, s.settings(2, 64)), page));
}

const Case kCases[] = {
    {"geometry", Origin::kBase, "wall of 5 mm", "offsets and texels reach through: light leaks",
     "brightest dark texel / mean of the lit room", 0.0, thin_wall},
    {"geometry", Origin::kBase, "slivers", "normals of no length, NaN", "worst texel under a plain sky", 1e-3, slivers},
    {"geometry", Origin::kBase, "coplanar twins", "surfaces shadow each other: half the light",
     "worst texel under a sun", 1e-3, coplanar_twins},
    {"geometry", Origin::kBase, "chart inside one texel", "no texel centre is covered: black", "error of the texel",
     1e-3, chart_in_a_texel},
    {"geometry", Origin::kBase, "white closed room", "the bounces diverge", "worst texel against the clamped series",
     1e-3, white_furnace},
    {"geometry", Origin::kBase, "no light", "0 / 0", "brightest texel, W/m^2", 0.0, dark_room},
};

} // namespace

std::span<const Case> geometry_cases() { return kCases; }

} // namespace hard
