// SPDX-License-Identifier: GPL-3.0-or-later
// Piles of panes: light passes any number of them, times the product of what each lets through.
#include <string>

#include "hard_case.h"

namespace hard {
namespace {

constexpr uint32_t kSize = 4;

/// A floor in boxes of panes within each other.
struct Pile {
    Stage s;
    uint32_t page;
    size_t panes = 0;

    explicit Pile(const Variant& v) : s(v), page(s.object(kit::plane(kAround, 0.0f), s.black(), kSize)) {}
    void add(uint32_t material) { s.object(around(panes++), material); }
    Layer bake(uint32_t samples) {
        s.scene.commit();
        return s.irradiance(kit::Bake(s.scene, s.settings(0, samples)), page);
    }
};

double channel_mean(const Layer& e, uint32_t channel) {
    double sum = 0.0;
    for (uint32_t y = 0; y < kSize; ++y)
        for (uint32_t x = 0; x < kSize; ++x) sum += e.at(x, y, channel) / (kSize * kSize);
    return sum;
}

double clear(const Variant& v) {
    double most = 0.0;
    for (const int count : {64, 300}) {
        Pile pile(v);
        const uint32_t material = pile.s.pane({1, 1, 1});
        for (int i = 0; i < count; ++i) pile.add(material);
        pile.s.sky(1.0);
        pile.s.sun(0.8, 3.0);
        most = std::max(most, worst(pile.bake(64), pi + 3.0 * std::sin(0.8)));
    }
    return most;
}

/// Light of a sky and a sun through panes that let 1e-4 of it through.
double nearly_black(const Variant& v, int panes, float transmittance) {
    Pile pile(v);
    const uint32_t material = pile.s.pane({transmittance, transmittance, transmittance});
    for (int i = 0; i < panes; ++i) pile.add(material);
    pile.s.sky(1e4);
    pile.s.sun(1.0, 1e4);
    return off(mean(pile.bake(256)), pi + std::sin(1.0));
}
double one_nearly_black(const Variant& v) { return nearly_black(v, 1, 1e-4f); }
double two_dark(const Variant& v) { return nearly_black(v, 2, 1e-2f); }

double hundred_dim(const Variant& v) {
    Pile pile(v);
    const uint32_t material = pile.s.pane({0.97f, 0.97f, 0.97f});
    for (int i = 0; i < 100; ++i) pile.add(material);
    pile.s.sky(1.0);
    return off(mean(pile.bake(256)), pi * std::pow(0.97, 100));
}

double colours(const Variant& v) {
    Pile pile(v);
    const uint32_t red = pile.s.pane({1, 0.9f, 0.8f}), blue = pile.s.pane({0.7f, 0.9f, 1});
    for (int i = 0; i < 5; ++i) pile.add(red), pile.add(blue);
    pile.s.sky(1.0);
    const Layer e = pile.bake(64);
    return std::max({off(channel_mean(e, 0), pi * std::pow(0.7, 5)), off(channel_mean(e, 1), pi * std::pow(0.9, 10)),
                     off(channel_mean(e, 2), pi * std::pow(0.8, 5))});
}

double glowing(const Variant& v) {
    Pile pile(v);
    const uint32_t material = pile.s.pane({0.5f, 0.5f, 0.5f}, 0.0f, 1.0);
    for (int i = 0; i < 10; ++i) pile.add(material);
    pile.s.sky(64.0);
    return off(mean(pile.bake(256)), pi * (2.0 - std::pow(0.5, 9) + 64.0 * std::pow(0.5, 10)));
}

/// Forty toggles that let everything through: nothing changes, whatever their state.
double clear_toggles(const Variant& v) {
    Pile pile(v);
    const uint32_t material = pile.s.pane({1, 1, 1});
    std::vector<float> starts;
    constexpr int kToggles = 40;
    for (int i = 0; i < kToggles; ++i) {
        starts.push_back(static_cast<float>(i % 3) * 0.5f);
        pile.s.toggle("pane " + std::to_string(i), starts.back());
        pile.add(material);
    }
    pile.s.release();
    pile.s.sky(1.0);
    pile.s.point({0, 0, 5}, 100.0);
    pile.s.scene.commit();
    ajar_settings settings = pile.s.settings(0, 4);
    settings.direct_samples = 4;
    const kit::Bake bake(pile.s.scene, settings);
    const double expected = pi + from_point({0, 0, 5}, 100.0, {0, 0, 0});
    double most = 0.0;
    for (const std::vector<float>& state :
         {starts, std::vector<float>(kToggles, 0.0f), std::vector<float>(kToggles, 1.0f)})
        most = std::max(most, worst(pile.s.state(bake, state, kSize, pile.page), expected));
    return most;
}

const Case kCases[] = {
    {"layers", Origin::kReport, "64 and 300 clear panes under sky and sun", "rays end after some layers", "worst texel",
     0.005, clear},
    {"layers", Origin::kReport, "a pane that lets 1e-4 through", "dim rays are dropped", "mean", 0.05,
     one_nearly_black},
    {"layers", Origin::kSibling, "two panes that let .01 through each", "dim rays are dropped", "mean", 0.05, two_dark},
    {"layers", Origin::kSibling, "100 panes that let .97 through", "rays end after some layers", "mean", 0.1,
     hundred_dim},
    {"layers", Origin::kSibling, "10 panes of two colours", "one channel ends the others", "mean of the worst channel",
     0.005, colours},
    {"layers", Origin::kSibling, "10 glowing panes", "what glows ends the ray", "mean", 0.03, glowing},
    {"layers", Origin::kSibling, "40 clear panes that are toggles", "no room for more switches on a ray",
     "worst texel of three states", 0.005, clear_toggles},
};

} // namespace

std::span<const Case> layer_cases() { return kCases; }

} // namespace hard
