// SPDX-License-Identifier: GPL-3.0-or-later
// Toggles that stand between a light and a floor, from the start of the file: each takes its share of the light, so
// that light is that without them times a product over them.
#include <string>

#include "hard_case.h"

namespace hard {
namespace {

constexpr uint32_t kSize = 4;
constexpr float kEdge = 0.1f; ///< of the floor, m
constexpr Float3 kLamp = {0, 0, 2};
constexpr double kWatts = 100.0;

/// Largest difference from the expected light over the floor, over the lamp's free light in its middle.
double worst_under_lamp(const Layer& e, double share) {
    const double most = from_point(kLamp, kWatts, {0, 0, 0});
    double worst = 0.0;
    for (uint32_t y = 0; y < kSize; ++y)
        for (uint32_t x = 0; x < kSize; ++x) {
            const double free = from_point(kLamp, kWatts, texel(x, y, kSize, kEdge));
            worst = std::max(worst, std::abs(e.at(x, y) - share * free) / most);
        }
    return worst;
}

/// Shelves between a lamp and a floor, each a toggle.
struct Shelves {
    Stage s;
    uint32_t page;

    Shelves(const Variant& v, const std::vector<float>& starts, bool in_set, float transmittance = 0.0f) : s(v) {
        page = s.object(kit::plane(kEdge, 0.0f), s.black(), kSize);
        const uint32_t board = transmittance > 0.0f ? s.pane({transmittance, transmittance, transmittance}) : s.black();
        for (size_t i = 0; i < starts.size(); ++i) {
            s.toggle("shelf " + std::to_string(i), starts[i]);
            s.object(kit::plane(4.0f, 0.5f + 0.02f * static_cast<float>(i)), board);
        }
        s.release();
        if (in_set) s.set("lamp");
        s.point(kLamp, kWatts);
        s.scene.commit();
    }
    /// The shelves' weights, then that of the lamp's set.
    Layer at(const kit::Bake& bake, std::vector<float> weights) const {
        weights.push_back(1.0f);
        return s.state(bake, weights, kSize, page);
    }
};

double product(const std::vector<float>& presence, double blocked = 1.0) {
    double out = 1.0;
    for (const float p : presence) out *= 1.0 - blocked * p;
    return out;
}

double worst_start(const Variant& v, const std::vector<std::vector<float>>& starts, float transmittance = 0.0f) {
    double most = 0.0;
    for (const std::vector<float>& start : starts)
        for (const bool in_set : {false, true}) {
            const Shelves shelves(v, start, in_set, transmittance);
            ajar_settings settings = shelves.s.settings(0, 16);
            settings.direct_samples = 16;
            const Layer e = shelves.at(kit::Bake(shelves.s.scene, settings), start);
            most = std::max(most, worst_under_lamp(e, product(start, 1.0 - transmittance)));
        }
    return most;
}

double three_shelves(const Variant& v) { return worst_start(v, {{1, 1, 1}, {0, 0, 0}, {1, 0, 1}, {0.5f, 0, 0.5f}}); }

double twelve_shelves(const Variant& v) {
    return worst_start(v, {std::vector<float>(12, 1.0f), std::vector<float>(12, 0.0f), std::vector<float>(12, 0.1f)});
}

double tinted_shelves(const Variant& v) { return worst_start(v, {std::vector<float>(9, 0.5f)}, 0.5f); }

double five_shelves_in_every_state(const Variant& v) {
    double most = 0.0;
    for (const bool in_set : {false, true}) {
        const Shelves shelves(v, {1, 0, 1, 0.5f, 0}, in_set);
        const kit::Bake bake(shelves.s.scene, shelves.s.settings(0, 16));
        for (uint32_t bits = 0; bits < 32; ++bits) {
            std::vector<float> state;
            for (uint32_t i = 0; i < 5; ++i) state.push_back(static_cast<float>(bits >> i & 1u));
            most = std::max(most, worst_under_lamp(shelves.at(bake, state), product(state)));
        }
    }
    return most;
}

/// Two lamps of two sets, one of them under the upper shelves.
double lamps_among_shelves(const Variant& v) {
    const std::vector<float> starts = {0.5f, 0, 0.25f, 0.5f, 0.5f};
    Stage s(v);
    const uint32_t page = s.object(kit::plane(0.1f, 0.0f), s.black(), kSize);
    for (size_t i = 0; i < starts.size(); ++i) {
        s.toggle("shelf " + std::to_string(i), starts[i]);
        s.object(kit::plane(4.0f, 0.5f + 0.1f * static_cast<float>(i)), s.black());
    }
    s.release();
    s.set("above"), s.point({0, 0, 2}, 100.0);
    s.set("among"), s.point({0, 0, 0.75f}, 10.0);
    s.scene.commit();
    const kit::Bake bake(s.scene, s.settings(0, 64));
    double most = 0.0;
    for (const auto& [above, among] : {std::pair{1.0f, 1.0f}, {0.0f, 2.0f}, {3.0f, 0.0f}}) {
        std::vector<float> weights = starts;
        weights.insert(weights.end(), {above, among});
        const double expected = above * product(starts) * from_point({0, 0, 2}, 100.0, {0, 0, 0}) +
                                among * product({0.5f, 0, 0.25f}) * from_point({0, 0, 0.75f}, 10.0, {0, 0, 0});
        most = std::max(most, off(mean(s.state(bake, weights, kSize, page)), expected));
    }
    return most;
}

double shells_under_a_sky(const Variant& v) {
    const std::vector<float> starts(10, 0.1f);
    Stage s(v);
    const uint32_t page = s.object(kit::plane(kAround, 0.0f), s.black(), kSize);
    for (size_t i = 0; i < starts.size(); ++i)
        s.toggle("shell " + std::to_string(i), 0.1f), s.object(around(i), s.black());
    s.sky(1.0);
    s.scene.commit();
    const Layer e = s.state(kit::Bake(s.scene, s.settings(1, 256)), starts, kSize, page);
    return worst(e, pi * std::pow(0.9, 10));
}

double glowing_shells(const Variant& v) {
    const std::vector<float> starts(12, 0.3f);
    Stage s(v);
    const uint32_t page = s.object(kit::plane(kAround, 0.0f), s.black(), kSize);
    double expected = 0.0;
    for (size_t i = 0; i < starts.size(); ++i) {
        const auto radiance = static_cast<float>(i + 1);
        s.toggle("shell " + std::to_string(i), 0.3f);
        s.object(around(i), s.emitter({radiance, radiance, radiance}));
        expected += pi * 0.3 * radiance * std::pow(0.7, i);
    }
    s.scene.commit();
    return off(mean(s.state(kit::Bake(s.scene, s.settings(1, 512)), starts, kSize, page)), expected);
}

constexpr const char* kSigned = "signed sums are cut: too much light, or less than none";

const Case kCases[] = {
    {"switches", Origin::kReport, "3 shelves under a lamp, all there, absent, mixed", kSigned,
     "worst texel at the start, of the free light", 0.005, three_shelves},
    {"switches", Origin::kReport, "12 shelves under a lamp, all there, absent, faint",
     "rays through the ninth are lost", "worst texel at the start, of the free light", 0.005, twelve_shelves},
    {"switches", Origin::kReport, "5 shelves in all of 32 states", kSigned, "worst texel, of the free light", 0.005,
     five_shelves_in_every_state},
    {"switches", Origin::kSibling, "9 tinted shelves, half there", "a shadow is all or nothing",
     "worst texel at the start, of the free light", 0.005, tinted_shelves},
    {"switches", Origin::kSibling, "lamps of two sets above and among 5 shelves", "shadows of one lamp on the other",
     "mean in three states of the sets", 0.01, lamps_among_shelves},
    {"switches", Origin::kSibling, "10 faint shells under a sky", "rays through the ninth are lost",
     "worst texel at the start", 0.005, shells_under_a_sky},
    {"switches", Origin::kSibling, "12 glowing shells, each there by a third", "light behind is not dimmed",
     "mean at the start", 0.02, glowing_shells},
};

} // namespace

std::span<const Case> switch_cases() { return kCases; }

} // namespace hard
