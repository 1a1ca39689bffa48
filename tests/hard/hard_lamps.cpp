// SPDX-License-Identifier: GPL-3.0-or-later
// Lamps and skies that sampling misses or that overflow.
#include "hard_case.h"

namespace hard {
namespace {

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
    kit::MeshData panels;
    constexpr int kEdge = 100;
    for (int i = 0; i < kEdge; ++i)
        for (int j = 0; j < kEdge; ++j) {
            const float x = -1.0f + 0.02f * float(i), y = -1.0f + 0.02f * float(j);
            panels.quad({x, y, 1}, {x, y + 0.02f, 1}, {x + 0.02f, y + 0.02f, 1}, {x + 0.02f, y, 1}, {0, 0}, {1, 1});
        }
    s.object(panels, s.emitter({1, 1, 1}));
    s.object(kit::plane(8.0f, -5.0f), s.scene.diffuse({0, 0, 0})); // or the ceiling would be most of the scene
    s.scene.commit();
    return worst(s.irradiance(kit::Bake(s.scene, s.settings(0, 1024)), page),
                 [](uint32_t x, uint32_t y) { return from_rectangle(-1, 1, -1, 1, 1, texel(x, y, 8, 0.5f)); });
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

const Case kCases[] = {
    {"lamps", Origin::kBase, "lamp 1 mm above the floor", "1 / d^2 overflows", "error ten texels away", 0.02,
     lamp_near_floor},
    {"lamps", Origin::kBase, "lamp inside a wall", "shadow rays start behind the wall", "brightest texel, W/m^2", 0.0,
     lamp_in_wall},
    {"lamps", Origin::kBase, "sun 0.1 degrees high", "offsets turn grazing light into shadow", "worst texel", 0.01,
     grazing_sun},
    {"lamps", Origin::kBase, "emitter of 1 cm", "gather rays miss it: fireflies", "worst texel", 0.02, tiny_emitter},
    {"lamps", Origin::kBase, "20,000 emissive triangles", "time, or noise of a poor choice", "worst texel", 0.05,
     glowing_crowd},
    {"lamps", Origin::kBase, "edge of a spot's cone", "light outside of it", "brightest texel outside, W/m^2", 0.0,
     spot_edge},
    {"lamps", Origin::kBase, "sun in one pixel of the sky", "gather rays miss it: fireflies", "worst texel", 0.03,
     sun_in_one_pixel},
};

} // namespace

std::span<const Case> lamp_cases() { return kCases; }

} // namespace hard
