// SPDX-License-Identifier: GPL-3.0-or-later
// Which side of a surface is lit: rooms of sheets, crates on floors, cards whose normals lean.
#include <string>

#include "hard_case.h"

namespace hard {
namespace {

/// A card of 1 m in the plane y = 0 that faces -y, its normals turned up by an angle.
kit::MeshData card(double angle) {
    kit::MeshData m;
    m.quad({-0.5f, 0, 0}, {0.5f, 0, 0}, {0.5f, 0, 1}, {-0.5f, 0, 1}, {0, 0}, {1, 1});
    m.normals.assign(6, {0.0f, static_cast<float>(-std::cos(angle)), static_cast<float>(std::sin(angle))});
    return m;
}

/// Under an even sky, the part of the sky that both the card and its normal see: pi (1 + cos) / 2.
double leaning_cards(const Variant& v) {
    double most = 0.0;
    for (const double degrees : {5.0, 30.0, 85.0, 90.0}) {
        Stage s(v);
        const double angle = degrees / 180.0 * pi;
        const uint32_t page = s.object(card(angle), s.scene.diffuse({0.9f, 0.9f, 0.9f}), 4);
        s.sky(1.0);
        s.scene.commit();
        const Layer e = s.irradiance(kit::Bake(s.scene, s.settings(2, 1024)), page);
        most = std::max(most, off(mean(e), 0.5 * pi * (1.0 + std::cos(angle))));
    }
    return most;
}

/// A sun in front lights by the normal's cosine; one behind the card does not, though the normals face it.
double leaning_cards_in_the_sun(const Variant& v) {
    double most = 0.0;
    for (const double angle : {0.1, 0.8, 1.5})
        for (const bool front : {true, false}) {
            Stage s(v);
            const uint32_t page = s.object(card(angle), s.black(), 4);
            // From above, 0.2 rad before or behind the card's plane.
            const double y = front ? -std::sin(0.2) : std::sin(0.2), z = std::cos(0.2);
            s.light(Stage::lamp(AJAR_LIGHT_SUN, 2.0), {0, 0, 9}, {1, 0, 0, 0, z, y, 0, -y, z});
            s.scene.commit();
            const Layer e = s.irradiance(kit::Bake(s.scene, s.settings(0, 16)), page);
            const double expected = 2.0 * (-std::cos(angle) * y + std::sin(angle) * z);
            most = std::max(most, front ? worst(e, expected) : largest(e));
        }
    return most;
}

void flip(kit::MeshData& m) {
    for (size_t t = 0; t < m.corners.size(); t += 3)
        std::swap(m.corners[t + 1], m.corners[t + 2]), std::swap(m.uv[t + 1], m.uv[t + 2]);
}

/// A closed room of sheets in the brightest light outside, a toggle and a set in it.
double closed_room(const Variant& v) {
    Stage s(v);
    const uint32_t grey = s.scene.diffuse({0.6f, 0.6f, 0.6f});
    const uint32_t page = s.object(kit::box({-2, -2, 0}, {2, 2, 3}, true), grey, 24, "room");
    const uint32_t ground = s.object(kit::plane(14.0f, -0.5f), grey, 8, "ground");
    s.toggle("crate"), s.object(kit::box({-1, -1, 0}, {0, 0, 1}, false), grey);
    s.release();
    s.set("outside"), s.point({4, 0, 1}, 1e4);
    s.release();
    s.sky(1.0), s.sun(0.7, 1000.0);
    s.scene.commit();
    const kit::Bake bake(s.scene, s.settings(2, 64));
    if (mean(s.state(bake, {1, 1}, 8, ground)) < 100.0) return HUGE_VAL;
    return std::max(largest(s.state(bake, {0, 1}, 24, page)), largest(s.state(bake, {1, 1}, 24, page)));
}

/// A tent of four triangles over a floor, normals in.
double closed_tent(const Variant& v) {
    Stage s(v);
    const uint32_t grey = s.scene.diffuse({0.6f, 0.6f, 0.6f});
    const Float3 corners[] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, top = {0.2f, 0.1f, 1.5f};
    kit::MeshData tent;
    for (int i = 0; i < 4; ++i) {
        const auto base = static_cast<uint32_t>(tent.positions.size());
        tent.positions.insert(tent.positions.end(), {corners[(i + 1) % 4], corners[i], top});
        tent.corners.insert(tent.corners.end(), {base, base + 1, base + 2});
        const float u = 0.5f * static_cast<float>(i % 2), w = 0.5f * static_cast<float>(i / 2);
        tent.uv.insert(tent.uv.end(), {{u + 0.05f, w + 0.05f}, {u + 0.45f, w + 0.05f}, {u + 0.05f, w + 0.45f}});
    }
    const uint32_t sides = s.object(tent, grey, 16, "tent"),
                   floor = s.object(kit::plane(2.0f, 0.0f), grey, 16, "floor");
    s.sky(100.0);
    s.scene.commit();
    const kit::Bake bake(s.scene, s.settings(2, 128));
    return std::max(largest(s.irradiance(bake, sides)), largest(s.irradiance(bake, floor)));
}

/// A dark box of sheets hangs in a lit room.
double box_in_a_room(const Variant& v) {
    Stage s(v);
    const uint32_t grey = s.scene.diffuse({0.6f, 0.6f, 0.6f});
    const uint32_t lit = s.object(kit::box({-2, -2, 0}, {2, 2, 3}, true), grey, 24, "room");
    const uint32_t dark = s.object(kit::box({-0.5f, -0.5f, 1}, {0.5f, 0.5f, 2}, true), grey, 24, "box");
    s.point({1.5f, 1, 2}, 1000.0);
    s.scene.commit();
    const kit::Bake bake(s.scene, s.settings(3, 64));
    return mean(s.irradiance(bake, lit)) > 1.0 ? largest(s.irradiance(bake, dark)) : HUGE_VAL;
}

/// A room of black sheets with a window in the wall x = 2: what the floor sees of the sky through it.
double window(const Variant& v, bool inward) {
    Stage s(v);
    kit::MeshData room = kit::box({-2, -2, 0}, {2, 2, 3}, true);
    room.corners.erase(room.corners.begin() + 18, room.corners.begin() + 24);
    room.uv.erase(room.uv.begin() + 18, room.uv.begin() + 24);
    const auto wall = [&](float y0, float z0, float y1, float z1) {
        room.quad({2, y1, z0}, {2, y0, z0}, {2, y0, z1}, {2, y1, z1}, {0, 0}, {1, 1});
    };
    wall(-2, 0, -1, 3), wall(1, 0, 2, 3), wall(-1, 0, 1, 0.5f), wall(-1, 2.5f, 1, 3);
    if (!inward) flip(room);
    s.object(room, s.black(), 0, "room");
    const uint32_t page = s.object(kit::plane(1.0f, 0.001f), s.black(), 4, "floor");
    s.sky(1.0);
    s.scene.commit();
    double expected = 0.0;
    constexpr uint32_t kCuts = 32;
    for (uint32_t i = 0; i < 16 * kCuts * kCuts; ++i) {
        const Float3 p = texel(i % 4, i / 4 % 4, 4, 1.0f);
        const double y = 2.0 * (i / 16 % kCuts + 0.5) / kCuts - 1.0, z = 2.0 * (i / 16 / kCuts + 0.5) / kCuts + 0.5;
        const double dx = 2.0 - p[0], dy = y - p[1], d2 = dx * dx + dy * dy + z * z;
        expected += 4.0 * dx * z / (d2 * d2) / (16.0 * kCuts * kCuts);
    }
    return off(mean(s.irradiance(kit::Bake(s.scene, s.settings(1, 4096)), page)), expected);
}
double windows(const Variant& v) { return std::max(window(v, true), window(v, false)); }

/// A lamp in a box whose normals point out, over a floor in it.
double lamp_in_outward_box(const Variant& v) {
    Stage s(v);
    s.object(kit::box({-1, -1, -0.01f}, {1, 1, 2.1f}, false), s.black());
    const uint32_t page = s.object(kit::plane(0.2f, 0.0f), s.black(), 4);
    s.point({0, 0, 2}, 100.0);
    s.sky(1.0);
    s.scene.commit();
    return worst(s.irradiance(kit::Bake(s.scene, s.settings(1, 64)), page), [](uint32_t x, uint32_t y) {
        return from_point({0, 0, 2}, 100.0, texel(x, y, 4, 0.2f));
    });
}

/// The top of a crate that glows, on the ground under sky and lamp: it sees nothing but these.
double crate_top(const Variant& v, bool door, float gap) {
    Stage s(v);
    const uint32_t glow = s.emitter({1, 1, 1}, 0.5f);
    s.object(kit::plane(8.0f, 0.0f), s.scene.diffuse({0.5f, 0.5f, 0.5f}), 8, "ground");
    door ? s.door("crate", 0.0f) : s.toggle("crate");
    const uint32_t page = s.object(kit::box({-0.4f, -0.4f, gap}, {0.4f, 0.4f, gap + 0.8f}, false), glow, 24, "crate");
    s.release();
    s.point({0, 0, 2.8f + gap}, 100.0);
    s.sky(1.0);
    s.scene.commit();
    const Layer e = s.state(kit::Bake(s.scene, s.settings(2, 128)), {door ? 0.0f : 1.0f}, 24, page);
    double most = 0.0; // the second face's texels, away from its rim
    for (uint32_t y = 3; y < 9; ++y)
        for (uint32_t x = 11; x < 13; ++x) {
            const Float3 p = {0.8f * (float(y) - 5.5f) / 11.0f, 0.8f * (float(x) - 11.5f) / 7.0f, 0};
            most = std::max(most, off(e.at(x, y), pi + from_point({0, 0, 2}, 100.0, p)));
        }
    return most;
}
double glowing_crates(const Variant& v) {
    double most = 0.0;
    for (const bool door : {false, true})
        for (const float gap : {0.0f, 0.001f, -0.01f}) most = std::max(most, crate_top(v, door, gap));
    return most;
}

/// The top of a crate that stands on another, both toggles, base on top in one plane: the sky alone.
double crate_on_a_crate(const Variant& v) {
    Stage s(v);
    const uint32_t grey = s.scene.diffuse({0.5f, 0.5f, 0.5f});
    s.object(kit::plane(8.0f, 0.0f), grey, 8, "ground");
    s.toggle("lower");
    const uint32_t lower = s.object(kit::box({-0.5f, -0.5f, 0}, {0.5f, 0.5f, 1}, false), grey, 24, "lower");
    s.toggle("upper");
    const uint32_t upper = s.object(kit::box({-0.5f, -0.5f, 1}, {0.5f, 0.5f, 2}, false), grey, 24, "upper");
    s.release();
    s.sky(1.0);
    s.scene.commit();
    const kit::Bake bake(s.scene, s.settings(2, 128));
    const Layer top = s.state(bake, {1, 1}, 24, upper), freed = s.state(bake, {1, 0}, 24, lower);
    double most = 0.0;
    for (uint32_t y = 3; y < 9; ++y)
        for (uint32_t x = 11; x < 13; ++x) most = std::max({most, off(top.at(x, y), pi), off(freed.at(x, y), pi)});
    return most;
}

constexpr const char* kTurned = "the brighter side is taken for the right one";
constexpr const char* kBrightest = "brightest texel, W/m^2";

const Case kCases[] = {
    {"sides", Origin::kReport, "cards whose normals lean by 5 to 90 degrees, even sky", "light from below the surface",
     "mean of the worst", 0.005, leaning_cards},
    {"sides", Origin::kReport, "closed room of sheets in bright light", kTurned, kBrightest, 0.0, closed_room},
    {"sides", Origin::kReport, "room of sheets with a window, normals in and out", kTurned, "mean of the worst", 0.03,
     windows},
    {"sides", Origin::kReport, "crates that glow, on, in and above the ground", kTurned, "worst texel of a top", 0.02,
     glowing_crates},
    {"sides", Origin::kSibling, "leaning cards in the sun, before and behind them", "light from below the surface",
     "worst texel", 0.005, leaning_cards_in_the_sun},
    {"sides", Origin::kSibling, "closed tent on a floor of its own", kTurned, kBrightest, 0.0, closed_tent},
    {"sides", Origin::kSibling, "dark box of sheets in a lit room", kTurned, kBrightest, 0.0, box_in_a_room},
    {"sides", Origin::kSibling, "lamp in a box whose normals point out", kTurned, "worst texel", 0.005,
     lamp_in_outward_box},
    {"sides", Origin::kSibling, "crate on a crate, both toggles", "faces in one plane shadow each other",
     "worst texel of a top", 0.01, crate_on_a_crate},
};

} // namespace

std::span<const Case> side_cases() { return kCases; }

} // namespace hard
