// SPDX-License-Identifier: GPL-3.0-or-later
// What must not change when the scene is moved, scaled, turned, mirrored or lit in parts
// (algorithms.md 12.7). Transforms keep the random numbers, so most comparisons are nearly exact;
// where they do not, the bake's own standard error is the measure.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <numbers>

#include "room_kit.h"

namespace {

using Matrix = std::array<double, 12>;

struct Result {
    kit::Layer e, se, validity;
};

Result bake(const kit::Scene& scene, const ajar_settings& settings, uint32_t page = 0) {
    const kit::Bake b(scene, settings);
    return {b.layer(AJAR_LAYER_IRRADIANCE, page), b.layer(AJAR_LAYER_STDERR, page), b.layer(AJAR_LAYER_VALIDITY, page)};
}

double lum(const kit::Layer& e, size_t texel) {
    return 0.2126 * e.data[3 * texel] + 0.7152 * e.data[3 * texel + 1] + 0.0722 * e.data[3 * texel + 2];
}

/// Largest relative difference that the share best of the valid texels stays below.
double difference(const Result& a, const Result& b, double share, double factor = 1.0) {
    std::vector<double> all;
    for (size_t i = 0; i < a.validity.data.size(); ++i)
        if (a.validity.data[i] == 1.0f)
            all.push_back(std::abs(lum(b.e, i) * factor / std::max(lum(a.e, i), 1e-30) - 1.0));
    std::sort(all.begin(), all.end());
    EXPECT_GT(all.size(), 50u);
    return all.empty() ? 1e9 : all[static_cast<size_t>(share * static_cast<double>(all.size() - 1))];
}

double valid_mean(const Result& r) {
    double sum = 0.0, count = 0.0;
    for (size_t i = 0; i < r.validity.data.size(); ++i)
        if (r.validity.data[i] == 1.0f) sum += lum(r.e, i), count += 1.0;
    return sum / count;
}

/// Standard error of valid_mean.
double mean_error(const Result& r) {
    double sum = 0.0, count = 0.0;
    for (size_t i = 0; i < r.validity.data.size(); ++i)
        if (r.validity.data[i] == 1.0f) sum += double(r.se.data[i]) * r.se.data[i], count += 1.0;
    return std::sqrt(sum) / count;
}

/// Root mean square of the difference in units of the combined standard error; about 1 if both
/// measure the same and their errors are honest. value(i), error(i) describe the other side.
double rms_z(const Result& a, const std::function<double(size_t)>& value, const std::function<double(size_t)>& error) {
    double sum = 0.0, count = 0.0;
    for (size_t i = 0; i < a.validity.data.size(); ++i) {
        if (a.validity.data[i] != 1.0f) continue;
        const double z = kit::z_score(lum(a.e, i), a.se.data[i], value(i), error(i));
        sum += std::min(z * z, 25.0);
        count += 1.0;
    }
    return std::sqrt(sum / count);
}

// ---- the scene that is moved about -----------------------------------------------------------

struct Placement {
    Matrix matrix = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    float scale = 1.0f; ///< of the mesh, before the matrix
    double light = 1.0; ///< factor of the lamps' power

    Matrix apply(double x, double y, double z) const {
        Matrix m = matrix;
        for (int r = 0; r < 3; ++r) m[4 * r + 3] += matrix[4 * r] * x + matrix[4 * r + 1] * y + matrix[4 * r + 2] * z;
        return m;
    }
};

kit::MeshData scaled(kit::MeshData mesh, float s) {
    for (kit::Float3& p : mesh.positions)
        for (float& c : p) c *= s;
    return mesh;
}

void add_lamp(kit::Scene& scene, const Placement& p, double x, double y, double z, double watts, uint32_t role) {
    ajar_light_desc d;
    ajar_light_desc_init(&d);
    d.name = "lamp";
    d.role = role;
    d.energy = static_cast<float>(watts * p.light * p.scale * p.scale);
    d.color[1] = 0.7f;
    scene.light(d, p.apply(x * p.scale, y * p.scale, z * p.scale).data());
}

/// A closed room with a box in it; two lamps without extent.
Result placed_room(const Placement& p) {
    kit::Scene scene;
    const uint32_t grey = scene.diffuse({0.5f, 0.6f, 0.4f}), page = scene.page(48, 48);
    scene.instance(scene.mesh(scaled(kit::box({-2, -2, 0}, {2, 2, 3}, true), p.scale)), grey, page, "room",
                   p.matrix.data());
    scene.instance(scene.mesh(scaled(kit::box({-0.7f, -0.4f, 0.3f}, {0.5f, 0.5f, 1.0f}, false), p.scale)),
                   scene.diffuse({0, 0, 0}), AJAR_NONE, "box", p.matrix.data());
    add_lamp(scene, p, 1.0, 0.5, 2.5, 60.0, AJAR_ROLE_STATIC);
    add_lamp(scene, p, -1.2, -1.0, 1.5, 20.0, AJAR_ROLE_PRIMARY);
    scene.commit();
    ajar_settings s = kit::settings(2, 128);
    s.bounce_samples = 32;
    s.direct_samples = 32;
    s.positions_per_texel = 4;
    return bake(scene, s);
}

const Result& room_at_origin() {
    static const Result room = placed_room({});
    return room;
}

Matrix rotation(double angle, double x, double y, double z) { // Rodrigues' formula
    const double l = std::sqrt(x * x + y * y + z * z), c = std::cos(angle), s = std::sin(angle), t = 1 - c;
    x /= l, y /= l, z /= l;
    return {t * x * x + c,     t * x * y - s * z, t * x * z + s * y, 0,
            t * x * y + s * z, t * y * y + c,     t * y * z - s * x, 0,
            t * x * z - s * y, t * y * z + s * x, t * z * z + c,     0};
}

TEST(Invariance, ScaleTimes1000) {
    const Result big = placed_room({.scale = 1000.0f});
    EXPECT_LT(difference(room_at_origin(), big, 0.99), 1e-3);
    EXPECT_NEAR(valid_mean(big) / valid_mean(room_at_origin()), 1.0, 1e-3);
}

TEST(Invariance, ScaleOverThousand) {
    const Result small = placed_room({.scale = 0.001f});
    EXPECT_LT(difference(room_at_origin(), small, 0.99), 1e-3);
    EXPECT_NEAR(valid_mean(small) / valid_mean(room_at_origin()), 1.0, 1e-3);
}

TEST(Invariance, LightTimesAMillionIsLinear) {
    // Powers are rounded otherwise, which moves the points that samples aim at a little.
    EXPECT_LT(difference(room_at_origin(), placed_room({.light = 1e6}), 1.0, 1e-6), 3e-4);
    EXPECT_LT(difference(room_at_origin(), placed_room({.light = 1e-6}), 1.0, 1e6), 3e-4);
}

TEST(Invariance, TenKilometresAwayAgreesToFourDigits) {
    Placement far;
    far.matrix[3] = 10000.0, far.matrix[7] = -7000.0, far.matrix[11] = 300.25;
    const Result moved = placed_room(far);
    EXPECT_LT(difference(room_at_origin(), moved, 0.995), 1e-4);
    EXPECT_NEAR(valid_mean(moved) / valid_mean(room_at_origin()), 1.0, 1e-4);
}

TEST(Invariance, Rotation) {
    const Result turned = placed_room({.matrix = rotation(0.7, 0.2, -0.5, 0.9)});
    EXPECT_LT(difference(room_at_origin(), turned, 0.98), 2e-3);
    EXPECT_NEAR(valid_mean(turned) / valid_mean(room_at_origin()), 1.0, 1e-3);
}

TEST(Invariance, MirroredInstances) {
    for (int axis = 0; axis < 3; ++axis) {
        Placement mirror;
        mirror.matrix[5 * axis] = -1.0;
        const Result mirrored = placed_room(mirror);
        EXPECT_LT(difference(room_at_origin(), mirrored, 0.98), 1e-3) << axis;
        EXPECT_NEAR(valid_mean(mirrored) / valid_mean(room_at_origin()), 1.0, 5e-4) << axis;
    }
}

TEST(Invariance, NonUniformScaleOfTheInstanceEqualsTheScaledMesh) {
    const auto sunlit = [](bool by_instance) {
        kit::Scene scene;
        kit::MeshData ramp;
        const float k = by_instance ? 1.0f : 3.0f;
        ramp.quad({-1, -1, 0}, {1, -1, 0}, {1, 1, k}, {-1, 1, k}, {0, 0}, {1, 1});
        ramp.normals.assign(
            6, by_instance ? kit::Float3{0, -0.4472136f, 0.8944272f} : kit::Float3{0, -0.8320503f, 0.5547002f});
        const Matrix tall = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 3, 0};
        scene.instance(scene.mesh(ramp), scene.diffuse({1, 1, 1}), scene.page(12, 12), "ramp",
                       by_instance ? tall.data() : nullptr);
        ajar_light_desc d;
        ajar_light_desc_init(&d);
        d.type = AJAR_LIGHT_SUN;
        d.role = AJAR_ROLE_STATIC;
        d.energy = 2.0f;
        scene.light(d, kit::translation(0, 0, 5).data());
        scene.commit();
        return bake(scene, kit::settings(0)).e.at(6, 6);
    };
    EXPECT_NEAR(sunlit(false), 2.0f * 0.5547002f, 1e-4f);
    EXPECT_NEAR(sunlit(true), 2.0f * 0.5547002f, 1e-4f);
}

// ---- light in parts --------------------------------------------------------------------------

constexpr int kLampA = 1, kLampB = 2, kSky = 4;

Result lit_by(int parts, uint32_t seed) {
    kit::Scene scene;
    const uint32_t grey = scene.diffuse({0.6f, 0.5f, 0.4f}), page = scene.page(48, 48);
    kit::MeshData room = kit::box({-2, -2, 0}, {2, 2, 3}, true);
    room.corners.erase(room.corners.begin() + 6, room.corners.begin() + 9);
    room.uv.erase(room.uv.begin() + 6, room.uv.begin() + 9);
    scene.instance(scene.mesh(room), grey, page, "room");
    if (parts & kLampA) scene.point_light({1, 0.5f, 2.0f}, 60.0f, 0.2f);
    if (parts & kLampB)
        scene.instance(scene.mesh(kit::box({-1, -1, 1}, {-0.8f, -0.6f, 1.1f}, false)), scene.emitter({20, 15, 9}),
                       AJAR_NONE, "bulb");
    else
        scene.instance(scene.mesh(kit::box({-1, -1, 1}, {-0.8f, -0.6f, 1.1f}, false)), scene.diffuse({0, 0, 0}),
                       AJAR_NONE, "bulb");
    if (parts & kSky) scene.sky({0.6f, 0.8f, 1.0f});
    scene.commit();
    ajar_settings s = kit::settings(3, 256);
    s.seed = seed;
    return bake(scene, s);
}

TEST(Linearity, LampsMeshLightAndSkyAddUp) {
    const Result all = lit_by(kLampA | kLampB | kSky, 1);
    const Result parts[] = {lit_by(kLampA, 2), lit_by(kLampB, 3), lit_by(kSky, 4)};
    const auto sum = [&](size_t i) { return lum(parts[0].e, i) + lum(parts[1].e, i) + lum(parts[2].e, i); };
    const auto error = [&](size_t i) {
        return std::hypot(parts[0].se.data[i], parts[1].se.data[i], parts[2].se.data[i]);
    };
    EXPECT_LT(rms_z(all, sum, error), 1.6);
    double mean = 0.0, bound = mean_error(all);
    for (const Result& p : parts) mean += valid_mean(p), bound = std::hypot(bound, mean_error(p));
    // Half a percent covers the noise of the stored bounces, which all texels share.
    EXPECT_NEAR(valid_mean(all), mean, 4.0 * bound + 0.005 * mean);
}

TEST(Linearity, SeedsChangeTheNoiseNotTheMean) {
    const Result a = lit_by(kLampA | kLampB | kSky, 11), b = lit_by(kLampA | kLampB | kSky, 12);
    const double z = rms_z(
        a, [&](size_t i) { return lum(b.e, i); }, [&](size_t i) { return double(b.se.data[i]); });
    EXPECT_LT(z, 1.6);
    EXPECT_GT(z, 0.4) << "the standard error is overstated, or the seed has no effect";
    EXPECT_NEAR(valid_mean(a), valid_mean(b), 4.0 * std::hypot(mean_error(a), mean_error(b)) + 0.003 * valid_mean(a));
}

// ---- storage ---------------------------------------------------------------------------------

/// A small lamp close to the wall of a sphere whose every edge is a seam of its lightmap.
void seamed_sphere(kit::Scene& scene) {
    scene.instance(scene.mesh(kit::sphere_inside(1.0f, 2)), scene.diffuse({0.5f, 0.5f, 0.5f}), scene.page(128, 128));
    scene.point_light({0.9f, 0, 0}, 100.0f, 0.01f);
    scene.commit();
}

TEST(Stitching, ChangesTheBrightnessNotTheDirectionOfALight) {
    kit::Scene scene;
    seamed_sphere(scene);
    ajar_settings s = kit::settings(1, 64);
    const kit::Bake plain(scene, s);
    s.stitch_seams = 1;
    const kit::Bake stitched(scene, s);
    const kit::Layer a = plain.layer(AJAR_LAYER_AHD), b = stitched.layer(AJAR_LAYER_AHD);
    int brightness = 0, direction = 0;
    for (size_t i = 0; i < a.data.size(); i += 2) {
        brightness += std::bit_cast<uint32_t>(a.data[i]) != std::bit_cast<uint32_t>(b.data[i]);
        direction += std::bit_cast<uint32_t>(a.data[i + 1]) != std::bit_cast<uint32_t>(b.data[i + 1]);
    }
    EXPECT_GT(brightness, 100);
    EXPECT_EQ(direction, 0);
}

// ---- surfaces --------------------------------------------------------------------------------

ajar_closure closure(uint32_t type, kit::Float3 color) {
    ajar_closure c;
    ajar_closure_init(&c);
    c.type = type;
    for (int i = 0; i < 3; ++i) c.color.value[i] = color[i];
    return c;
}

void add_sun(kit::Scene& scene, float strength) {
    ajar_light_desc d;
    ajar_light_desc_init(&d);
    d.name = "sun";
    d.type = AJAR_LIGHT_SUN;
    d.role = AJAR_ROLE_STATIC;
    d.energy = strength;
    scene.light(d, kit::translation(0, 0, 9).data());
}

TEST(Transparency, TintedPanesMultiplyDirectLight) {
    const auto floor_light = [](int panes) {
        kit::Scene scene;
        scene.instance(scene.mesh(kit::plane(2.0f, 0.0f)), scene.diffuse({0.5f, 0.5f, 0.5f}), scene.page(8, 8));
        const uint32_t glass = scene.material({closure(AJAR_CLOSURE_TRANSPARENT, {0.5f, 0.25f, 0.0f})});
        for (int i = 0; i < panes; ++i)
            scene.instance(scene.mesh(kit::plane(9.0f, 0.5f + 0.1f * static_cast<float>(i))), glass, AJAR_NONE, "pane");
        scene.point_light({0, 0, 2}, 50.0f);
        scene.commit();
        return bake(scene, kit::settings(1)).e;
    };
    const kit::Layer open = floor_light(0), one = floor_light(1), two = floor_light(2);
    for (uint32_t x = 0; x < 8; ++x) {
        EXPECT_NEAR(one.at(x, 3, 0) / open.at(x, 3, 0), 0.5, 1e-5);
        EXPECT_NEAR(one.at(x, 3, 1) / open.at(x, 3, 1), 0.25, 1e-5);
        EXPECT_EQ(one.at(x, 3, 2), 0.0f);
        EXPECT_NEAR(two.at(x, 3, 1) / open.at(x, 3, 1), 0.0625, 1e-5);
    }
}

TEST(Transparency, TheSkyThroughATintedPane) {
    kit::Scene scene;
    scene.instance(scene.mesh(kit::plane(2.0f, 0.0f)), scene.diffuse({0, 0, 0}), scene.page(8, 8));
    kit::MeshData dome = kit::box({-5, -5, -1}, {5, 5, 5}, true);
    scene.instance(scene.mesh(dome), scene.material({closure(AJAR_CLOSURE_TRANSPARENT, {0.5f, 0.25f, 1.0f})}),
                   AJAR_NONE, "dome");
    scene.sky({1, 1, 1});
    scene.commit();
    const kit::Layer e = bake(scene, kit::settings(2)).e;
    EXPECT_NEAR(e.at(4, 4, 0), 0.5 * std::numbers::pi, 1e-4);
    EXPECT_NEAR(e.at(4, 4, 1), 0.25 * std::numbers::pi, 1e-4);
    EXPECT_NEAR(e.at(4, 4, 2), std::numbers::pi, 1e-4);
}

/// Diffuse where the texture's alpha is 1, a hole where it is 0.
uint32_t cutout(kit::Scene& scene, const std::vector<float>& rgba, uint32_t size) {
    ajar_texture_desc t;
    ajar_texture_desc_init(&t);
    t.name = "leaf";
    t.width = t.height = size;
    t.texel = AJAR_TEXEL_F32;
    t.nearest = 1;
    t.texels = rgba.data();
    t.texel_bytes = rgba.size() * sizeof(float);
    uint32_t texture = 0;
    kit::check(ajar_scene_add_texture(scene.handle(), &t, &texture));
    ajar_closure leaf = closure(AJAR_CLOSURE_DIFFUSE, {0.1f, 0.4f, 0.1f}),
                 hole = closure(AJAR_CLOSURE_TRANSPARENT, {1, 1, 1});
    leaf.weight_a.texture = hole.weight_a.texture = texture;
    leaf.weight_a.channel = hole.weight_a.channel = AJAR_CHANNEL_A;
    hole.weight_a.invert = 1;
    return scene.material({leaf, hole});
}

TEST(Transparency, CutoutsPassLightExactly) {
    kit::Scene scene;
    scene.instance(scene.mesh(kit::plane(4.0f, 0.0f)), scene.diffuse({0, 0, 0}), scene.page(16, 16));
    const uint32_t leaf =
        cutout(scene, {0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1}, 2); // holes at right bottom and left top
    scene.instance(scene.mesh(kit::plane(4.0f, 1.0f)), leaf, AJAR_NONE, "leaf");
    add_sun(scene, 3.0f);
    scene.commit();
    const kit::Layer e = bake(scene, kit::settings(0)).e;
    for (uint32_t y = 0; y < 16; ++y)
        for (uint32_t x = 0; x < 16; ++x) {
            const bool hole = (x < 8) != (y < 8);
            ASSERT_NEAR(e.at(x, y), hole ? 3.0f : 0.0f, hole ? 1e-4f : 0.0f) << x << ' ' << y;
        }
}

/// Mean light that a glowing quad at z = 1, its front up or down, throws on a floor below.
double glow_on_floor(bool front_up, bool one_sided) {
    kit::Scene scene;
    scene.instance(scene.mesh(kit::plane(2.0f, 0.0f)), scene.diffuse({0, 0, 0}), scene.page(8, 8));
    scene.instance(scene.mesh(kit::plane(1.0f, 1.0f, front_up)), scene.emitter({4, 4, 4}, {0, 0, 0}, one_sided),
                   AJAR_NONE, "panel");
    scene.commit();
    ajar_settings s = kit::settings(1, 512);
    s.direct_samples = 256;
    return kit::mean(bake(scene, s).e);
}

TEST(Sides, OneSidedSurfacesEmitForwardOnly) {
    const double forward = glow_on_floor(false, true);
    EXPECT_GT(forward, 0.5);
    EXPECT_EQ(glow_on_floor(true, true), 0.0);
    EXPECT_NEAR(glow_on_floor(true, false) / forward, 1.0, 0.02);
    EXPECT_NEAR(glow_on_floor(false, false) / forward, 1.0, 0.02);
}

/// Mean light that a lamp throws onto a black floor by way of a white ceiling alone.
double by_way_of_ceiling(bool lightmapped, bool front_up, bool one_sided) {
    kit::Scene scene;
    scene.instance(scene.mesh(kit::plane(2.0f, 0.0f)), scene.diffuse({0, 0, 0}), scene.page(12, 12), "floor");
    ajar_closure white = closure(AJAR_CLOSURE_DIFFUSE, {0.8f, 0.8f, 0.8f});
    const uint32_t page = lightmapped ? scene.page(48, 48) : AJAR_NONE;
    scene.instance(scene.mesh(kit::plane(3.0f, 2.0f, front_up)), scene.material({white}, one_sided), page, "ceiling");
    scene.point_light({0.2f, 0.1f, 1.0f}, 80.0f, 0.05f, true);
    scene.commit();
    return kit::mean(bake(scene, kit::settings(1, 1024)).e);
}

TEST(Sides, OccludersBounceAsMuchAsLightmappedSurfaces) {
    const double mapped = by_way_of_ceiling(true, false, false);
    EXPECT_GT(mapped, 0.1);
    EXPECT_NEAR(by_way_of_ceiling(false, false, false) / mapped, 1.0, 0.02);
    EXPECT_NEAR(by_way_of_ceiling(false, true, false) / mapped, 1.0, 0.02) << "the back of a two-sided occluder";
    EXPECT_NEAR(by_way_of_ceiling(true, true, false) / mapped, 1.0, 0.02)
        << "the back of a two-sided lightmapped surface";
}

TEST(Sides, BacksOfOneSidedSurfacesReflectNothing) {
    EXPECT_EQ(by_way_of_ceiling(false, true, true), 0.0);
    EXPECT_EQ(by_way_of_ceiling(true, true, true), 0.0);
}

TEST(Sides, AnOccluderAmongManyBouncesChangesNoMean) {
    const auto room = [](bool lightmapped) {
        kit::Scene scene;
        const uint32_t grey = scene.diffuse({0.4f, 0.4f, 0.4f});
        scene.instance(scene.mesh(kit::box({-2, -2, 0}, {2, 2, 3}, true)), grey, scene.page(48, 48), "room");
        const uint32_t page = lightmapped ? scene.page(48, 48) : AJAR_NONE;
        scene.instance(scene.mesh(kit::box({-0.5f, -0.5f, 0.4f}, {0.5f, 0.5f, 1.4f}, false)), grey, page, "crate");
        scene.point_light({1, 1, 2.5f}, 60.0f, 0.0f, true);
        scene.commit();
        return bake(scene, kit::settings(8, 256));
    };
    EXPECT_NEAR(valid_mean(room(false)) / valid_mean(room(true)), 1.0, 0.01);
}

} // namespace
