// SPDX-License-Identifier: GPL-3.0-or-later
// Light sets: as many as there are, as strong or weak as they are, none is lost.
#include <string>

#include "hard_case.h"
#include "stored_light.h"

namespace hard {
namespace {

/// Lamp of a set, 2 m above a floor of 2 m.
Float3 place(int i) { return {0.1f * float(i % 10) - 0.45f, 0.04f * float(i / 10 % 20) - 0.4f, 2.0f}; }

/// Many sets with a lamp each, read through the package, all on.
double all_on(const Variant& v, int sets, uint32_t size) {
    Stage s(v);
    const uint32_t page = s.object(kit::plane(2.0f, 0.0f), s.black(), size);
    for (int i = 0; i < sets; ++i) s.set("set " + std::to_string(i)), s.point(place(i), 10.0 + i % 7);
    s.scene.commit();
    const kit::Bake bake(s.scene, s.settings(0, 16));
    const std::vector<float> weights(static_cast<size_t>(sets), 1.0f);
    // The middle of a texel stands for the texel: at most 1 % at the edge of four.
    return worst(s.divided(stored_light(bake, weights, page)), [&](uint32_t x, uint32_t y) {
        double sum = 0.0;
        constexpr int kCuts = 8;
        for (int i = 0; i < sets; ++i)
            for (int k = 0; k < kCuts * kCuts; ++k) {
                const auto fine = static_cast<uint32_t>(kCuts);
                const Float3 p =
                    texel(fine * x + uint32_t(k % kCuts), fine * y + uint32_t(k / kCuts), fine * size, 2.0f);
                sum += from_point(place(i), 10.0 + i % 7, p) / (kCuts * kCuts);
            }
        return sum;
    });
}

double forty_sets(const Variant& v) { return all_on(v, 40, 8); }
double three_hundred_sets(const Variant& v) { return all_on(v, 300, 2); }

/// Seventeen sets of 1e-8 to 1e8 W in one place: each is its own lamp.
double strengths(const Variant& v) {
    Stage s(v);
    const uint32_t page = s.object(kit::plane(0.1f, 0.0f), s.black(), 4);
    for (int i = 0; i < 17; ++i) s.set("set " + std::to_string(i)), s.point({0, 0, 2}, std::pow(10.0, i - 8));
    s.scene.commit();
    const kit::Bake bake(s.scene, s.settings(0, 16));
    double most = 0.0;
    for (size_t i = 0; i < 17; ++i) {
        std::vector<float> weights(17, 0.0f);
        weights[i] = 1.0f;
        most = std::max(most, worst(s.state(bake, weights, 4, page),
                                    from_point({0, 0, 2}, std::pow(10.0, double(i) - 8), {0, 0, 0})));
    }
    return most;
}

/// Bounced light of lamps whose own light is not stored: what a white cube keeps of their power.
double primary_lamps(const Variant& v) {
    constexpr int kSets = 24, kBounces = 16;
    Stage s(v);
    const uint32_t page =
        s.object(kit::box({-1, -1, -1}, {1, 1, 1}, true, 0.0f), s.scene.diffuse({0.5f, 0.5f, 0.5f}), 24);
    for (int i = 0; i < kSets; ++i) {
        s.set("set " + std::to_string(i));
        s.light(Stage::lamp(AJAR_LIGHT_POINT, 10.0, AJAR_ROLE_PRIMARY),
                {0.1f * float(i % 6) - 0.25f, 0.1f * float(i / 6) - 0.15f, 0.2f});
    }
    s.scene.commit();
    const kit::Bake bake(s.scene, s.settings(kBounces, 64));
    const Layer e = s.state(bake, std::vector<float>(kSets, 1.0f), 24, page);
    // All faces are alike in texels; of flux P the walls of 24 m^2 get P (.5 + .25 + ...).
    return off(valid_mean(e, bake.layer(AJAR_LAYER_VALIDITY, page)),
               kSets * 10.0 * (1.0 - std::pow(0.5, kBounces)) / 24.0);
}

/// A ceiling of sixty glowing tiles, a set each.
double glowing_tiles(const Variant& v) {
    Stage s(v);
    const uint32_t page = s.object(kit::plane(0.5f, 0.0f), s.black(), 4);
    const auto edge = [](int i) { return 0.2f * static_cast<float>(i) - 1.0f; };
    for (int i = 0; i < 60; ++i) {
        const float x = edge(i % 10), y = edge(i / 10) + 0.4f;
        kit::MeshData m;
        m.quad({x, y, 1}, {x, y + 0.2f, 1}, {x + 0.2f, y + 0.2f, 1}, {x + 0.2f, y, 1}, {0, 0}, {1, 1});
        s.set("tile " + std::to_string(i)), s.object(m, s.emitter({1, 1, 1}));
    }
    s.release();
    s.object(kit::plane(8.0f, -5.0f), s.black());
    s.scene.commit();
    const kit::Bake bake(s.scene, s.settings(0, 256));
    double squares = 0.0;
    for (int i = 0; i < 60; ++i) {
        std::vector<float> weights(60, 0.0f);
        weights[static_cast<size_t>(i)] = 1.0f;
        double expected = 0.0;
        for (uint32_t k = 0; k < 16; ++k)
            expected += from_rectangle(edge(i % 10), edge(i % 10) + 0.2, edge(i / 10) + 0.4, edge(i / 10) + 0.6, 1,
                                       texel(k % 4, k / 4, 4, 0.5f)) /
                        16.0;
        squares += std::pow(mean(s.state(bake, weights, 4, page)) / expected - 1.0, 2) / 60.0;
    }
    return std::sqrt(squares);
}

const Case kCases[] = {
    {"sets", Origin::kReport, "40 sets at a texel", "a texel has no room for so many",
     "worst texel, all on, of the stored light", 0.03, forty_sets},
    {"sets", Origin::kReport, "17 sets of 1e-8 to 1e8 W", "weak ones vanish in sums with strong ones",
     "worst texel of a set", 0.005, strengths},
    {"sets", Origin::kReport, "24 sets of lamps whose bounced light alone is stored", "dim light is cut off",
     "mean over a white cube, all on", 0.01, primary_lamps},
    {"sets", Origin::kSibling, "300 sets at a texel", "a texel has no room for so many",
     "worst texel, all on, of the stored light", 0.03, three_hundred_sets},
    {"sets", Origin::kSibling, "ceiling of 60 glowing tiles, a set each", "a few emitters get all samples",
     "root mean square over the sets", 0.07, glowing_tiles},
};

} // namespace

std::span<const Case> set_cases() { return kCases; }

} // namespace hard
