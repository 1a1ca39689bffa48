// SPDX-License-Identifier: GPL-3.0-or-later
#include "golden_scenes.h"

#include <cmath>
#include <stdexcept>

namespace golden {

namespace {

using kit::Float2;
using kit::Float3;

constexpr float kWhite[3] = {0.73f, 0.71f, 0.68f};

Float3 white() { return {kWhite[0], kWhite[1], kWhite[2]}; }

ajar_settings base_settings(uint32_t bounces, uint32_t samples, uint32_t bounce_samples, uint32_t direct_samples) {
    ajar_settings s = kit::settings(bounces, samples);
    s.bounce_samples = bounce_samples;
    s.direct_samples = direct_samples;
    s.positions_per_texel = 4;
    s.term_threshold = 0.0f; // all that is baked is kept: sums have no cut-off
    return s;
}

/// Cell of a grid over the unit square, one texel narrower on each side on a page of that many texels.
struct Cell {
    Float2 low, high;
    Cell(int column, int row, int columns, int rows, uint32_t edge) {
        const float gap = 1.0f / static_cast<float>(edge);
        low = {(static_cast<float>(column) + gap) / static_cast<float>(columns),
               (static_cast<float>(row) + gap) / static_cast<float>(rows)};
        high = {(static_cast<float>(column + 1) - gap) / static_cast<float>(columns),
                (static_cast<float>(row + 1) - gap) / static_cast<float>(rows)};
    }
};

/// Where a lamp stands, shining down (its -Z), turned by an angle around X.
std::array<double, 12> placed(double x, double y, double z, double turn = 0.0) {
    const double c = std::cos(turn), s = std::sin(turn);
    return {1, 0, 0, x, 0, c, -s, y, 0, s, c, z};
}

ajar_light_desc lamp(uint32_t type, float energy, Float3 color) {
    ajar_light_desc d;
    ajar_light_desc_init(&d);
    d.name = "lamp";
    d.type = type;
    d.role = AJAR_ROLE_STATIC;
    d.energy = energy;
    for (int i = 0; i < 3; ++i) d.color[i] = color[i];
    return d;
}

/// Red and green walls, two blocks, an area light: direct light and four bounces, fixed rays.
void fill_cornell(GoldenScene& g) {
    kit::Scene& scene = g.scene;
    const Float3 p[8] = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {2, 2, 2}, {0, 2, 2}};
    const int faces[5][4] = {{0, 1, 2, 3}, {4, 7, 6, 5}, {2, 6, 7, 3}, {3, 7, 4, 0}, {1, 5, 6, 2}};
    const Float3 colors[5] = {white(), white(), white(), {0.63f, 0.065f, 0.05f}, {0.14f, 0.45f, 0.091f}};
    const uint32_t page = g.page(48, 32);
    for (int f = 0; f < 5; ++f) {
        const Cell cell(f % 3, f / 3, 3, 2, 16);
        const int* q = faces[f];
        kit::MeshData wall;
        wall.quad(p[q[0]], p[q[1]], p[q[2]], p[q[3]], cell.low, cell.high);
        scene.instance(scene.mesh(wall), scene.diffuse(colors[f]), page, "wall");
    }
    g.slab({0.3f, 0.9f, 0}, {0.9f, 1.5f, 1.2f}, scene.diffuse(white()), 8);
    g.slab({1.1f, 0.4f, 0}, {1.7f, 1.0f, 0.6f}, scene.diffuse(white()), 8);
    ajar_light_desc d = lamp(AJAR_LIGHT_AREA_RECTANGLE, 20.0f, {1.0f, 0.8f, 0.5f});
    d.size_x = 0.5f;
    d.size_y = 0.4f;
    scene.light(d, placed(1, 1, 1.98).data());
    g.tested = base_settings(4, 256, 64, 16);
    g.fine = base_settings(4, 2048, 256, 64);
}

/// Smooth equirectangular sky, brighter towards one side and the zenith.
void set_sky(kit::Scene& scene) {
    constexpr uint32_t kWidth = 32, kHeight = 16;
    std::vector<float> texels;
    for (uint32_t y = 0; y < kHeight; ++y)
        for (uint32_t x = 0; x < kWidth; ++x) {
            const float up = (static_cast<float>(y) + 0.5f) / kHeight, a = (static_cast<float>(x) + 0.5f) / kWidth;
            const float glow = 3.0f * std::exp(-40.0f * (a - 0.3f) * (a - 0.3f) - 30.0f * (up - 0.6f) * (up - 0.6f));
            texels.insert(texels.end(), {0.2f + glow, 0.3f + 0.2f * up + glow, 0.5f + 0.5f * up + 0.6f * glow, 1.0f});
        }
    ajar_sky_desc sky;
    ajar_sky_desc_init(&sky);
    sky.type = AJAR_SKY_EQUIRECT;
    sky.texture = scene.texture(texels, kWidth, kHeight);
    kit::check(ajar_scene_set_sky(scene.handle(), &sky));
}

/// Room of slabs with a window to a sky with a sun, a block and a glowing strip. Slabs reach into each other and are
/// thick: where faces coincide, or a texel is half in the room and half outside, it depends on the rounding of the
/// ray tracer which side the texel shows, and so on the processor.
void fill_window(GoldenScene& g) {
    kit::Scene& scene = g.scene;
    const uint32_t pale = scene.diffuse({0.7f, 0.65f, 0.6f}), wood = scene.diffuse({0.4f, 0.25f, 0.12f});
    g.slab({-2.3f, -1.6f, -0.6f}, {2.3f, 1.6f, 0}, wood, 16);       // floor
    g.slab({-2.3f, -1.6f, 2.4f}, {2.3f, 1.6f, 3.0f}, pale, 8);      // ceiling
    g.slab({-2.6f, -1.65f, -0.3f}, {-2, 1.65f, 2.7f}, pale, 8);     // walls
    g.slab({2, -1.65f, -0.3f}, {2.6f, 1.65f, 2.7f}, pale, 8);       //
    g.slab({-2.4f, 1.5f, -0.4f}, {2.4f, 2.1f, 2.8f}, pale, 8);      //
    g.slab({-2.4f, -1.7f, -0.4f}, {2.4f, -1.5f, 0.9f}, pale, 8);    // around the window
    g.slab({-2.4f, -1.7f, 2.0f}, {2.4f, -1.5f, 2.8f}, pale, 8);     //
    g.slab({-2.35f, -1.68f, 0.7f}, {-0.8f, -1.52f, 2.2f}, pale, 8); //
    g.slab({0.8f, -1.68f, 0.7f}, {2.35f, -1.52f, 2.2f}, pale, 8);   //
    g.slab({-1.7f, 0.5f, -0.2f}, {-1.2f, 1.0f, 0.5f}, pale, 8);     // a block beside the patch of sun
    kit::MeshData strip;
    strip.quad({-1.99f, -0.5f, 1.5f}, {-1.99f, 0.5f, 1.5f}, {-1.99f, 0.5f, 1.6f}, {-1.99f, -0.5f, 1.6f}, {0, 0},
               {1, 1});
    scene.instance(scene.mesh(strip), scene.emitter({3, 1, 0.5f}), AJAR_NONE, "strip");
    set_sky(scene);
    ajar_light_desc sun = lamp(AJAR_LIGHT_SUN, 4.0f, {1.0f, 0.9f, 0.7f});
    sun.sun_angle = 0.02f;
    scene.light(sun, placed(0, 0, 0, 0.9).data());
    g.noise_factor = 1.4; // the sun through a window is found by few rays: variance itself varies by a tenth
    g.tested = base_settings(4, 256, 64, 16);
    g.fine = base_settings(4, 2048, 256, 64);
}

void lights_of_rooms(GoldenScene& g) {
    kit::Scene& scene = g.scene;
    scene.current_set = g.element(AJAR_ELEMENT_LIGHT_SET, "left");
    scene.point_light({-1.5f, 0.3f, 2.1f}, 60.0f, 0.05f);
    scene.current_set = g.element(AJAR_ELEMENT_LIGHT_SET, "right");
    ajar_light_desc spot = lamp(AJAR_LIGHT_SPOT, 80.0f, {0.6f, 0.8f, 1.0f});
    spot.radius = 0.05f;
    spot.spot_angle = 1.6f;
    spot.spot_blend = 0.3f;
    scene.light(spot, placed(1.3, 0.2, 2.3).data());
    kit::MeshData sign;
    sign.quad({2.99f, -0.5f, 1}, {2.99f, -0.5f, 1.4f}, {2.99f, 0.5f, 1.4f}, {2.99f, 0.5f, 1}, {0, 0}, {1, 1});
    scene.instance(scene.mesh(sign), scene.emitter({6, 1, 4}), AJAR_NONE, "sign");
    scene.current_set = AJAR_NONE;
    scene.point_light({-2.5f, 0.1f, 0.6f}, 25.0f, 0.05f, true); // always on, its direct light left to the game
}

/// Two rooms joined by a door, a light set in each, a crate that can be hidden: the base and all terms.
void fill_elements(GoldenScene& g) {
    kit::Scene& scene = g.scene;
    const uint32_t pale = scene.diffuse({0.7f, 0.65f, 0.6f});
    lights_of_rooms(g);
    const uint32_t door = g.element(AJAR_ELEMENT_DOOR, "door"), crate = g.element(AJAR_ELEMENT_TOGGLE, "crate");
    scene.instance(scene.mesh(kit::box({-3, -1.5f, 0}, {3, 1.5f, 2.4f}, true, 1.0f / 48.0f)), pale, g.page(48, 32),
                   "rooms");
    g.slab({-0.1f, -1.6f, -0.1f}, {0.1f, -0.5f, 2.5f}, pale, 8);
    g.slab({-0.1f, 0.5f, -0.1f}, {0.1f, 1.6f, 2.5f}, pale, 8);
    g.slab({-0.1f, -0.5f, 1.9f}, {0.1f, 0.5f, 2.5f}, pale, 8);
    scene.current_switch = door;
    g.slab({-0.05f, -0.48f, 0.02f}, {0.05f, 0.48f, 1.88f}, scene.diffuse({0.7f, 0.2f, 0.1f}), 8);
    scene.current_switch = crate;
    g.slab({1.2f, -0.6f, -0.02f}, {1.9f, 0.1f, 0.8f}, scene.diffuse({0.2f, 0.6f, 0.2f}), 8);
    scene.current_switch = AJAR_NONE;
    g.tested = base_settings(3, 64, 32, 16);
    g.fine = base_settings(3, 512, 128, 64);
    g.tested.combinations = g.fine.combinations = AJAR_COMBINATIONS_ALL;
    g.block = 16;
}

struct Entry {
    const char* name;
    void (*fill)(GoldenScene&);
};
constexpr Entry kScenes[] = {{"cornell", fill_cornell}, {"window", fill_window}, {"elements", fill_elements}};

} // namespace

uint32_t GoldenScene::page(uint32_t width, uint32_t height) {
    pages.push_back({width, height});
    return scene.page(width, height);
}

uint32_t GoldenScene::element(uint32_t kind, const char* element_name) {
    ajar_element_desc d;
    ajar_element_desc_init(&d);
    d.name = element_name;
    d.kind = kind;
    elements.push_back(d);
    return scene.element(kind, element_name);
}

std::vector<std::vector<uint32_t>> GoldenScene::products() const {
    std::vector<std::vector<uint32_t>> out;
    for (uint32_t mask = 0; mask < 1u << elements.size(); ++mask) {
        std::vector<uint32_t> product;
        uint32_t sets = 0;
        for (uint32_t e = 0; e < elements.size(); ++e) {
            if ((mask >> e & 1) == 0) continue;
            product.push_back(e);
            sets += elements[e].kind == AJAR_ELEMENT_LIGHT_SET;
        }
        if (sets <= 1) out.push_back(std::move(product));
    }
    return out;
}

void GoldenScene::slab(Float3 low, Float3 high, uint32_t material, uint32_t cell) {
    const float margin = 0.5f / static_cast<float>(3 * cell);
    scene.instance(scene.mesh(kit::box(low, high, false, margin)), material, page(3 * cell, 2 * cell), "slab");
}

const std::vector<std::string>& scene_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const Entry& e : kScenes) all.emplace_back(e.name);
        return all;
    }();
    return names;
}

std::unique_ptr<GoldenScene> make_scene(const std::string& name) {
    for (const Entry& e : kScenes)
        if (name == e.name) {
            auto g = std::make_unique<GoldenScene>(e.name);
            e.fill(*g);
            g->scene.commit();
            return g;
        }
    throw std::runtime_error("no golden scene " + name);
}

} // namespace golden
