// SPDX-License-Identifier: GPL-3.0-or-later
// Light that few rays meet: it comes through a small hole.
#include "hard_case.h"

namespace hard {
namespace {

constexpr uint32_t kTexels = 32; ///< along the floor
constexpr float kEdge = 4.0f;    ///< of floor and ceiling, m
constexpr float kHeight = 3.0f;  ///< m
constexpr double kLampWatts = 0.5;
constexpr uint32_t kSeeds = 2;

/// What else there is in a room.
enum class Beside { kNothing, kLamp, kDarkSet };

/// A black room under a sky of radiance 1, with a square hole in its ceiling: how far the mean of its floor is off.
double hole(const Variant& v, float edge, Beside beside) {
    Stage s(v);
    const uint32_t page = s.object(kit::plane(kEdge, 0.0f), s.black(), kTexels);
    const float half = kEdge / 2, x0 = 0.37f, x1 = x0 + edge, y0 = -0.61f, y1 = y0 + edge;
    kit::MeshData walls = kit::box({-half, -half, -0.01f}, {half, half, kHeight}, true);
    walls.corners.erase(walls.corners.begin() + 6, walls.corners.begin() + 12); // its ceiling
    walls.uv.erase(walls.uv.begin() + 6, walls.uv.begin() + 12);
    s.object(walls, s.black());
    kit::MeshData ceiling;
    const auto strip = [&](float a, float b, float c, float d) {
        ceiling.quad({a, d, kHeight}, {c, d, kHeight}, {c, b, kHeight}, {a, b, kHeight}, {0, 0}, {1, 1});
    };
    strip(-half, -half, x0, half), strip(x1, -half, half, half), strip(x0, -half, x1, y0), strip(x0, y1, x1, half);
    s.object(ceiling, s.black());
    s.sky(1.0);
    const Float3 lamp = {-1.0f, 0.4f, 2.5f};
    if (beside == Beside::kLamp) s.point(lamp, kLampWatts);
    if (beside == Beside::kDarkSet) s.set("lamp"), s.point(lamp, 1e-6);
    s.scene.commit();
    ajar_settings settings = s.settings(0, 2048);
    settings.noise_target = 0.12f;
    double expected = 0.0;
    for (uint32_t i = 0; i < kTexels * kTexels; ++i) {
        const Float3 p = texel(i % kTexels, i / kTexels, kTexels, kEdge);
        expected += from_rectangle(x0, x1, y0, y1, kHeight, p) / (kTexels * kTexels);
        if (beside == Beside::kLamp) expected += from_point(lamp, kLampWatts, p) / (kTexels * kTexels);
    }
    double baked = 0.0;
    for (settings.seed = 0; settings.seed < kSeeds; ++settings.seed)
        baked += mean(s.irradiance(kit::Bake(s.scene, settings), page)) / kSeeds;
    return off(baked, expected);
}

double hole_of_5_cm(const Variant& v) { return hole(v, 0.05f, Beside::kNothing); }
double hole_of_10_cm(const Variant& v) { return hole(v, 0.1f, Beside::kNothing); }
double hole_of_20_cm(const Variant& v) { return hole(v, 0.2f, Beside::kNothing); }
double hole_and_lamp(const Variant& v) { return hole(v, 0.2f, Beside::kLamp); }
double hole_and_set(const Variant& v) { return hole(v, 0.2f, Beside::kDarkSet); }

// Four standard errors, from the spread of seeds.
const Case kCases[] = {
    {"holes", Origin::kReport, "sky through a hole of 10 cm", "places that missed it get no further rays",
     "mean of the floor", 0.15, hole_of_10_cm},
    {"holes", Origin::kReport, "sky through a hole of 20 cm", "places that missed it get no further rays",
     "mean of the floor", 0.08, hole_of_20_cm},
    {"holes", Origin::kSibling, "sky through a hole of 5 cm", "places that missed it get no further rays",
     "mean of the floor", 0.3, hole_of_5_cm},
    {"holes", Origin::kSibling, "sky through a hole of 20 cm, and a lamp", "places that missed it get no further rays",
     "mean of the floor", 0.13, hole_and_lamp},
    {"holes", Origin::kSibling, "sky through a hole of 20 cm, and a dark set",
     "places that missed it get no further rays", "mean of the floor", 0.15, hole_and_set},
};

} // namespace

std::span<const Case> hole_cases() { return kCases; }

} // namespace hard
