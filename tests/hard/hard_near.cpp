// SPDX-License-Identifier: GPL-3.0-or-later
// Lamps and emitters close to a floor, and beams narrower than a texel: all the light that is sent down arrives.
#include <array>

#include "hard_case.h"

namespace hard {
namespace {

/// Flux on a black floor of 4 m^2 under a lamp; texels are coarser than its light.
double flux(const Variant& v, const ajar_light_desc& lamp, float height,
            const std::array<double, 9>& axes = kit::kUpright) {
    Stage s(v);
    const uint32_t page = s.object(kit::plane(2.0f, 0.0f), s.black(), 32);
    s.light(lamp, {0.137f, -0.211f, height}, axes);
    s.scene.commit();
    ajar_settings settings = s.settings(0, 64);
    settings.direct_samples = 256;
    return mean(s.irradiance(kit::Bake(s.scene, settings), page)) * 4.0;
}

ajar_light_desc area(uint32_t type, float size, float spread) {
    ajar_light_desc d = Stage::lamp(type, 100.0);
    d.size_x = d.size_y = size;
    d.spread = spread;
    return d;
}

constexpr auto kPi = static_cast<float>(pi);
/// Blender's area lamps send pi / 4 of their watts, whatever the spread.
constexpr double kSent = 25.0 * pi;

double narrow_beams(const Variant& v) {
    double most = 0.0;
    for (const float spread : {0.3f, 0.03f, 0.0f})
        most = std::max(most, off(flux(v, area(AJAR_LIGHT_AREA_RECTANGLE, 0.2f, spread), 1.0f), kSent));
    return most;
}

double round_beams(const Variant& v) {
    double most = 0.0;
    for (const float spread : {0.2f, 0.02f})
        most = std::max(most, off(flux(v, area(AJAR_LIGHT_AREA_ELLIPSE, 0.1f, spread), 0.5f), kSent));
    return most;
}

/// Turned by 45 degrees about y: the beam meets the floor half a metre beside its lamp.
double slanted_beam(const Variant& v) {
    const double c = std::sqrt(0.5);
    return off(flux(v, area(AJAR_LIGHT_AREA_RECTANGLE, 0.1f, 0.05f), 0.5f, {c, 0, c, 0, 1, 0, -c, 0, c}), kSent);
}

double small_area_lamps(const Variant& v) {
    double most = 0.0;
    for (const float height : {0.01f, 0.001f})
        most = std::max(most, off(flux(v, area(AJAR_LIGHT_AREA_RECTANGLE, 0.01f, kPi), height), kSent));
    return most;
}

/// Flux that the floor gets from a point lamp of 100 W at a height: half of its light goes down, and what passes the
/// floor's edges at 3 cm is 1 %.
double flux_from_point(double height) {
    double flux = 0.0;
    constexpr uint32_t kCuts = 1000;
    for (uint32_t i = 0; i < kCuts; ++i) { // the rest of the half space, seen around the edge
        const double a = 2.0 * pi * (i + 0.5) / kCuts, c = std::cos(a), d = std::sin(a);
        const double reach =
            std::min((c > 0 ? 1 - 0.137 : 1.137) / std::abs(c), (d > 0 ? 1.211 : 1 - 0.211) / std::abs(d));
        flux += 50.0 / kCuts * (1.0 - height / std::hypot(reach, height));
    }
    return flux;
}

double low_points(const Variant& v) {
    double most = 0.0;
    for (const float height : {0.03f, 0.01f})
        most = std::max(most, off(flux(v, Stage::lamp(AJAR_LIGHT_POINT, 100.0), height), flux_from_point(height)));
    return most;
}

/// Blender's spots fall off by the cosine from their axis.
double low_spot(const Variant& v) {
    ajar_light_desc d = Stage::lamp(AJAR_LIGHT_SPOT, 100.0);
    d.spot_angle = 2.0f;
    d.spot_blend = 0.0f;
    return off(flux(v, d, 0.05f), 25.0 * std::pow(std::sin(1.0), 2));
}

/// A chip that glows on both sides, some way above a floor of 10 cm.
double flux_of_chip(const Variant& v, float edge, float height) {
    Stage s(v);
    const uint32_t page = s.object(kit::plane(0.1f, 0.0f), s.black(), 16);
    s.object(kit::plane(edge, height, false), s.emitter({100, 100, 100}));
    s.scene.commit();
    double expected = 0.0;
    for (uint32_t i = 0; i < 16 * 16; ++i)
        expected += 100.0 *
                    from_rectangle(-edge / 2, edge / 2, -edge / 2, edge / 2, height, texel(i % 16, i / 16, 16, 0.1f)) /
                    256.0;
    return off(mean(s.irradiance(kit::Bake(s.scene, s.settings(0, 256)), page)), expected);
}
double small_chip(const Variant& v) { return flux_of_chip(v, 0.01f, 0.02f); }
double tiny_chip(const Variant& v) { return flux_of_chip(v, 0.001f, 0.03f); }

/// A ball of 5 mm that hangs 3 cm above the floor: as long as all of it is above, its light is that of a point.
double ball_lamp(const Variant& v) {
    ajar_light_desc d = Stage::lamp(AJAR_LIGHT_POINT, 100.0);
    d.radius = 0.005f;
    return off(flux(v, d, 0.03f), flux_from_point(0.03));
}

constexpr const char* kCoarse = "the few points of a texel miss the light";

const Case kCases[] = {
    {"near", Origin::kReport, "beams of .3, .03 and 0 rad", "samples of the lamp look past its beam",
     "flux of the worst", 0.03, narrow_beams},
    {"near", Origin::kReport, "area lamps of 1 cm, 1 cm and 1 mm above a floor", kCoarse, "flux of the worst", 0.03,
     small_area_lamps},
    {"near", Origin::kReport, "lamps 3 cm and 1 cm above a floor", kCoarse, "flux of the worst", 0.04, low_points},
    {"near", Origin::kReport, "emitter of 1 cm, 2 cm above a floor", "gather rays miss it: fireflies", "flux", 0.02,
     small_chip},
    {"near", Origin::kSibling, "emitter of 1 mm, 3 cm above a floor", "gather rays miss it: fireflies", "flux", 0.02,
     tiny_chip},
    {"near", Origin::kSibling, "round beams of .2 and .02 rad", "samples of the lamp look past its beam",
     "flux of the worst", 0.03, round_beams},
    {"near", Origin::kSibling, "slanted beam of .05 rad", "samples of the lamp look past its beam", "flux", 0.03,
     slanted_beam},
    {"near", Origin::kSibling, "spot 5 cm above a floor", kCoarse, "flux", 0.04, low_spot},
    {"near", Origin::kSibling, "ball lamp of 5 mm, 3 cm above a floor", kCoarse, "flux", 0.03, ball_lamp},
};

} // namespace

std::span<const Case> near_cases() { return kCases; }

} // namespace hard
