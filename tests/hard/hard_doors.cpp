// SPDX-License-Identifier: GPL-3.0-or-later
// Doors behind, beside and within each other: light that passes is that of all, times a product of openness.
#include <string>

#include "hard_case.h"

namespace hard {
namespace {

constexpr uint32_t kSize = 4;

/// Doors within each other around a floor, under a sky or in a glowing shell of a set.
struct Chain {
    Stage s;
    uint32_t page;

    Chain(const Variant& v, const std::vector<float>& starts, bool in_set) : s(v) {
        page = s.object(kit::plane(kAround, 0.0f), s.black(), kSize);
        for (size_t i = 0; i < starts.size(); ++i)
            s.door("door " + std::to_string(i), starts[i]), s.object(around(i), s.black());
        s.release();
        if (in_set)
            s.set("shell"), s.object(kit::box({-2, -2, -2}, {2, 2, 2}, true), s.emitter({1, 1, 1}));
        else
            s.sky(1.0);
        s.scene.commit();
    }
    /// Largest difference from the product of openness, of all light.
    double worst_at(const kit::Bake& bake, std::vector<float> openness) const {
        double share = 1.0, most = 0.0;
        for (const float w : openness) share *= w;
        openness.push_back(1.0f);
        const Layer e = s.state(bake, openness, kSize, page);
        for (size_t i = 0; i < e.data.size(); ++i) most = std::max(most, std::abs(e.data[i] / pi - share));
        return most;
    }
};

double five_in_a_row(const Variant& v) {
    double most = 0.0;
    for (const bool in_set : {false, true})
        for (const std::vector<float>& start : {std::vector<float>(5, 0.0f), {1, 1, 0, 0.5f, 1}}) {
            const Chain chain(v, start, in_set);
            const kit::Bake bake(chain.s.scene, chain.s.settings(1, 128));
            for (const std::vector<float>& state : {start,
                                                    std::vector<float>(5, 1.0f),
                                                    std::vector<float>(5, 0.0f),
                                                    std::vector<float>(5, 0.5f),
                                                    {1, 1, 0.5f, 1, 1}})
                most = std::max(most, chain.worst_at(bake, state));
        }
    return most;
}

double twelve_that_start(const Variant& v) {
    double most = 0.0;
    for (const bool in_set : {false, true})
        for (const float start : {0.0f, 0.9f, 1.0f}) {
            const std::vector<float> starts(12, start);
            const Chain chain(v, starts, in_set);
            most = std::max(most, chain.worst_at(kit::Bake(chain.s.scene, chain.s.settings(1, 128)), starts));
        }
    return most;
}

constexpr int kColumns = 20, kRows = 10;
/// The tile of a ceiling of 10 m at height 1.
kit::MeshData tile(int column, int row) {
    kit::MeshData m;
    const float x = 0.5f * static_cast<float>(column) - 5.0f, y = static_cast<float>(row) - 5.0f;
    m.quad({x, y, 1}, {x, y + 1, 1}, {x + 0.5f, y + 1, 1}, {x + 0.5f, y, 1}, {0, 0}, {1, 1});
    return m;
}

/// A ceiling of 200 doors; every closed_every-th starts closed.
double side_by_side(const Variant& v, int closed_every, bool open_all) {
    Stage s(v);
    const uint32_t page = s.object(kit::plane(0.5f, 0.0f), s.black(), 2);
    std::vector<float> weights;
    for (int i = 0; i < kColumns * kRows; ++i) {
        const bool closed = (i % kColumns + i / kColumns) % closed_every == 0;
        s.door("door " + std::to_string(i), closed ? 0.0f : 1.0f);
        weights.push_back(closed && !open_all ? 0.0f : 1.0f);
        s.object(tile(i % kColumns, i / kColumns), s.black());
    }
    s.release();
    s.sky(1.0);
    s.scene.commit();
    const Layer e = s.state(kit::Bake(s.scene, s.settings(1, 4096)), weights, 2, page);
    return worst(e, [&](uint32_t x, uint32_t y) {
        double light = pi;
        for (int i = 0; i < kColumns * kRows; ++i) {
            const double x0 = 0.5 * (i % kColumns) - 5.0, y0 = i / kColumns - 5.0;
            if (weights[static_cast<size_t>(i)] == 0.0f)
                light -= from_rectangle(x0, x0 + 0.5, y0, y0 + 1, 1, texel(x, y, 2, 0.5f));
        }
        return light;
    });
}

double all_opened(const Variant& v) { return side_by_side(v, 1, true); }
double chessboard(const Variant& v) { return side_by_side(v, 2, false); }

double one_door_of_ten_leaves(const Variant& v) {
    double most = 0.0;
    for (const float start : {0.0f, 0.5f, 1.0f}) {
        Stage s(v);
        const uint32_t page = s.object(kit::plane(kAround, 0.0f), s.black(), kSize);
        s.door("door", start);
        for (size_t i = 0; i < 10; ++i) s.object(around(i), s.black());
        s.release();
        s.sky(1.0);
        s.scene.commit();
        const kit::Bake bake(s.scene, s.settings(1, 128));
        for (const float w : {0.0f, 0.25f, 1.0f}) {
            const Layer e = s.state(bake, {w}, kSize, page);
            for (const float light : e.data) most = std::max(most, std::abs(light / pi - w));
        }
    }
    return most;
}

/// Closed, the leaf lets half through; open, it stands above in another pose and lets a quarter through.
double tinted_in_two_poses(const Variant& v) {
    double most = 0.0;
    for (const float start : {0.0f, 0.3f, 1.0f}) {
        Stage s(v);
        const uint32_t page = s.object(kit::plane(kAround, 0.0f), s.black(), kSize);
        s.door("door", start);
        s.object(around(0), s.pane({0.5f, 0.5f, 0.5f}));
        s.scene.open_pose = true;
        s.object(around(1), s.pane({0.25f, 0.25f, 0.25f}));
        s.release();
        s.scene.open_pose = false;
        s.sky(1.0);
        s.scene.commit();
        const kit::Bake bake(s.scene, s.settings(1, 256));
        for (const float w : {0.0f, 0.3f, 1.0f})
            most = std::max(most, off(mean(s.state(bake, {w}, kSize, page)), pi * (0.5 * (1.0 - w) + 0.25 * w)));
    }
    return most;
}

const Case kCases[] = {
    {"doors", Origin::kReport, "5 doors behind each other, sky and glow of a set",
     "products of several doors are not baked", "worst texel of five states, of all light", 0.005, five_in_a_row},
    {"doors", Origin::kReport, "12 doors behind each other that start closed, ajar, open",
     "rays through the ninth are lost", "worst texel at the start, of all light", 0.005, twelve_that_start},
    {"doors", Origin::kReport, "200 doors side by side, all opened", "a texel has no room for so many", "worst texel",
     0.02, all_opened},
    {"doors", Origin::kSibling, "200 doors side by side, every other open", "what is cut is cut from the start",
     "worst texel at the start", 0.02, chessboard},
    {"doors", Origin::kSibling, "10 leaves of one door behind each other", "openness to the tenth power",
     "worst texel of three states, of all light", 0.001, one_door_of_ten_leaves},
    {"doors", Origin::kSibling, "tinted leaf, open in another tint", "both poses at once", "mean of three states", 0.01,
     tinted_in_two_poses},
};

} // namespace

std::span<const Case> door_cases() { return kCases; }

} // namespace hard
