// SPDX-License-Identifier: GPL-3.0-or-later
// Light that is wide, dim, bright or negative, as baked and as stored.
#include <array>

#include "hard_case.h"
#include "stored_light.h"

namespace hard {
namespace {

constexpr uint32_t kSize = 4;

/// Irradiance of a floor under a wide sun of 1 W/m^2: the mean cosine over the disk that the sun is drawn as, whose
/// edge lies at the tangent of half the angle. Blender 3.4's Cycles bakes the same.
double disk(double elevation, double angle) {
    constexpr int kRings = 400, kAngles = 400;
    const double t = std::tan(0.5 * angle), s = std::sin(elevation), c = std::cos(elevation);
    double sum = 0.0;
    for (int i = 0; i < kRings * kAngles; ++i) {
        const double r = t * std::sqrt((i / kAngles + 0.5) / kRings), a = 2.0 * pi * (i % kAngles + 0.5) / kAngles;
        sum += std::max(0.0, s + r * std::cos(a) * c) / std::sqrt(1.0 + r * r) / (kRings * kAngles);
    }
    return sum;
}

double wide_sun(const Variant& v, double elevation, float angle) {
    Stage s(v);
    const uint32_t page = s.object(kit::plane(2.0f, 0.0f), s.black(), kSize);
    ajar_light_desc d = Stage::lamp(AJAR_LIGHT_SUN, 1.0);
    d.sun_angle = angle;
    const double up = std::sin(elevation), along = std::cos(elevation);
    s.light(d, {0, 0, 9}, {up, 0, along, 0, 1, 0, -along, 0, up});
    s.scene.commit();
    ajar_settings settings = s.settings(0, 16);
    settings.direct_samples = 1024;
    return off(mean(s.irradiance(kit::Bake(s.scene, settings), page)), disk(elevation, angle));
}
double wide_suns(const Variant& v) {
    return std::max(
        {wide_sun(v, pi / 2, 0.5f), wide_sun(v, pi / 2, 1.0f), wide_sun(v, pi / 2, 2.0f), wide_sun(v, pi / 2, 3.0f)});
}
double setting_suns(const Variant& v) { return std::max(wide_sun(v, 0.1, 0.5f), wide_sun(v, 0.5, 2.0f)); }

/// A sun above a floor, as baked and as stored.
double sun_of(const Variant& v, double strength) {
    Stage s(v);
    const uint32_t page = s.object(kit::plane(2.0f, 0.0f), s.black(), kSize);
    s.sun(pi / 2, strength);
    s.scene.commit();
    const kit::Bake bake(s.scene, s.settings(0, 16));
    const Layer stored = s.divided(stored_light(bake, {}, page));
    double most = worst(s.irradiance(bake, page), strength);
    for (const float light : stored.data) most = std::max(most, off(light, strength));
    return most;
}
double dim_base(const Variant& v) { return std::max(sun_of(v, 1e-7), sun_of(v, 1e-9)); }
double bright_base(const Variant& v) { return sun_of(v, 1e12); }

/// A floor under a sky whose halves, before and behind, have a radiance each.
double two_skies(const Variant& v, float front, float back) {
    Stage s(v);
    const uint32_t page = s.object(kit::plane(2.0f, 0.0f), s.black(), kSize);
    constexpr uint32_t kWidth = 16, kHeight = 8;
    std::vector<float> sky;
    for (uint32_t i = 0; i < kWidth * kHeight; ++i) {
        const float radiance = i % kWidth < kWidth / 2 ? front : back;
        sky.insert(sky.end(), {radiance, radiance, radiance, 1.0f});
    }
    const auto light = static_cast<float>(v.light);
    s.scene.sky_image(s.scene.texture(sky, kWidth, kHeight), {light, light, light});
    s.scene.commit();
    return mean(s.irradiance(kit::Bake(s.scene, s.settings(0, 1024)), page));
}
double negative_sky(const Variant& v) { return std::abs(two_skies(v, -1.0f, -100.0f)); }
double half_negative_sky(const Variant& v) { return off(two_skies(v, -1.0f, 1.0f), pi / 2); }

/// A base and a set of very different strengths; each alone, as baked or as stored.
struct Pair {
    Stage s;
    uint32_t page;
    Pair(const Variant& v, double base, double set) : s(v), page(s.object(kit::plane(2.0f, 0.0f), s.black(), kSize)) {
        s.sun(pi / 2, base);
        s.set("set");
        s.sun(pi / 2, set);
        s.scene.commit();
    }
};

double dim_set(const Variant& v) {
    const Pair pair(v, 1.0, 1e-9);
    return worst(pair.s.term(kit::Bake(pair.s.scene, pair.s.settings(0, 16)), 1, kSize, pair.page), 1e-9);
}

double bright_set(const Variant& v) {
    const Pair pair(v, 0.01, 1e5);
    const kit::Bake bake(pair.s.scene, pair.s.settings(0, 16));
    double most = 0.0;
    for (const float weight : {0.0f, 1e-5f})
        most = std::max(most, worst(pair.s.divided(stored_light(bake, std::array{weight}, pair.page)),
                                    0.01 + double(weight) * 1e5));
    return most;
}

const Case kCases[] = {
    {"range", Origin::kReport, "suns .5 to 3 rad wide", "wide suns keep the strength of a point", "mean of the worst",
     0.01, wide_suns},
    {"range", Origin::kReport, "base light of 1e-7 and 1e-9 W/m^2", "stored as 0", "worst texel, baked and stored",
     0.02, dim_base},
    {"range", Origin::kReport, "base light of 1e12 W/m^2", "stored as infinite, or cut",
     "worst texel, baked and stored", 0.02, bright_base},
    {"range", Origin::kReport, "negative sky", "light below nothing", "mean, W/m^2", 0.0, negative_sky},
    {"range", Origin::kSibling, "sky negative on one half", "what is negative darkens the rest", "mean", 0.01,
     half_negative_sky},
    {"range", Origin::kSibling, "wide suns that set", "the part below the horizon shines", "mean of the worst", 0.02,
     setting_suns},
    {"range", Origin::kSibling, "set of 1e-9 W/m^2 beside a base of 1", "the dim one is dropped", "worst texel", 0.005,
     dim_set},
    {"range", Origin::kSibling, "set of 1e5 W/m^2 beside a base of .01", "the base is lost in the set's unit",
     "worst texel stored, set off and dimmed to 1", 0.02, bright_set},
};

} // namespace

std::span<const Case> range_cases() { return kCases; }

} // namespace hard
