// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench_room.h"

#include <cmath>
#include <numbers>
#include <random>

namespace bench {

namespace {

using kit::Float2;
using kit::Float3;

constexpr Float3 kLow{-8, -5, 0}, kHigh{8, 5, 4};
constexpr int kBoxes = 120, kBalls = 40, kBallRings = 16;
constexpr uint32_t kRoomPage = 128, kPropPage = 16;

/// Point of a unit sphere by latitude and longitude, as shares of the whole.
Float3 on_sphere(float ring, float segment) {
    const float theta = ring * std::numbers::pi_v<float>, phi = segment * 2.0f * std::numbers::pi_v<float>;
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), -std::cos(theta)};
}

/// Smooth unit ball; one chart.
kit::MeshData ball() {
    kit::MeshData mesh;
    const float step = 1.0f / kBallRings, margin = 0.04f, size = 1.0f - 2.0f * margin;
    for (int ring = 0; ring < kBallRings; ++ring)
        for (int segment = 0; segment < kBallRings; ++segment) {
            const float x = segment * step, y = ring * step;
            const Float3 corner[4] = {on_sphere(y, x), on_sphere(y, x + step), on_sphere(y + step, x + step),
                                      on_sphere(y + step, x)};
            mesh.quad(corner[0], corner[1], corner[2], corner[3], {margin + x * size, margin + y * size},
                      {margin + (x + step) * size, margin + (y + step) * size});
            for (const int i : {0, 1, 2, 0, 2, 3}) mesh.normals.push_back(corner[i]);
        }
    return mesh;
}

/// Uniform numbers that are the same with every standard library.
class Random {
public:
    float operator()(float low, float high) {
        return low + (high - low) * static_cast<float>(engine_() >> 8) * 0x1p-24f;
    }

private:
    std::mt19937 engine_{1};
};

std::array<double, 12> placed(Float3 p, float size, float turn) {
    const double c = size * std::cos(turn), s = size * std::sin(turn);
    return {c, -s, 0, p[0], s, c, 0, p[1], 0, 0, size, p[2]};
}

void add_props(kit::Scene& scene, uint32_t mesh, int count, Float2 sizes, Random& random) {
    for (int i = 0; i < count; ++i) {
        const uint32_t paint = scene.diffuse({random(0.2f, 0.8f), random(0.2f, 0.8f), random(0.2f, 0.8f)});
        const float size = random(sizes[0], sizes[1]);
        const Float3 p{random(kLow[0] + 1, kHigh[0] - 1), random(kLow[1] + 1, kHigh[1] - 1), random(0.0f, 3.0f)};
        scene.instance(mesh, paint, scene.page(kPropPage, kPropPage), "prop",
                       placed(p, size, random(0.0f, 6.0f)).data());
    }
}

} // namespace

void fill_room(kit::Scene& scene, int lamps) {
    Random random;
    const uint32_t walls = scene.diffuse({0.7f, 0.65f, 0.6f});
    scene.instance(scene.mesh(kit::box(kLow, kHigh, true)), walls, scene.page(kRoomPage, kRoomPage), "room");
    scene.instance(scene.mesh(kit::plane(1.5f, kHigh[2] - 0.01f, false)), scene.emitter({4, 4, 5}), AJAR_NONE, "panel");
    add_props(scene, scene.mesh(kit::box({-0.5f, -0.5f, 0.0f}, {0.5f, 0.5f, 1.0f}, false)), kBoxes, {0.2f, 1.0f},
              random);
    add_props(scene, scene.mesh(ball()), kBalls, {0.15f, 0.5f}, random);
    for (int i = 0; i < lamps; ++i)
        scene.point_light({random(kLow[0], kHigh[0]), random(kLow[1], kHigh[1]), random(2.5f, 3.9f)},
                          random(5.0f, 40.0f), 0.05f);
    scene.commit();
}

} // namespace bench
