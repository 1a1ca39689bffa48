// SPDX-License-Identifier: GPL-3.0-or-later
// Hard cases, each as it is, a thousandth and a thousand times as large, ten kilometres away, under a million
// times the light, and with two threads: one number per case that must stay below a bound.
//
//     AJAR_HARD_TABLE=FILE.md build/release/bin/hard_suite_test     # also writes the numbers as a table
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <numbers>

#include "stage.h"

namespace {

using kit::Float3;
using kit::Layer;
using kit::Stage;
using kit::Variant;
using std::numbers::pi;

const Variant kVariants[] = {{},
                             {.name = "/ 1000", .scale = 1e-3f},
                             {.name = "* 1000", .scale = 1e3f},
                             {.name = "10 km away", .away = 1e4},
                             {.name = "light * 1e6", .light = 1e6},
                             {.name = "2 threads", .threads = 2}};

/// Largest channel value; infinite if some is not finite or negative.
double largest(const Layer& e) {
    double most = 0.0;
    for (const float v : e.data) most = std::isfinite(v) && v >= 0.0f ? std::max<double>(most, v) : HUGE_VAL;
    return most;
}

/// Largest relative deviation from what is expected at a texel.
double worst(const Layer& e, const std::function<double(uint32_t, uint32_t)>& expected) {
    double most = 0.0;
    for (uint32_t y = 0; y < e.height; ++y)
        for (uint32_t x = 0; x < e.width; ++x) {
            const double off = std::abs(e.at(x, y) / expected(x, y) - 1.0);
            most = off >= most || std::isfinite(off) ? std::max(most, off) : HUGE_VAL;
        }
    return most;
}
double worst(const Layer& e, double expected) {
    return worst(e, [=](uint32_t, uint32_t) { return expected; });
}

double mean(const Layer& e) {
    double sum = 0.0;
    for (const float v : e.data) sum += v;
    return sum / static_cast<double>(e.data.size());
}

/// Middle of a texel of a square of edge m about the origin.
Float3 texel(uint32_t x, uint32_t y, uint32_t size, float edge) {
    return {(float(x) + 0.5f) / float(size) * edge - 0.5f * edge, (float(y) + 0.5f) / float(size) * edge - 0.5f * edge,
            0.0f};
}

/// Irradiance of a point lamp of so many watts at a point of the plane z = 0.
double from_point(const Float3& lamp, double watts, const Float3& p) {
    const double dx = lamp[0] - p[0], dy = lamp[1] - p[1], dz = lamp[2], r2 = dx * dx + dy * dy + dz * dz;
    return watts / (4.0 * pi) * dz / (r2 * std::sqrt(r2));
}

// ---- the cases: each returns its number ------------------------------------------------------

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

double lamp_near_floor(const Variant& v) {
    Stage s(v);
    const uint32_t page = s.object(kit::plane(2.0f, 0.0f), s.scene.diffuse({0.5f, 0.5f, 0.5f}), 33);
    s.point({0, 0, 0.001f}, 1000);
    s.scene.commit();
    const Layer e = s.irradiance(kit::Bake(s.scene, s.settings(1, 64)), page);
    if (!std::isfinite(largest(e))) return HUGE_VAL;
    return std::abs(e.at(26, 16) / from_point({0, 0, 0.001f}, 1000, texel(26, 16, 33, 2.0f)) - 1.0);
}

double lamp_in_wall(const Variant& v) {
    Stage s(v);
    const uint32_t page = s.object(kit::plane(2.0f, 0.0f), s.scene.diffuse({0.5f, 0.5f, 0.5f}), 16);
    s.object(kit::box({-0.2f, -0.2f, 0.8f}, {0.2f, 0.2f, 1.2f}, false), s.scene.diffuse({0.5f, 0.5f, 0.5f}));
    s.point({0, 0, 1}, 1000, 0.05f);
    s.scene.commit();
    return largest(s.irradiance(kit::Bake(s.scene, s.settings(2, 64)), page));
}

double grazing_sun(const Variant& v) {
    Stage s(v);
    const uint32_t page = s.object(kit::plane(2.0f, 0.0f), s.scene.diffuse({0.5f, 0.5f, 0.5f}), 16);
    const double elevation = 0.1 * pi / 180.0;
    s.sun(elevation, 1000.0);
    s.scene.commit();
    return worst(s.irradiance(kit::Bake(s.scene, s.settings(0, 64)), page), 1000.0 * std::sin(elevation));
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

double tiny_emitter(const Variant& v) {
    Stage s(v);
    const uint32_t page = s.object(kit::plane(2.0f, 0.0f), s.scene.diffuse({0, 0, 0}), 16);
    kit::MeshData chip;
    chip.quad({-0.005f, -0.005f, 1}, {-0.005f, 0.005f, 1}, {0.005f, 0.005f, 1}, {0.005f, -0.005f, 1}, {0, 0}, {1, 1});
    s.object(chip, s.emitter({1e4f, 1e4f, 1e4f}));
    s.scene.commit();
    return worst(s.irradiance(kit::Bake(s.scene, s.settings(1, 256)), page), [](uint32_t x, uint32_t y) {
        const Float3 p = texel(x, y, 16, 2.0f);
        const double r2 = double(p[0]) * p[0] + double(p[1]) * p[1] + 1.0;
        return 1e4 * 1e-4 / (r2 * r2); // both cosines are 1 / r
    });
}

double glowing_crowd(const Variant& v) {
    // 20,000 emissive triangles: a ceiling of small panels. Their light is that of one whole panel.
    Stage s(v);
    const uint32_t page = s.object(kit::plane(0.5f, 0.0f), s.scene.diffuse({0, 0, 0}), 8);
    kit::MeshData panels, one;
    constexpr int kEdge = 100;
    for (int i = 0; i < kEdge; ++i)
        for (int j = 0; j < kEdge; ++j) {
            const float x = -1.0f + 0.02f * float(i), y = -1.0f + 0.02f * float(j);
            panels.quad({x, y, 1}, {x, y + 0.02f, 1}, {x + 0.02f, y + 0.02f, 1}, {x + 0.02f, y, 1}, {0, 0}, {1, 1});
        }
    s.object(panels, s.emitter({1, 1, 1}));
    s.object(kit::plane(8.0f, -5.0f), s.scene.diffuse({0, 0, 0})); // or the ceiling would be most of the scene
    s.scene.commit();
    // Rectangle to a point of a parallel plane: four corners (algorithms.md 12.5).
    const auto corner = [](double a, double b) {
        const double ra = std::sqrt(1.0 + a * a), rb = std::sqrt(1.0 + b * b);
        return (a / ra * std::atan(b / ra) + b / rb * std::atan(a / rb)) / 2.0;
    };
    return worst(s.irradiance(kit::Bake(s.scene, s.settings(0, 1024)), page), [&](uint32_t x, uint32_t y) {
        const Float3 p = texel(x, y, 8, 0.5f);
        return corner(1.0 - p[0], 1.0 - p[1]) + corner(1.0 + p[0], 1.0 - p[1]) + corner(1.0 - p[0], 1.0 + p[1]) +
               corner(1.0 + p[0], 1.0 + p[1]);
    });
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

double spot_edge(const Variant& v) {
    Stage s(v);
    const uint32_t page = s.object(kit::plane(4.0f, 0.0f), s.scene.diffuse({0.5f, 0.5f, 0.5f}), 32);
    s.spot({0, 0, 1}, 100, float(0.5 * pi)); // lights a disk of radius 1
    s.scene.commit();
    const Layer e = s.irradiance(kit::Bake(s.scene, s.settings(0, 64)), page);
    double outside = 0.0;
    for (uint32_t y = 0; y < 32; ++y)
        for (uint32_t x = 0; x < 32; ++x) {
            const Float3 p = texel(x, y, 32, 4.0f);
            if (std::hypot(p[0], p[1]) > 1.0 + 0.125) outside = std::max<double>(outside, e.at(x, y));
        }
    return e.at(16, 16) > 1.0f ? outside : HUGE_VAL;
}

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

double sun_in_one_pixel(const Variant& v) {
    Stage s(v);
    const uint32_t page = s.object(kit::plane(2.0f, 0.0f), s.scene.diffuse({0, 0, 0}), 8);
    constexpr uint32_t kWidth = 256, kHeight = 128, kRow = 100;
    std::vector<float> sky(size_t{4} * kWidth * kHeight, 0.0f);
    for (int c = 0; c < 3; ++c) sky[4 * (size_t{kRow} * kWidth + 37) + c] = 1e5f;
    const auto light = static_cast<float>(v.light);
    s.scene.sky_image(s.scene.texture(sky, kWidth, kHeight), {light, light, light});
    s.scene.commit();
    // Radiance times the integral of the sine of the elevation over the pixel's solid angle.
    const auto square = [](uint32_t row) { return std::pow(std::sin(pi * (double(row) / kHeight - 0.5)), 2); };
    const double expected = 1e5 * 2.0 * pi / kWidth * 0.5 * (square(kRow + 1) - square(kRow));
    return worst(s.irradiance(kit::Bake(s.scene, s.settings(1, 256)), page), expected);
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

double dark_room(const Variant& v) {
    Stage s(v);
    const uint32_t page = s.object(kit::box({-1, -1, -1}, {1, 1, 1}, true), s.scene.diffuse({0.5f, 0.5f, 0.5f}), 16);
    s.scene.commit();
    return largest(s.irradiance(kit::Bake(s.scene, s.settings(2, 64)), page));
}

// ---- the suite -------------------------------------------------------------------------------

struct Case {
    const char* name;
    const char* trap; ///< what breaks naive bakers
    const char* number;
    double bound;
    double (*measure)(const Variant&);
};

const Case kCases[] = {
    {"wall of 5 mm", "offsets and texels reach through: light leaks", "brightest dark texel / mean of the lit room",
     0.0, thin_wall},
    {"slivers", "normals of no length, NaN", "worst texel under a plain sky", 1e-3, slivers},
    {"coplanar twins", "surfaces shadow each other: half the light", "worst texel under a sun", 1e-3, coplanar_twins},
    {"lamp 1 mm above the floor", "1 / d^2 overflows", "error ten texels away", 0.02, lamp_near_floor},
    {"lamp inside a wall", "shadow rays start behind the wall", "brightest texel, W/m^2", 0.0, lamp_in_wall},
    {"sun 0.1 degrees high", "offsets turn grazing light into shadow", "worst texel", 0.01, grazing_sun},
    {"white closed room", "the bounces diverge", "worst texel against the clamped series", 1e-3, white_furnace},
    {"emitter of 1 cm", "gather rays miss it: fireflies", "worst texel", 0.02, tiny_emitter},
    {"20,000 emissive triangles", "time, or noise of a poor choice", "worst texel", 0.05, glowing_crowd},
    {"chart inside one texel", "no texel centre is covered: black", "error of the texel", 1e-3, chart_in_a_texel},
    {"edge of a spot's cone", "light outside of it", "brightest texel outside, W/m^2", 0.0, spot_edge},
    {"door flush with its wall", "light leaks around the closed leaf", "brightest closed / mean open", 1e-6,
     flush_door},
    {"20 sets on one texel", "terms get lost or mixed", "worst texel of a set", 0.05, many_sets},
    {"sun in one pixel of the sky", "gather rays miss it: fireflies", "worst texel", 0.03, sun_in_one_pixel},
    {"two identical sets", "one hides the other", "worst texel of a set", 0.05, identical_sets},
    {"receivers inside a leaf, and in its plane", "no side to aim at: 0 / 0", "worst texel of the open state", 0.01,
     inside_a_door},
    {"gap of 1 cm beside a leaf", "leaf seen as its box: no light, or all", "mean light through the gap", 0.1,
     gap_beside_a_door},
    {"no light", "0 / 0", "brightest texel, W/m^2", 0.0, dark_room},
};

struct Row {
    std::map<std::string, double> measured; ///< by variant
};
std::map<std::string, Row> table;

class HardSuite : public testing::TestWithParam<std::tuple<size_t, size_t>> {};

TEST_P(HardSuite, StaysInBounds) {
    const Case& c = kCases[std::get<0>(GetParam())];
    const Variant& v = kVariants[std::get<1>(GetParam())];
    const double measured = c.measure(v);
    table[c.name].measured[v.name] = measured;
    EXPECT_LE(measured, c.bound) << c.name << ", " << v.name << ": " << c.number;
}

INSTANTIATE_TEST_SUITE_P(All, HardSuite,
                         testing::Combine(testing::Range<size_t>(0, std::size(kCases)),
                                          testing::Range<size_t>(0, std::size(kVariants))));

/// Writes what was measured, if asked to.
class TableWriter : public testing::Environment {
    void TearDown() override {
        const char* path = std::getenv("AJAR_HARD_TABLE");
        std::FILE* file = path != nullptr ? std::fopen(path, "w") : nullptr;
        if (file == nullptr) return;
        std::fprintf(file, "| case | what breaks naive bakers | number | bound |");
        for (const Variant& v : kVariants) std::fprintf(file, " %s |", v.name);
        std::fprintf(file, "\n|---|---|---|---|");
        for (size_t i = 0; i < std::size(kVariants); ++i) std::fprintf(file, "---|");
        for (const Case& c : kCases) {
            std::fprintf(file, "\n| %s | %s | %s | %g |", c.name, c.trap, c.number, c.bound);
            for (const Variant& v : kVariants) std::fprintf(file, " %.2g |", table[c.name].measured[v.name]);
        }
        std::fprintf(file, "\n");
        std::fclose(file);
    }
};
[[maybe_unused]] const testing::Environment* const kWriter = testing::AddGlobalTestEnvironment(new TableWriter);

} // namespace
