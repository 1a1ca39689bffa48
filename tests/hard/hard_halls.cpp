// SPDX-License-Identifier: GPL-3.0-or-later
// Long rooms and rooms full of screens, against brute force.
#include <map>
#include <string>

#include "brute_force.h"
#include "hard_case.h"

namespace hard {
namespace {

constexpr float kRho = 0.5f, kLength = 12.0f;

/// A floor along x, 2 m wide.
kit::MeshData floor() {
    kit::MeshData m;
    m.quad({0, -1, 0}, {kLength, -1, 0}, {kLength, 1, 0}, {0, 1, 0}, {0, 0}, {1, 1});
    return m;
}

/// Walls and ceiling of a corridor 2 m wide and high, without its floor and, if asked for, its end x = 0.
kit::MeshData shell(bool open_end) {
    kit::MeshData box = kit::box({0, -1, 0}, {kLength, 1, 2}, true), out;
    for (size_t f = 1; f < (open_end ? 5u : 6u); ++f) {
        const Float3* p = &box.positions[4 * f];
        out.quad(p[0], p[1], p[2], p[3], {float(f % 3) / 3, float(f / 3) / 2},
                 {float(f % 3 + 1) / 3, float(f / 3 + 1) / 2});
    }
    return out;
}

/// Mean over the far half of a floor.
double far_mean(const Layer& e) {
    double sum = 0.0;
    for (uint32_t y = 0; y < e.height; ++y)
        for (uint32_t x = e.width / 2; x < e.width; ++x) sum += e.at(x, y);
    return sum / (e.height * (e.width / 2));
}

/// The same by brute force at 16 x 16 places, once per case.
double true_mean(const char* name, const std::vector<Rectangle>& scene, const Lamp& lamp, int bounces, int paths) {
    static std::map<std::string, double> known;
    const auto [entry, is_new] = known.try_emplace(name, 0.0);
    constexpr int kPlaces = 16;
    for (int i = 0; is_new && i < kPlaces * kPlaces; ++i) {
        const double x = kLength * (0.5 + 0.5 * (i % kPlaces + 0.5) / kPlaces),
                     y = 2.0 * (i / kPlaces + 0.5) / kPlaces - 1.0;
        entry->second += brute_force(scene, lamp, {x, y, 0.0}, bounces, paths) / (kPlaces * kPlaces);
    }
    return entry->second;
}

/// A corridor of 12 m whose end glows, in a set; its dim half.
double corridor(const Variant& v) {
    constexpr uint32_t kColumns = 24;
    Stage s(v);
    const uint32_t grey = s.scene.diffuse({kRho, kRho, kRho});
    const uint32_t page = s.object(floor(), grey, kColumns);
    s.object(shell(true), grey, 72, "shell");
    kit::MeshData end;
    end.quad({0, -1, 0}, {0, 1, 0}, {0, 1, 2}, {0, -1, 2}, {0, 0}, {1, 1});
    s.set("end"), s.object(end, s.emitter({1, 1, 1}, kRho));
    s.scene.commit();
    ajar_settings settings = s.settings(6, 256);
    settings.bounce_samples = 64;
    const Layer e = s.state(kit::Bake(s.scene, settings), {1}, kColumns, page);
    std::vector<Rectangle> walls = box_walls({0, -1, 0}, {kLength, 1, 2}, kRho);
    walls[0].radiance = 1.0;
    return off(far_mean(e), true_mean("corridor", walls, {}, 6, 2000));
}

const Lamp kLamp = {{0.5, 0.1, 1.8}, 200.0};

/// A hall of 12 m with a lamp at one end and 20 black screens across it, each a toggle that leaves .8 m open.
double screens(const Variant& v, const char* name, bool in_set, int there_every) {
    constexpr uint32_t kColumns = 16;
    Stage s(v);
    const uint32_t grey = s.scene.diffuse({kRho, kRho, kRho});
    const uint32_t page = s.object(floor(), grey, kColumns);
    s.object(shell(false), grey, 72, "shell");
    std::vector<Rectangle> scene = box_walls({0, -1, 0}, {kLength, 1, 2}, kRho);
    std::vector<float> starts;
    for (int i = 0; i < 20; ++i) {
        const bool there = there_every > 0 && i % there_every == 0;
        starts.push_back(there ? 1.0f : 0.0f);
        s.toggle("screen " + std::to_string(i), starts.back());
        const float x = 1.25f + 0.5f * static_cast<float>(i), y = i % 2 == 0 ? -1.0f : -0.2f;
        kit::MeshData m;
        m.quad({x, y, 0}, {x, y + 1.2f, 0}, {x, y + 1.2f, 1.6f}, {x, y, 1.6f}, {0, 0}, {1, 1});
        s.object(m, s.black());
        if (there) scene.push_back({0, double(x), {double(y), 0.0}, {double(y) + 1.2, 1.6}, 0.0});
    }
    s.release();
    if (in_set) s.set("lamp");
    s.point({0.5f, 0.1f, 1.8f}, kLamp.watts);
    s.scene.commit();
    starts.push_back(1.0f);
    ajar_settings settings = s.settings(2, 64);
    settings.bounce_samples = 64;
    settings.combinations = AJAR_COMBINATIONS_NONE; // they change states away from the start only
    const Layer e = s.state(kit::Bake(s.scene, settings), starts, kColumns, page);
    return off(far_mean(e), true_mean(name, scene, kLamp, 2, 3000));
}
double absent_screens(const Variant& v) {
    return std::max(screens(v, "absent", false, 0), screens(v, "absent", true, 0));
}
double some_screens(const Variant& v) { return std::max(screens(v, "some", false, 3), screens(v, "some", true, 3)); }

const Case kCases[] = {
    {"halls", Origin::kReport, "corridor of 12 m with a glowing end, in a set", "dim light is left to chance",
     "mean of the far half of the floor", 0.06, corridor},
    {"halls", Origin::kReport, "20 absent screens in a hall", "rays through the ninth are lost",
     "mean of the far half of the floor at the start", 0.05, absent_screens},
    {"halls", Origin::kSibling, "20 screens in a hall, every third there", "rays through the ninth are lost",
     "mean of the far half of the floor at the start", 0.15, some_screens},
};

} // namespace

std::span<const Case> hall_cases() { return kCases; }

} // namespace hard
