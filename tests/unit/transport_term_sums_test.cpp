// SPDX-License-Identifier: GPL-3.0-or-later
// Sums per term: what arrives is booked once, under the term it belongs to.
#include <gtest/gtest.h>

#include "transport/term_sums.h"

namespace ajar {
namespace {

constexpr uint32_t kSet = 0, kDoor = 1, kToggle = 2, kLane = 9, kOrder = 4;
const Vec3 kUp(0.0f, 0.0f, 1.0f);

const auto keep_all = [](const Term&) { return true; };

Term product(uint32_t set, std::initializer_list<uint32_t> switches) {
    Term term(set);
    for (const uint32_t s : switches) term.multiply(s);
    return term;
}

/// A table that knows the set and its product with the door.
struct Known : ::testing::Test {
    std::vector<Element> elements = std::vector<Element>(8);
    TermTable table{elements};
    uint32_t set, with_door;

    Known() {
        table.add({Term(kSet), product(kSet, {kDoor})});
        set = table.find(Term(kSet)), with_door = table.find(product(kSet, {kDoor}));
    }
};

using TermSumsTest = Known;

TEST(Term, OfAnotherSetHasTheSameSwitches) {
    const Term term = product(kSet, {kDoor, kToggle});
    EXPECT_EQ(term.of_set(7), product(7, {kDoor, kToggle}));
    EXPECT_EQ(term.of_set(kNoElement), product(kNoElement, {kDoor, kToggle}));
    EXPECT_EQ(Term().of_set(kSet), Term(kSet));
}

TEST_F(TermSumsTest, ProductsAreThoseOfTheTerms) {
    TermSums sums(table);
    const uint32_t lamp = sums.slot_of(set), door = sums.times(lamp, kDoor, kOrder, keep_all);
    EXPECT_EQ(door, sums.slot_of(with_door));
    EXPECT_EQ(sums.times(lamp, kDoor, kOrder, keep_all), door);
    EXPECT_EQ(sums.times(door, kDoor, kOrder, keep_all), door) << "a presence times itself is the presence";
    const uint32_t both = sums.times(door, kToggle, kOrder, keep_all);
    EXPECT_EQ(sums.term(both), product(kSet, {kDoor, kToggle}));
    EXPECT_EQ(sums.times(sums.times(lamp, kToggle, kOrder, keep_all), kDoor, kOrder, keep_all), both) << "in any order";
}

TEST_F(TermSumsTest, ProductsThatAreNotKeptHaveNoSlot) {
    TermSums sums(table);
    const uint32_t before = sums.slots() + 1, lamp = sums.slot_of(set);
    EXPECT_EQ(sums.times(lamp, kDoor, kOrder, [](const Term& t) { return t.order() < 2; }), TermSums::kNone);
    EXPECT_EQ(sums.slots(), before);
    const uint32_t full = sums.slot_of(product(kSet, {3, 4, 5}));
    EXPECT_EQ(sums.times(full, kDoor, kOrder, keep_all), TermSums::kCut) << "four elements are the most";
    EXPECT_EQ(sums.times(full, 4, kOrder, keep_all), full);
}

TEST_F(TermSumsTest, CutLightIsBookedWithItsSample) {
    TermSums sums(table);
    sums.meet(Vec3(-2.0f), 0.25f);
    sums.cut(kDoor, Vec3(-2.0f));
    sums.end_sample(kLane, 0, Vec3(0.6f, 0.0f, 0.8f), 3.0f);
    ASSERT_EQ(sums.cuts().size(), 1u);
    EXPECT_NEAR(sums.cuts().at(kDoor), 2.0 * 3.0 * 0.8, 1e-5);
    EXPECT_EQ(sums.met(), sums.cuts().at(kDoor));
    EXPECT_NEAR(sums.started(), 0.25 * sums.met(), 1e-5);
    EXPECT_EQ(sums.unswitched(), 0.0);
}

TEST_F(TermSumsTest, LightArrivesAtItsLaneAlone) {
    TermSums sums(table);
    const uint32_t lamp = sums.slot_of(set);
    sums.arrive(lamp, Vec3(1.0f, 2.0f, 3.0f));
    sums.end_sample(kLane, 0, kUp, 2.0f);
    ASSERT_NE(sums.block(lamp, kLane), nullptr);
    EXPECT_EQ(sums.block(lamp, kLane)->color(), Vec3(2.0f, 4.0f, 6.0f));
    EXPECT_EQ(sums.block(lamp, kLane + 1)->color(), Vec3(0.0f));
    EXPECT_EQ(sums.block(lamp, kLane + kLanes), nullptr);
    EXPECT_EQ(sums.slots_at(kLane), std::vector<uint32_t>{lamp});
    EXPECT_TRUE(sums.slots_at(kLane + 1).empty());
}

TEST_F(TermSumsTest, ARowAndSingleLightsAddUp) {
    const TermColor row[] = {{set, Vec3(1.0f)}, {with_door, Vec3(-0.5f)}};
    for (const bool row_first : {true, false}) {
        TermSums sums(table);
        const uint32_t lamp = sums.slot_of(set), door = sums.slot_of(with_door);
        if (row_first) sums.arrive(row, row + 2, Vec3(2.0f));
        sums.arrive(door, Vec3(4.0f));
        if (!row_first) sums.arrive(row, row + 2, Vec3(2.0f));
        sums.arrive(row, row + 1, Vec3(1.0f));
        sums.end_sample(kLane, 0, kUp, 1.0f);
        EXPECT_EQ(sums.block(lamp, kLane)->color(), Vec3(3.0f));
        EXPECT_EQ(sums.block(door, kLane)->color(), Vec3(3.0f));
        EXPECT_EQ(sums.block(door, kLane)->squares, sums.block(lamp, kLane)->squares);
        EXPECT_NEAR(sums.total_squares(kLane), 36.0, 1e-4);
    }
}

TEST_F(TermSumsTest, AllTogetherIsWithEverythingOpenAndPresent) {
    elements[kDoor].kind = ElementKind::door; // starts open: its variable is 0 while it is
    TermTable known{elements};
    TermSums sums(known);
    const uint32_t lamp = sums.slot_of_set(kSet), door = sums.slot_of(product(kSet, {kDoor}));
    EXPECT_EQ(lamp, sums.slot_of(Term(kSet)));
    EXPECT_EQ(sums.slot_of_set(kNoElement), sums.slot_of(Term()));
    sums.arrive(lamp, Vec3(3.0f));
    sums.arrive(door, Vec3(-2.0f));
    sums.end_sample(kLane, 0, kUp, 1.0f);
    EXPECT_NEAR(sums.total_squares(kLane), 9.0, 1e-4);
}

TEST_F(TermSumsTest, HarmonicsAreThoseOfTheDirection) {
    TermSums sums(table);
    const Vec3 w = glm::normalize(Vec3(0.3f, -0.4f, 0.8f));
    float y[kShCount];
    sh_basis(w.x, w.y, w.z, y);
    const uint32_t lamp = sums.slot_of(set);
    sums.arrive(lamp, Vec3(1.0f));
    sums.end_sample(kLane, 0, w, 3.0f);
    for (int i = 0; i < kShCount; ++i) EXPECT_NEAR(sums.block(lamp, kLane)->sh[i], 3.0f * y[i], 1e-5f) << i;
}

} // namespace
} // namespace ajar
