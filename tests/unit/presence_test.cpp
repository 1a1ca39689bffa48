// SPDX-License-Identifier: GPL-3.0-or-later
// The algebra of doors' and toggles' variables, at the states that count: weight 0 and weight 1.
#include <gtest/gtest.h>

#include "package/weight_polynomial.h"
#include "scene/term.h"

namespace ajar {
namespace {

constexpr float kStarts[] = {0.0f, 0.25f, 0.5f, 1.0f};

Element toggle(float start) { return {"toggle", ElementKind::toggle, start}; }

TEST(Presence, IsLinearInTheVariableAndVariablesAreIdempotentUpToIt) {
    for (const float start : kStarts) {
        const Element e = toggle(start);
        EXPECT_EQ(e.variable(start), 0.0f);
        for (const bool state : {false, true})
            for (const float w : {0.0f, 1.0f}) {
                const PresenceFactors f = presence_factors(e, state);
                const float x = e.variable(w), presence = state ? w : 1.0f - w;
                EXPECT_FLOAT_EQ(f.constant + f.linear * x, presence) << start << state << w;
                EXPECT_FLOAT_EQ(f.kept * x + f.freed, presence * x) << start << state << w;
            }
    }
}

TEST(Presence, BeyondItsRoomAConditionIsThatOfTheStart) {
    std::vector<Element> elements;
    for (uint32_t i = 0; i < Condition::kCapacity; ++i) elements.push_back(toggle(0.0f));
    const auto away = static_cast<uint32_t>(elements.size()), there = away + 1, half = away + 2;
    for (const float start : {0.0f, 1.0f, 0.25f}) elements.push_back(toggle(start));
    Condition full;
    for (uint32_t i = 0; i < Condition::kCapacity; ++i) EXPECT_TRUE(full.require(elements, {i, false}));
    EXPECT_EQ(full.not_followed(), kNoElement);
    Condition c = full;
    EXPECT_TRUE(c.require(elements, {away, false}) && c.require(elements, {there, true}));
    EXPECT_EQ(c.at_start(), 1.0f);
    EXPECT_TRUE(c.require(elements, {half, true}));
    EXPECT_EQ(c.at_start(), 0.25f);
    EXPECT_EQ(c.not_followed(), half);
    for (const Presence& p : {Presence{away, true}, Presence{there, false}}) {
        Condition none = full;
        EXPECT_TRUE(none.require(elements, p)) << "its light is counted as cut";
        EXPECT_EQ(none.at_start(), 0.0f);
        EXPECT_EQ(none.not_followed(), p.element);
    }
    EXPECT_FALSE(c.require(elements, {0, true})) << "known elements still contradict";
}

TEST(Term, HoldsEightElementsInOrder) {
    Term term(9);
    for (const uint32_t e : {40u, 3u, 65000u, 7u, 12u, 5u, 6u}) EXPECT_TRUE(term.multiply(e));
    EXPECT_EQ(term.order(), 8u);
    const uint32_t sorted[] = {3, 5, 6, 7, 12, 40, 65000};
    for (uint32_t i = 0; i < 7; ++i) EXPECT_EQ(term.element(i), sorted[i]);
    EXPECT_FALSE(term.multiply(8)) << "full";
    EXPECT_TRUE(term.multiply(40)) << "there already";
    EXPECT_EQ(term.without(6).switch_count(), 6u);
    EXPECT_FALSE(term.without(6).contains(6));
    Term same = term.without(6);
    same.multiply(6);
    EXPECT_EQ(same, term);
    EXPECT_EQ(same.hash(), term.hash());
    EXPECT_EQ(term.of_set(kNoElement).set(), kNoElement);
    EXPECT_EQ(term.of_set(kNoElement).of_set(9), term);
}

/// Value of a polynomial whose terms have the given light, at some weights.
double value(const std::vector<WeightTerm>& terms, const std::vector<float>& weights, double base,
             const std::vector<double>& light) {
    double sum = 0.0;
    for (const WeightTerm& t : terms) {
        double product = 1.0, own = 0.0;
        for (const uint32_t e : t.elements) product *= weights[e];
        for (const WeightTerm::Part& p : t.parts)
            own += p.factor * (p.term == WeightTerm::kBase ? base : light[p.term]);
        sum += product * own;
    }
    return sum;
}

TEST(WeightPolynomial, IsTheSamePolynomial) {
    const std::vector<PackageElement> elements{
        {"lamp", "light_set", 2.0f}, {"shut", "door", 0.0f}, {"ajar", "door", 0.25f}, {"there", "toggle", 1.0f}};
    const std::vector<std::vector<uint32_t>> products{{0}, {1}, {0, 2}, {3}, {1, 3}, {0, 1, 2, 3}};
    const std::vector<double> light{3.0, -0.5, 0.7, 1.1, -0.2, 0.05};
    const auto terms = in_weights(elements, products);
    ASSERT_TRUE(terms.front().elements.empty());
    for (const std::vector<float>& w :
         {std::vector<float>{2.0f, 0.0f, 0.25f, 1.0f}, {0.0f, 1.0f, 0.0f, 0.0f}, {0.3f, 0.6f, 0.9f, 0.2f}}) {
        double expected = 10.0;
        for (size_t t = 0; t < products.size(); ++t) {
            double product = light[t];
            for (const uint32_t e : products[t])
                product *= e == 0 ? w[0] : e == 3 ? 1.0f - w[3] : w[e] - elements[e].weight;
            expected += product;
        }
        EXPECT_NEAR(value(terms, w, 10.0, light), expected, 1e-5);
    }
}

} // namespace
} // namespace ajar
