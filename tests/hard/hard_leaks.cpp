// SPDX-License-Identifier: GPL-3.0-or-later
// Rooms that no light gets into, whatever lies in the planes of their walls and however they are put together.
#include <array>

#include "hard_case.h"

namespace hard {
namespace {

/// Walls whose backs reflect nothing, 4 x 4 x 3 m.
struct DarkRoom {
    Stage s;
    uint32_t page;

    explicit DarkRoom(const Variant& v) : s(v) {
        ajar_closure grey;
        ajar_closure_init(&grey);
        page = s.object(kit::box({-2, -2, 0}, {2, 2, 3}, true), s.scene.material({grey}, true), 24, "room");
    }
    /// A square of 1 m parallel to the wall x = -2, some way in front of it.
    void on_wall(float gap, float y, uint32_t material, float edge = 1.0f) {
        const float h = 0.5f * edge, x = gap - 2.0f;
        kit::MeshData m;
        m.quad({x, y - h, 1.5f - h}, {x, y + h, 1.5f - h}, {x, y + h, 1.5f + h}, {x, y - h, 1.5f + h}, {0, 0}, {1, 1});
        s.object(m, material);
    }
    /// Brightest texel under a sky and a sun above.
    double brightest(std::vector<std::vector<float>> states = {}) {
        s.release();
        s.sky(100.0);
        s.sun(1.5, 1000.0);
        s.scene.commit();
        const kit::Bake bake(s.scene, s.settings(1, 64));
        double most = largest(s.irradiance(bake, page));
        for (const std::vector<float>& weights : states)
            most = std::max(most, largest(s.state(bake, weights, 24, page)));
        return most;
    }
};

constexpr std::array<float, 7> kGaps = {0.0f, 1e-7f, 1e-6f, 1e-5f, 1e-4f, 1e-3f, 5e-3f};

double decals_before(const Variant& v) {
    DarkRoom room(v);
    for (size_t i = 0; i < kGaps.size(); ++i)
        room.on_wall(kGaps[i], 0.5f * float(i) - 1.5f, room.s.pane({1, 1, 1}), 0.4f);
    kit::MeshData floor;
    floor.quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {0, 0}, {1, 1});
    room.s.object(floor, room.s.pane({0.5f, 0.5f, 0.5f}, 0.25f));
    return room.brightest();
}

double decals_behind(const Variant& v) {
    DarkRoom room(v);
    for (size_t i = 1; i < kGaps.size(); ++i) {
        room.on_wall(-kGaps[i], 0.5f * float(i) - 1.75f, room.s.pane({1, 1, 1}), 0.4f);
        room.on_wall(-kGaps[i], 0.5f * float(i) - 1.75f, room.s.pane({0.5f, 0.5f, 0.5f}), 0.2f);
    }
    return room.brightest();
}

double piled_decals(const Variant& v) {
    DarkRoom room(v);
    for (int i = 0; i < 5; ++i) room.on_wall(0.0f, 0.1f * float(i), room.s.pane({1, 1, 1}));
    return room.brightest();
}

double decal_past_the_edges(const Variant& v) {
    DarkRoom room(v);
    room.on_wall(0.0f, 0.0f, room.s.pane({1, 1, 1}), 6.0f);
    room.on_wall(1e-6f, 2.0f, room.s.pane({0.5f, 0.5f, 0.5f}), 1.0f);
    return room.brightest();
}

double posters(const Variant& v) {
    DarkRoom room(v);
    const uint32_t grey = room.s.scene.diffuse({0.5f, 0.5f, 0.5f}), glass = room.s.pane({0.9f, 0.9f, 0.9f});
    room.s.toggle("toggle"), room.on_wall(0.0f, -1.5f, grey, 0.8f);
    room.s.toggle("glass toggle"), room.on_wall(0.0f, -0.5f, glass, 0.8f);
    room.s.door("door"), room.on_wall(0.0f, 0.5f, grey, 0.8f);
    room.s.door("glass door"), room.on_wall(0.0f, 1.5f, glass, 0.8f);
    return room.brightest({{0, 0, 0, 0}, {1, 1, 1, 1}, {0, 1, 0, 1}, {0.5f, 0.5f, 0.5f, 0.5f}});
}

/// The light inside six walls that share no vertex, turned so that no coordinate is round.
double loose_panels(const Variant& v) {
    Stage s(v);
    const double a = std::cos(0.7), b = std::sin(0.7), c = std::cos(0.4), d = std::sin(0.4);
    const std::array<double, 9> turned = {a, -b * c, b * d, b, a * c, -a * d, 0, d, c};
    ajar_closure grey;
    ajar_closure_init(&grey);
    const uint32_t material = s.scene.material({grey}, true);
    const kit::MeshData box = kit::box({-2, -2, 0}, {2, 2, 3}, true);
    std::vector<uint32_t> pages;
    for (size_t f = 0; f < 6; ++f) {
        const kit::Float3* p = &box.positions[4 * f];
        kit::MeshData panel;
        panel.quad(p[0], p[1], p[2], p[3], {0, 0}, {1, 1});
        pages.push_back(s.object(panel, material, 8, "panel", turned));
    }
    s.sky(100.0);
    s.scene.commit();
    const kit::Bake bake(s.scene, s.settings(1, 256));
    double most = 0.0;
    for (const uint32_t page : pages) most = std::max(most, largest(s.irradiance(bake, page)));
    return most;
}

/// A wall of strips that stand on an undivided floor, with no vertex where they meet.
double split_wall(const Variant& v) {
    Stage s(v);
    ajar_closure grey;
    ajar_closure_init(&grey);
    const uint32_t material = s.scene.material({grey}, true);
    kit::MeshData floor, walls, strips;
    floor.quad({-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}, {0, 0}, {1, 1});
    const kit::MeshData box = kit::box({-2, -2, 0}, {2, 2, 3}, true);
    for (const size_t f : {1u, 3u, 4u, 5u}) {
        const kit::Float3* p = &box.positions[4 * f];
        walls.quad(p[0], p[1], p[2], p[3], {0, 0}, {1, 1});
    }
    constexpr float kCuts[] = {-2, -1.3717f, -0.1234567f, 0.98765f, 2};
    for (int i = 0; i < 4; ++i)
        strips.quad({kCuts[i], -2, 0}, {kCuts[i], -2, 3}, {kCuts[i + 1], -2, 3}, {kCuts[i + 1], -2, 0}, {0, 0}, {1, 1});
    const uint32_t page = s.object(floor, material, 16);
    s.object(walls, material);
    s.object(strips, material);
    s.sky(100.0);
    s.scene.commit();
    return largest(s.irradiance(kit::Bake(s.scene, s.settings(1, 256)), page));
}

/// The far side of a hall's floor under a partition, lit on the near side.
double partition(const Variant& v) {
    double most = 0.0;
    for (const float half : {0.0005f, 0.05f})
        for (const uint32_t size : {8u, 24u}) {
            Stage s(v);
            const uint32_t grey = s.scene.diffuse({0.5f, 0.5f, 0.5f});
            kit::MeshData floor;
            floor.quad({-4, -2, 0}, {4, -2, 0}, {4, 2, 0}, {-4, 2, 0}, {0, 0}, {1, 1});
            const uint32_t page = s.object(floor, grey, size);
            kit::MeshData shell = kit::box({-4, -2, 0}, {4, 2, 3}, true);
            shell.corners.erase(shell.corners.begin(), shell.corners.begin() + 6);
            shell.uv.erase(shell.uv.begin(), shell.uv.begin() + 6);
            s.object(shell, grey);
            s.object(kit::box({-half, -2, 0}, {half, 2, 3}, false), grey, 12, "partition");
            s.point({-2, 0, 2.5f}, 500.0, 0.05f);
            s.scene.commit();
            const Layer e = s.irradiance(kit::Bake(s.scene, s.settings(1, 64)), page);
            for (uint32_t y = 0; y < size; ++y)
                for (uint32_t x = size / 2 + 1; x < size; ++x) most = std::max<double>(most, e.at(x, y));
        }
    return most;
}

/// Clear sheets on both faces of a wall of 5 mm between a lit room and a dark one.
double thin_wall_with_decals(const Variant& v) {
    Stage s(v);
    const uint32_t white = s.scene.diffuse({0.9f, 0.9f, 0.9f}), clear = s.pane({1, 1, 1});
    s.object(kit::box({0, 0, 0}, {2, 2, 2}, true), white, 12, "lit");
    const uint32_t dark = s.object(kit::box({2.005f, 0, 0}, {4, 2, 2}, true), white, 24, "dark");
    for (const float x : {1.999f, 2.0f, 2.005f, 2.006f}) {
        kit::MeshData m;
        m.quad({x, 0.5f, 0.5f}, {x, 1.5f, 0.5f}, {x, 1.5f, 1.5f}, {x, 0.5f, 1.5f}, {0, 0}, {1, 1});
        s.object(m, clear);
    }
    s.point({1.5f, 1, 1}, 1000, 0.1f);
    s.scene.commit();
    return largest(s.irradiance(kit::Bake(s.scene, s.settings(2, 64)), dark));
}

constexpr const char* kThrough = "rays that pass the decal start behind the wall";
constexpr const char* kBrightest = "brightest texel, W/m^2";

const Case kCases[] = {
    {"leaks", Origin::kReport, "clear decals in a wall's plane and up to 5 mm before it", kThrough, kBrightest, 0.0,
     decals_before},
    {"leaks", Origin::kReport, "toggles and doors in a wall's plane", kThrough, "brightest texel of five states, W/m^2",
     0.0, posters},
    {"leaks", Origin::kReport, "room of six loose walls, turned", "rays slip between edges", kBrightest, 0.0,
     loose_panels},
    {"leaks", Origin::kReport, "wall of strips on an undivided floor", "rays slip between edges", kBrightest, 0.0,
     split_wall},
    {"leaks", Origin::kReport, "floor under partitions of 1 mm and 10 cm", "texels reach through",
     "brightest texel of the dark side, W/m^2", 0.0, partition},
    {"leaks", Origin::kSibling, "decals up to 5 mm behind a wall", kThrough, kBrightest, 0.0, decals_behind},
    {"leaks", Origin::kSibling, "5 clear decals in one plane with a wall", kThrough, kBrightest, 0.0, piled_decals},
    {"leaks", Origin::kSibling, "decal in a wall's plane, past the room's edges", kThrough, kBrightest, 0.0,
     decal_past_the_edges},
    {"leaks", Origin::kSibling, "decals on both faces of a wall of 5 mm", kThrough, kBrightest, 0.0,
     thin_wall_with_decals},
};

} // namespace

std::span<const Case> leak_cases() { return kCases; }

} // namespace hard
