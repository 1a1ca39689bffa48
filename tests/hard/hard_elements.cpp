// SPDX-License-Identifier: GPL-3.0-or-later
// Single doors in odd places, and sets that share a texel.
#include "hard_case.h"

namespace hard {
namespace {

double flush_door(const Variant& v) {
    // A leaf that fills its hole to the edge: closed, the room behind is dark.
    Stage s(v);
    const uint32_t black = s.scene.diffuse({0, 0, 0}), page = s.object(kit::plane(1.0f, 0.0f), black, 8);
    constexpr float kW = 4.0f;
    kit::MeshData wall;
    const auto facing_down = [&](kit::MeshData& mesh, float x0, float y0, float x1, float y1) {
        mesh.quad({x0, y0, 1}, {x0, y1, 1}, {x1, y1, 1}, {x1, y0, 1}, {0, 0}, {1, 1});
    };
    facing_down(wall, -kW, -kW, -0.5f, kW);
    facing_down(wall, 0.5f, -kW, kW, kW);
    facing_down(wall, -0.5f, -kW, 0.5f, -0.5f);
    facing_down(wall, -0.5f, 0.5f, 0.5f, kW);
    s.object(wall, black);
    s.object(kit::box({-kW, -kW, -1}, {kW, kW, 1.5f}, true), black); // closes the room, above the wall too
    s.scene.current_switch = s.scene.element(AJAR_ELEMENT_DOOR, "door", false);
    kit::MeshData leaf;
    facing_down(leaf, -0.5f, -0.5f, 0.5f, 0.5f);
    s.object(leaf, black);
    s.scene.current_switch = AJAR_NONE;
    s.point({0, 0, 1.3f}, 100, 0.02f);
    s.scene.commit();
    const kit::Bake bake(s.scene, s.settings(1, 64));
    if (bake.terms().size() != 2) return HUGE_VAL;
    return largest(s.term(bake, 0, 8, page)) / mean(s.term(bake, 1, 8, page));
}

/// Twenty lamps, each a light set; the light of each and that of all together.
double many_sets(const Variant& v) {
    Stage s(v);
    const uint32_t page = s.object(kit::plane(2.0f, 0.0f), s.scene.diffuse({0.5f, 0.5f, 0.5f}), 16);
    constexpr int kSets = 20;
    std::vector<Float3> lamps;
    for (int i = 0; i < kSets; ++i) {
        lamps.push_back({0.1f * float(i % 5) - 0.2f, 0.1f * float(i / 5) - 0.2f, 2.0f});
        s.scene.current_set = s.scene.element(AJAR_ELEMENT_LIGHT_SET, "set " + std::to_string(i));
        s.point(lamps.back(), 10.0 + i);
    }
    s.scene.commit();
    const kit::Bake bake(s.scene, s.settings(0, 64));
    const auto terms = bake.terms();
    if (terms.size() != kSets + 1) return HUGE_VAL;
    double most = 0.0;
    for (uint32_t t = 1; t <= kSets; ++t) {
        const uint32_t i = terms[t].elements[0];
        most = std::max(most, worst(s.term(bake, t, 16, page), [&](uint32_t x, uint32_t y) {
                            return from_point(lamps[i], 10.0 + i, texel(x, y, 16, 2.0f));
                        }));
    }
    return most;
}

double identical_sets(const Variant& v) {
    Stage s(v);
    const uint32_t page = s.object(kit::plane(2.0f, 0.0f), s.scene.diffuse({0.5f, 0.5f, 0.5f}), 16);
    for (const char* name : {"one", "other"}) {
        s.scene.current_set = s.scene.element(AJAR_ELEMENT_LIGHT_SET, name);
        s.point({0, 0, 2}, 10.0);
    }
    s.scene.commit();
    const kit::Bake bake(s.scene, s.settings(0, 64));
    if (bake.terms().size() != 3) return HUGE_VAL;
    double most = 0.0;
    for (const uint32_t term : {1u, 2u})
        most = std::max(most, worst(s.term(bake, term, 16, page), [](uint32_t x, uint32_t y) {
                            return from_point({0, 0, 2}, 10.0, texel(x, y, 16, 2.0f));
                        }));
    return most;
}

double inside_a_door(const Variant& v) {
    // A leaf that stands in the floor: some receivers lie inside of it while it is there, others see it edge-on.
    Stage s(v);
    const uint32_t black = s.scene.diffuse({0, 0, 0}), page = s.object(kit::plane(2.0f, 0.0f), black, 16);
    s.scene.current_switch = s.scene.element(AJAR_ELEMENT_DOOR, "door");
    s.object(kit::box({-0.1f, -0.5f, -0.1f}, {0.1f, 0.5f, 1.5f}, false), black);
    s.scene.current_switch = AJAR_NONE;
    s.sky(1.0);
    s.scene.commit();
    const kit::Bake bake(s.scene, s.settings(1, 256));
    if (bake.terms().size() != 2) return HUGE_VAL;
    const Layer closed = s.term(bake, 0, 16, page), opened = s.term(bake, 1, 16, page);
    if (!std::isfinite(largest(closed))) return HUGE_VAL;
    Layer open = closed;
    for (size_t i = 0; i < open.data.size(); ++i) open.data[i] += opened.data[i];
    return worst(open, pi);
}

double gap_beside_a_door(const Variant& v) {
    // The closed leaf leaves a gap of 1 cm: light of a sky that fills the slit, and no more.
    Stage s(v);
    const uint32_t black = s.scene.diffuse({0, 0, 0}), page = s.object(kit::plane(0.5f, 0.0f), black, 8);
    kit::MeshData wall, leaf;
    const auto facing_down = [](kit::MeshData& mesh, float x0, float y0, float x1, float y1) {
        mesh.quad({x0, y0, 1}, {x0, y1, 1}, {x1, y1, 1}, {x1, y0, 1}, {0, 0}, {1, 1});
    };
    facing_down(wall, -4, -4, 0, 4);
    facing_down(wall, 1, -4, 4, 4);
    facing_down(wall, 0, -4, 1, -0.5f);
    facing_down(wall, 0, 0.5f, 1, 4);
    facing_down(leaf, 0.01f, -0.5f, 1, 0.5f);
    s.object(wall, black);
    s.object(kit::plane(8.0f, -0.5f), black);
    for (const float side : {-1.0f, 1.0f}) { // no sky between wall and floor
        kit::MeshData ends;
        ends.quad({4 * side, -4, -1}, {4 * side, 4, -1}, {4 * side, 4, 1}, {4 * side, -4, 1}, {0, 0}, {1, 1});
        ends.quad({-4, 4 * side, -1}, {4, 4 * side, -1}, {4, 4 * side, 1}, {-4, 4 * side, 1}, {0, 0}, {1, 1});
        s.object(ends, black);
    }
    s.scene.current_switch = s.scene.element(AJAR_ELEMENT_DOOR, "door", false);
    s.object(leaf, black);
    s.scene.current_switch = AJAR_NONE;
    s.sky(1.0);
    s.scene.commit();
    const Layer e = s.term(kit::Bake(s.scene, s.settings(1, 4096)), 0, 8, page);
    double expected = 0.0;
    constexpr int kCuts = 64;
    for (uint32_t i = 0; i < 64; ++i) {
        const Float3 p = texel(i % 8, i / 8, 8, 0.5f);
        for (int k = 0; k < kCuts; ++k) { // both cosines are 1 / r
            const double y = (k + 0.5) / kCuts - 0.5 - p[1], x = 0.005 - p[0], r2 = x * x + y * y + 1.0;
            expected += 0.01 / kCuts / (r2 * r2) / 64.0;
        }
    }
    return std::abs(mean(e) / expected - 1.0);
}

const Case kCases[] = {
    {"elements", Origin::kBase, "door flush with its wall", "light leaks around the closed leaf",
     "brightest closed / mean open", 1e-6, flush_door},
    {"elements", Origin::kBase, "20 sets on one texel", "terms get lost or mixed", "worst texel of a set", 0.05,
     many_sets},
    {"elements", Origin::kBase, "two identical sets", "one hides the other", "worst texel of a set", 0.05,
     identical_sets},
    {"elements", Origin::kBase, "receivers inside a leaf, and in its plane", "no side to aim at: 0 / 0",
     "worst texel of the open state", 0.01, inside_a_door},
    {"elements", Origin::kBase, "gap of 1 cm beside a leaf", "leaf seen as its box: no light, or all",
     "mean light through the gap", 0.1, gap_beside_a_door},
};

} // namespace

std::span<const Case> element_cases() { return kCases; }

} // namespace hard
