// SPDX-License-Identifier: GPL-3.0-or-later
// The promise of terms: for every state of light sets, doors and toggles, base + sum of terms is
// the bake of that state.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "room_kit.h"

namespace {

constexpr uint32_t kSize = 48;

enum : uint32_t { kLampA, kLampB, kSign, kDoor, kCrate, kBall, kElements };

struct State {
    std::array<float, kElements> weight;
    bool there(uint32_t e) const { return weight[e] > 0.5f; }
};

struct Options {
    bool pose = false;             ///< the door has an open pose
    bool black_door = false;       ///< the closed leaf reflects nothing
    const State* frozen = nullptr; ///< build this state without elements; null: build the elements
};

/// Two rooms joined by a doorway, a lamp in each, a sign, a door leaf with a gap around it, a crate
/// flush on the floor with a box flush on it.
class Rooms {
public:
    explicit Rooms(const Options& o) : o_(o) {
        white_ = scene.diffuse({0.7f, 0.65f, 0.6f});
        if (o.frozen == nullptr)
            for (const auto& [kind, name] : {std::pair{AJAR_ELEMENT_LIGHT_SET, "a"},
                                             {AJAR_ELEMENT_LIGHT_SET, "b"},
                                             {AJAR_ELEMENT_LIGHT_SET, "sign"},
                                             {AJAR_ELEMENT_DOOR, "door"},
                                             {AJAR_ELEMENT_TOGGLE, "crate"},
                                             {AJAR_ELEMENT_TOGGLE, "ball"}})
                scene.element(kind, name, !o.black_door);
        add(kit::box({-4, -2, 0}, {4, 2, 3}, true), white_);
        add(kit::box({-0.1f, -2, -0.1f}, {0.1f, -0.5f, 3.1f}, false), white_);
        add(kit::box({-0.1f, 0.5f, -0.1f}, {0.1f, 2, 3.1f}, false), white_);
        add(kit::box({-0.1f, -0.5f, 2}, {0.1f, 0.5f, 3.1f}, false), white_);
        const uint32_t red = scene.diffuse({0.8f, 0.2f, 0.1f});
        part(kDoor, false, kit::box({-0.05f, -0.47f, 0.03f}, {0.05f, 0.47f, 1.97f}, false),
             o.black_door && o.frozen != nullptr ? scene.diffuse({0, 0, 0}) : red);
        if (o.pose) part(kDoor, true, kit::box({0.15f, 0.55f, 0.03f}, {1.1f, 0.65f, 1.97f}, false), red);
        part(kCrate, false, kit::box({1.5f, -0.5f, 0}, {2.2f, 0.3f, 0.9f}, false), scene.diffuse({0.1f, 0.7f, 0.2f}));
        part(kBall, false, kit::box({1.6f, -0.2f, 0.9f}, {2.1f, 0.2f, 1.4f}, false), scene.diffuse({0.2f, 0.2f, 0.8f}));
        lamp(kLampA, {-2, 0.3f, 2.5f}, 100.0f);
        lamp(kLampB, {2.6f, 0.1f, 2.6f}, 40.0f);
        sign();
        scene.point_light({-3, -1.5f, 0.5f}, 10.0f, 0.05f);
        scene.commit();
    }
    kit::Scene scene;
    std::vector<uint32_t> pages;

private:
    void add(const kit::MeshData& data, uint32_t material) {
        pages.push_back(scene.page(kSize, kSize));
        scene.instance(scene.mesh(data), material, pages.back());
    }
    /// A surface that is there while element is at 1 (open: open pose of a door), or closed leaf.
    void part(uint32_t element, bool open, const kit::MeshData& data, uint32_t material) {
        const bool when = element != kDoor || open;
        if (o_.frozen != nullptr) {
            // Its page stays, so that pages of all scenes match.
            if (o_.frozen->there(element) == when)
                add(data, material);
            else
                pages.push_back(scene.page(kSize, kSize));
            return;
        }
        scene.current_switch = element;
        scene.open_pose = open;
        add(data, material);
        scene.current_switch = AJAR_NONE;
        scene.open_pose = false;
    }
    void lamp(uint32_t element, kit::Float3 at, float watts) {
        if (o_.frozen == nullptr) scene.current_set = element;
        scene.point_light(at, o_.frozen != nullptr ? watts * o_.frozen->weight[element] : watts, 0.05f,
                          element == kLampB);
        scene.current_set = AJAR_NONE;
    }
    void sign() {
        const float w = o_.frozen != nullptr ? o_.frozen->weight[kSign] : 1.0f;
        kit::MeshData quad;
        quad.quad({3.99f, -0.5f, 1}, {3.99f, -0.5f, 1.5f}, {3.99f, 0.5f, 1.5f}, {3.99f, 0.5f, 1}, {0, 0}, {1, 1});
        if (o_.frozen == nullptr) scene.current_set = kSign;
        scene.instance(scene.mesh(quad), scene.emitter({8 * w, 1 * w, 6 * w}), AJAR_NONE, "sign");
        scene.current_set = AJAR_NONE;
    }
    Options o_;
    uint32_t white_ = 0;
};

ajar_settings fine() {
    ajar_settings s = kit::settings(4, 256);
    s.bounce_samples = 256;
    s.direct_samples = 64;
    s.positions_per_texel = 4;
    s.term_threshold = 0.0f;
    s.combinations = AJAR_COMBINATIONS_ALL;
    return s;
}

/// Base plus terms at a state, page after page.
std::vector<double> sum_of_terms(const Rooms& rooms, const kit::Bake& bake, const State& state) {
    std::vector<double> out;
    const auto terms = bake.terms();
    for (const uint32_t page : rooms.pages) {
        std::vector<double> sum(3 * kSize * kSize, 0.0);
        for (uint32_t t = 0; t < terms.size(); ++t) {
            double w = 1.0;
            for (uint32_t e = 0; e < terms[t].element_count; ++e) w *= state.weight[terms[t].elements[e]];
            if (w == 0.0) continue;
            const kit::Layer l = bake.term(t, kSize, kSize, page);
            for (size_t i = 0; i < sum.size(); ++i) sum[i] += w * l.data[i];
        }
        out.insert(out.end(), sum.begin(), sum.end());
    }
    return out;
}

struct Agreement {
    double mean_ratio = 0.0; ///< of all light
    double rms = 0.0;        ///< of the difference, over the mean
};

Agreement compare(const Options& options, const State& state) {
    static std::map<int, std::pair<std::unique_ptr<Rooms>, std::unique_ptr<kit::Bake>>> cache;
    auto& [rooms, bake] = cache[options.pose + 2 * options.black_door];
    if (!rooms) {
        rooms = std::make_unique<Rooms>(options);
        bake = std::make_unique<kit::Bake>(rooms->scene, fine());
    }
    Options frozen = options;
    frozen.frozen = &state;
    const Rooms other(frozen);
    ajar_settings s = fine();
    s.seed = 77;
    const kit::Bake whole(other.scene, s);
    const std::vector<double> sum = sum_of_terms(*rooms, *bake, state);
    double total = 0.0, expected = 0.0, squares = 0.0, count = 0.0;
    size_t next = 0;
    for (const uint32_t page : other.pages) {
        const kit::Layer e = whole.layer(AJAR_LAYER_IRRADIANCE, page),
                         validity = whole.layer(AJAR_LAYER_VALIDITY, page);
        for (size_t i = 0; i < e.data.size(); ++i, ++next) {
            // Black is what the bake has in the middle of a solid; terms may have light from around it there.
            const float* light = &e.data[i - i % 3];
            if (validity.data[i / 3] != 1.0f || light[0] + light[1] + light[2] == 0.0f) continue;
            total += sum[next];
            expected += e.data[i];
            squares += (sum[next] - e.data[i]) * (sum[next] - e.data[i]);
            count += 1.0;
        }
    }
    return {total / expected, std::sqrt(squares / count) / (expected / count)};
}

TEST(Terms, BasePlusTermsIsTheBakeOfAState) {
    // One process for all states: each option's terms are baked once.
    for (const int i : {0, 1, 7, 9, 23, 24, 39, 47, 59, 63}) {
        const State state{{i & 1 ? 0.7f : 0.0f, i & 2 ? 1.5f : 0.2f, i & 4 ? 2.0f : 0.0f, i & 8 ? 1.0f : 0.0f,
                           i & 16 ? 1.0f : 0.0f, i & 32 ? 1.0f : 0.0f}};
        for (const bool pose : {false, true}) {
            Options o;
            o.pose = pose;
            const Agreement a = compare(o, state);
            EXPECT_NEAR(a.mean_ratio, 1.0, 0.006) << "state " << i << (pose ? " with pose" : "");
            EXPECT_LT(a.rms, 0.06) << "state " << i << (pose ? " with pose" : "");
        }
    }
}

TEST(Terms, ABlackDoorReflectsNothingWhenClosed) {
    Options o;
    o.black_door = true;
    const Agreement a = compare(o, State{{1, 1, 1, 0, 1, 1}});
    EXPECT_NEAR(a.mean_ratio, 1.0, 0.006);
}

/// Terms of a texel.
struct Kept {
    uint32_t most, fewest;
};

/// Twelve lamps, each a set, over a slab that takes all their light from the floor: a texel has 12 sets and as many
/// products as strong as they.
Kept terms_of_texels(uint32_t light_patches) {
    constexpr uint32_t kSize = 8, kSets = 12;
    kit::Scene scene;
    const uint32_t grey = scene.diffuse({0.5f, 0.5f, 0.5f}), slab = scene.element(AJAR_ELEMENT_TOGGLE, "slab");
    const uint32_t page = scene.page(kSize, kSize);
    scene.instance(scene.mesh(kit::plane(4.0f, 0.0f)), grey, page);
    scene.current_switch = slab;
    scene.instance(scene.mesh(kit::box({-8.0f, -8.0f, 1.0f}, {8.0f, 8.0f, 1.1f}, false)), grey, AJAR_NONE);
    scene.current_switch = AJAR_NONE;
    for (uint32_t i = 0; i < kSets; ++i) {
        scene.current_set = scene.element(AJAR_ELEMENT_LIGHT_SET, ("lamp " + std::to_string(i)).c_str());
        scene.point_light({0.3f * static_cast<float>(i) - 1.8f, 0.2f, 3.0f}, 20.0f + static_cast<float>(i), 0.05f);
    }
    scene.commit();
    ajar_settings s = kit::settings(1, 64);
    s.light_patches = light_patches;
    const kit::Bake bake(scene, s);
    std::vector<uint32_t> all(kSize * kSize, 0);
    for (uint32_t t = 1; t < bake.terms().size(); ++t) {
        const kit::Layer l = bake.term(t, kSize, kSize, page);
        for (size_t i = 0; i < all.size(); ++i) all[i] += l.data[3 * i] != 0.0f;
    }
    return {*std::max_element(all.begin(), all.end()), *std::min_element(all.begin(), all.end())};
}

TEST(Terms, AnyNumberStaysAtATexel) {
    for (const uint32_t patches : {AJAR_LIGHT_PATCHES_NONE, AJAR_LIGHT_PATCHES_MONO}) {
        const Kept kept = terms_of_texels(patches);
        EXPECT_EQ(kept.fewest, 24u); // 12 sets, and what the slab takes from each
        EXPECT_EQ(kept.most, 24u);
    }
}

} // namespace
