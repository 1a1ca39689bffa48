// SPDX-License-Identifier: GPL-3.0-or-later
// Closed rooms in which all surfaces glow with radiance 1 and reflect the same share: light is the same everywhere,
// whatever is in the room, and in every state of it.
#include <array>
#include <string>

#include "hard_case.h"

namespace hard {
namespace {

constexpr uint32_t kRoom = 12, kThing = 12, kBounces = 12;
constexpr float kRho = 0.5f;

double converged(double rho) { return pi * (1.0 - std::pow(rho, kBounces + 1)) / (1.0 - rho); }

struct Furnace {
    Stage s;
    uint32_t glow, room;
    std::vector<uint32_t> things;

    explicit Furnace(const Variant& v, const std::array<double, 9>& turned = kit::kUpright)
        : s(v),
          glow(s.emitter({1, 1, 1}, kRho)),
          room(s.object(kit::box({-2, -1.5f, -1.25f}, {2, 1.5f, 1.25f}, true), glow, kRoom, "room", turned)) {}
    /// A thing with or without a lightmap.
    void add(const kit::MeshData& mesh, bool mapped, uint32_t material) {
        const uint32_t page = s.object(mesh, material, mapped ? kThing : 0, "thing");
        if (mapped) things.push_back(page);
    }
    /// Glass that lets .4 through, reflects .3 and glows as much as the rest of what reaches it.
    uint32_t glass() { return s.pane({0.4f, 0.4f, 0.4f}, 0.3f, 0.3 / (1.0 - kRho)); }
    /// The worst mean of a page at states of all elements.
    double worst_mean(const std::vector<std::vector<float>>& states, uint32_t samples = 64) {
        s.release();
        s.scene.open_pose = false;
        s.scene.commit();
        ajar_settings settings = s.settings(kBounces, samples);
        settings.bounce_samples = 16;
        const kit::Bake bake(s.scene, settings);
        double most = 0.0;
        things.push_back(room);
        for (const uint32_t page : things)
            for (const std::vector<float>& weights : states) {
                const Layer e = s.state(bake, weights, page == room ? kRoom : kThing, page);
                most = std::max(most, off(valid_mean(e, bake.layer(AJAR_LAYER_VALIDITY, page)), converged(kRho)));
            }
        return most;
    }
};

const kit::MeshData kLeaf = kit::box({-0.1f, -1.0f, -1.1f}, {0.0f, 0.0f, 0.8f}, false);
const kit::MeshData kCrate = kit::box({0.5f, -0.9f, -1.0f}, {1.2f, -0.2f, -0.4f}, false);

double door_and_toggle(const Variant& v) {
    Furnace f(v);
    f.s.door("door"), f.add(kLeaf, true, f.glow);
    f.s.toggle("crate"), f.add(kCrate, false, f.glow);
    return f.worst_mean({{0, 0}, {0, 1}, {1, 0}, {1, 1}});
}

double panes(const Variant& v) {
    Furnace f(v);
    f.add(kit::plane(1.5f, 0.3f), true, f.glass());
    f.add(kCrate, false, f.glass());
    return f.worst_mean({{}});
}

double mirrored_and_sheared(const Variant& v) {
    Furnace mirrored(v, {-2, 0, 0, 0, 1.5, 0, 0, 0, 0.7}), sheared(v, {2, 0.8, 0, 0, 1.5, 0.6, 0.3, 0, 0.9});
    return std::max(mirrored.worst_mean({{}}), sheared.worst_mean({{}}));
}

double two_poses(const Variant& v) {
    Furnace f(v);
    f.s.door("door"), f.add(kLeaf, false, f.glow);
    f.s.scene.open_pose = true;
    f.add(kit::box({-0.1f, 0.0f, -1.1f}, {0.9f, 0.1f, 0.8f}, false), true, f.glow);
    f.s.scene.open_pose = false;
    f.s.door("glass door"), f.add(kit::box({1.4f, -1.0f, -1.1f}, {1.5f, 0.0f, 0.8f}, false), false, f.glass());
    return f.worst_mean({{0, 0}, {0, 1}, {1, 0}, {1, 1}});
}

double half_open(const Variant& v) {
    Furnace f(v);
    f.s.door("door", 0.5f), f.add(kLeaf, true, f.glow);
    f.s.toggle("crate", 0.25f), f.add(kCrate, true, f.glow);
    return f.worst_mean({{0.5f, 0.25f}, {1, 0}, {0, 1}});
}

double glass_within_glass(const Variant& v) {
    Furnace f(v);
    f.s.toggle("outer"), f.add(kit::box({-0.8f, -0.8f, -0.8f}, {0.8f, 0.8f, 0.8f}, false), false, f.glass());
    f.s.toggle("inner"), f.add(kit::box({-0.4f, -0.4f, -0.4f}, {0.4f, 0.4f, 0.4f}, false), false, f.glass());
    f.s.release();
    f.add(kit::plane(0.2f, 0.0f), true, f.glow);
    return f.worst_mean({{0, 0}, {0, 1}, {1, 0}, {1, 1}});
}

double nine_sheets(const Variant& v) {
    Furnace f(v);
    std::vector<float> starts;
    for (int i = 0; i < 9; ++i) {
        starts.push_back(i % 2 == 0 ? 1.0f : 0.5f);
        f.s.toggle("sheet " + std::to_string(i), starts.back());
        f.add(kit::plane(1.5f, 0.1f * static_cast<float>(i) - 0.4f, i % 2 == 0), false, f.glow);
    }
    return f.worst_mean({starts});
}

/// A box whose normals point out, baked on its backs.
double from_the_back(const Variant& v) {
    Stage s(v);
    s.scene.bake_side = AJAR_SIDE_BACK;
    const uint32_t page =
        s.object(kit::box({-2, -1.5f, -1.25f}, {2, 1.5f, 1.25f}, false), s.emitter({1, 1, 1}, kRho), kRoom);
    s.scene.commit();
    const kit::Bake bake(s.scene, s.settings(kBounces, 64));
    return off(valid_mean(s.irradiance(bake, page), bake.layer(AJAR_LAYER_VALIDITY, page)), converged(kRho));
}

/// Three reflectances in three channels.
double coloured(const Variant& v) {
    Stage s(v);
    std::array<ajar_closure, 2> closures;
    for (ajar_closure& c : closures) ajar_closure_init(&c);
    closures[0].type = AJAR_CLOSURE_EMISSION, closures[1].type = AJAR_CLOSURE_DIFFUSE;
    constexpr float kRhos[] = {0.2f, 0.5f, 0.7f};
    for (int c = 0; c < 3; ++c)
        closures[0].color.value[c] = static_cast<float>(v.light), closures[1].color.value[c] = kRhos[c];
    const uint32_t material = s.scene.material({closures[0], closures[1]});
    const uint32_t page = s.object(kit::box({-2, -1.5f, -1.25f}, {2, 1.5f, 1.25f}, true), material, kRoom);
    s.toggle("crate"), s.object(kCrate, material);
    s.scene.commit();
    const kit::Bake bake(s.scene, s.settings(kBounces, 128));
    const Layer e = s.state(bake, {1}, kRoom, page), valid = bake.layer(AJAR_LAYER_VALIDITY, page);
    double most = 0.0;
    for (uint32_t c = 0; c < 3; ++c) most = std::max(most, off(valid_mean(e, valid, c), converged(double(kRhos[c]))));
    return most;
}

constexpr const char* kState = "what one state takes another does not give back";
constexpr const char* kWorst = "mean of the worst page and state";

const Case kCases[] = {
    {"furnaces", Origin::kReport, "furnace with a door and a toggle", kState, kWorst, 0.01, door_and_toggle},
    {"furnaces", Origin::kReport, "furnace with panes", "what is let through counts twice", kWorst, 0.01, panes},
    {"furnaces", Origin::kReport, "mirrored and sheared furnaces", "normals of transformed walls", kWorst, 0.005,
     mirrored_and_sheared},
    {"furnaces", Origin::kReport, "furnace with a door of two poses and one of glass", kState, kWorst, 0.01, two_poses},
    {"furnaces", Origin::kSibling, "furnace with things that are there in part", kState, kWorst, 0.01, half_open},
    {"furnaces", Origin::kSibling, "furnace with glass in glass, both toggles", "what is let through counts twice",
     kWorst, 0.01, glass_within_glass},
    {"furnaces", Origin::kSibling, "furnace with 9 sheets above each other, toggles", "rays through the ninth are lost",
     "mean at the start", 0.01, nine_sheets},
    {"furnaces", Origin::kSibling, "furnace baked on the backs of its walls", "backs reflect nothing", "mean", 0.005,
     from_the_back},
    {"furnaces", Origin::kSibling, "furnace of three reflectances", "chains end for all channels at once",
     "mean of the worst channel", 0.01, coloured},
};

} // namespace

std::span<const Case> furnace_cases() { return kCases; }

} // namespace hard
