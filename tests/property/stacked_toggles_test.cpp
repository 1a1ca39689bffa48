// SPDX-License-Identifier: GPL-3.0-or-later
// Many toggles between a lamp and a floor: each takes all of the lamp's light, so that light at any state is the
// unshadowed light times the product of (1 - presence). The state that the scene starts in is exact for any number of
// them; all states are for as many as a term has room for.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "scene_kit.h"

namespace {

constexpr uint32_t kSize = 8;

struct Stack {
    std::vector<float> starts; ///< presence of each shelf, from below
    bool lamp_in_set = false;
};

/// Mean over the floor of each term, by the elements of it; shelves are elements 0 to n, the set is n.
struct Polynomial {
    std::vector<std::pair<std::vector<uint32_t>, double>> terms;
    std::string report;

    double at(const std::vector<float>& weights) const {
        double sum = 0.0;
        for (const auto& [elements, light] : terms) {
            double product = light;
            for (const uint32_t e : elements) product *= weights[e];
            sum += product;
        }
        return sum;
    }
};

Polynomial bake(const Stack& stack) {
    kit::Scene scene;
    const uint32_t black = scene.diffuse({0, 0, 0});
    const uint32_t page = scene.page(kSize, kSize);
    scene.instance(scene.mesh(kit::plane(1.0f, 0.0f)), black, page);
    const uint32_t shelf = scene.mesh(kit::plane(4.0f, 0.0f));
    for (size_t i = 0; i < stack.starts.size(); ++i) {
        scene.current_switch = scene.element(AJAR_ELEMENT_TOGGLE, "shelf " + std::to_string(i), true, stack.starts[i]);
        scene.instance(shelf, black, AJAR_NONE, "shelf",
                       kit::translation(0, 0, 0.5 + 0.02 * static_cast<double>(i)).data());
    }
    scene.current_switch = AJAR_NONE;
    if (stack.lamp_in_set) scene.current_set = scene.element(AJAR_ELEMENT_LIGHT_SET, "lamp");
    scene.point_light({0, 0, 2}, 100.0f);
    scene.commit();
    ajar_settings s = kit::settings(0, 16);
    s.term_threshold = 0.0f;
    const kit::Bake job(scene, s);
    Polynomial out;
    out.report = job.report();
    const std::vector<ajar_term_info> terms = job.terms();
    for (uint32_t t = 0; t < terms.size(); ++t) {
        const kit::Layer l = job.term(t, kSize, kSize, page);
        double sum = 0.0;
        for (size_t i = 0; i < l.data.size(); i += 3) sum += l.data[i];
        out.terms.push_back({{terms[t].elements, terms[t].elements + terms[t].element_count}, sum / (kSize * kSize)});
    }
    return out;
}

/// Light at a state over light without shelves.
double share(const Stack& stack, const Polynomial& light, std::vector<float> presence) {
    static const double kFree = bake({}).at({});
    if (stack.lamp_in_set) presence.push_back(1.0f);
    return light.at(presence) / kFree;
}

double truth(const std::vector<float>& presence) {
    double product = 1.0;
    for (const float p : presence) product *= 1.0 - p;
    return product;
}

std::vector<float> pattern(size_t count, const char* starts) {
    std::vector<float> out;
    for (size_t i = 0; i < count; ++i) {
        const char c = starts[i % std::char_traits<char>::length(starts)];
        out.push_back(c == '1' ? 1.0f : c == 'h' ? 0.5f : 0.0f);
    }
    return out;
}

constexpr const char* kPatterns[] = {"1", "0", "01", "001", "h", "0h"};

TEST(StackedToggles, TheStartIsExactForAnyNumber) {
    for (const bool in_set : {false, true})
        for (const size_t count : {1u, 3u, 5u, 8u, 9u, 12u, 20u})
            for (const char* starts : kPatterns) {
                const Stack stack{pattern(count, starts), in_set};
                EXPECT_NEAR(share(stack, bake(stack), stack.starts), truth(stack.starts), 2e-3)
                    << count << " of pattern " << starts << (in_set ? ", in a set" : "");
            }
}

TEST(StackedToggles, AllStatesAreExactForAsManyAsATermHolds) {
    std::mt19937 random(1);
    for (const bool in_set : {false, true})
        for (const size_t count : {2u, 3u, 5u, 7u})
            for (const char* starts : kPatterns) {
                const Stack stack{pattern(count, starts), in_set};
                const Polynomial light = bake(stack);
                for (int round = 0; round < 20; ++round) {
                    std::vector<float> state;
                    for (size_t i = 0; i < count; ++i)
                        state.push_back(round < 10 ? static_cast<float>(random() % 2)
                                                   : std::uniform_real_distribution<float>(0.0f, 1.0f)(random));
                    if (round == 0) std::fill(state.begin(), state.end(), 0.0f);
                    ASSERT_NEAR(share(stack, light, state), truth(state), 4e-3)
                        << count << " of pattern " << starts << (in_set ? ", in a set " : " ")
                        << ::testing::PrintToString(state);
                }
            }
}

/// Of the shelves that the floor sees first; further ones stay as they were.
TEST(StackedToggles, OneChangeFromTheStartIsExactForTheNearestOfAnyNumber) {
    for (const size_t count : {9u, 20u})
        for (const char* starts : {"1", "0", "01"}) {
            const Stack stack{pattern(count, starts), false};
            const Polynomial light = bake(stack);
            for (size_t i = 0; i < 7; ++i) {
                std::vector<float> state = stack.starts;
                state[i] = 1.0f - state[i];
                ASSERT_NEAR(share(stack, light, state), truth(state), 4e-3) << count << " of pattern " << starts;
            }
        }
}

/// The share of light that the report says stays as it is at the start.
double stated(const std::string& report) {
    const size_t at = report.find("\"share\":", report.find("\"cut\":"));
    return at == std::string::npos ? 0.0 : std::stod(report.substr(at + 8));
}

/// Stacks beyond what a term holds are wrong in some states, by no more than is stated in 95 of 100.
TEST(StackedToggles, RandomStatesStayWithinWhatIsStated) {
    std::mt19937 random(1);
    for (const bool in_set : {false, true})
        for (const size_t count : {5u, 9u, 20u})
            for (const char* starts : {"1", "0", "01"}) {
                const Stack stack{pattern(count, starts), in_set};
                const Polynomial light = bake(stack);
                int within = 0;
                for (int round = 0; round < 50; ++round) {
                    std::vector<float> state(count, 0.0f); // light passes where few are there
                    for (int there = 0; there < round % 4; ++there) state[random() % count] = 1.0f;
                    for (float& presence : state)
                        if (round >= 25) presence = std::uniform_real_distribution<float>(0.0f, 1.0f)(random);
                    within += std::abs(share(stack, light, state) - truth(state)) <= stated(light.report) + 4e-3;
                }
                EXPECT_GE(within, 47) << count << " of pattern " << starts << (in_set ? ", in a set" : "");
            }
}

TEST(StackedToggles, WhatIsCutIsNamed) {
    for (const bool in_set : {false, true})
        for (const size_t count : {7u, 9u}) {
            const std::string report = bake({pattern(count, "1"), in_set}).report;
            const bool named = report.find("stays as it is at the start") != std::string::npos;
            EXPECT_EQ(named, count > 7) << count << (in_set ? " in a set" : "");
        }
}

} // namespace
