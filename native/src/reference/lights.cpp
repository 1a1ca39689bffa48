// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/lights.h"

#include <algorithm>

#include "reference/lamp.h"

namespace ajar {

namespace {

constexpr int kEmissionProbes = 64;

Vec2 barycentric(Pcg& random) {
    const float r = std::sqrt(random.uniform()), t = random.uniform();
    return {r * (1.0f - t), r * t};
}

/// Index of the entry that u in [0,1) falls on.
size_t find(const std::vector<double>& running, float u) {
    const auto it = std::upper_bound(running.begin(), running.end(), u * running.back());
    return std::min<size_t>(it - running.begin(), running.size() - 1);
}

float share(float own, float other) { return own > 0.0f ? own / (own + other) : 0.0f; }

} // namespace

Lights::Lights(const World& world, const std::vector<float>& weights) : world_(world) {
    const Snapshot& s = world.scene;
    const auto weight = [&](uint32_t set) { return set == kNoElement ? 1.0f : weights[set]; };
    for (uint32_t i = 0; i < s.lights.size(); ++i) {
        const Light& l = s.lights[i];
        const float set = weight(l.light_set);
        if (l.dark() || !(set > 0.0f)) continue;
        lamps_.add(i, l, set);
        if (!l.primary) static_lamps_.add(i, l, set);
    }
    double total = 0.0;
    for (uint32_t t = 0; t < s.triangles.size(); ++t) {
        const float set = weight(s.instance_of(t).light_set);
        // What diffuse rays do not see lights no diffuse surface, by whatever way of sampling (Cycles' rule).
        if (!s.materials[s.triangles[t].material].emits || !s.is_gathered(t) || !(set > 0.0f)) continue;
        Pcg random(t, 0x7e57);
        double power = 0.0;
        for (int i = 0; i < kEmissionProbes; ++i) {
            const Vec2 b = barycentric(random);
            power += luminance(s.emission(t, b.x, b.y)) * s.area(t) * set;
        }
        if (!(power > 0.0)) continue;
        triangles_.push_back(t);
        triangle_running_.push_back(total += power);
    }
    chance_per_area_.resize(triangles_.empty() ? 0 : s.triangles.size(), 0.0f);
    for (size_t i = 0; i < triangles_.size(); ++i)
        chance_per_area_[triangles_[i]] = static_cast<float>(
            (triangle_running_[i] - (i > 0 ? triangle_running_[i - 1] : 0.0)) / (total * s.area(triangles_[i])));
    if (!s.sky.lit() || !s.sky.has_image) return;
    double sky = 0.0;
    for (uint32_t y = 0; y < s.sky.image.height; ++y) {
        const double latitude = ((y + 0.5) / s.sky.image.height - 0.5) * kPi;
        for (uint32_t x = 0; x < s.sky.image.width; ++x)
            sky_running_.push_back(sky += luminance(glm::abs(Vec3(s.sky.image.texel(x, y)))) * std::cos(latitude));
    }
    if (!(sky > 0.0)) sky_running_.clear();
}

Lights::Sample Lights::sample_lamp(const Vertex& at, Pcg& random) const {
    const LampTable& lamps = at.receiver ? static_lamps_ : lamps_;
    if (lamps.empty()) return {};
    const LampTable::Choice chosen = lamps.choose(at.position, at.normal, random);
    const Light& l = world_.scene.lights[chosen.number];
    const LampPoint p = lamp_point(l, at.position, random);
    return {p.direction, p.distance, p.light * (chosen.weight / chosen.chance), 0.0f, l.casts_shadow};
}

Lights::Sample Lights::sample_triangle(const Vertex& at, const SceneState& state, Pcg& random) const {
    const Snapshot& s = world_.scene;
    const uint32_t t = triangles_[find(triangle_running_, random.uniform())];
    const Vec2 b = barycentric(random);
    if (!state.is_there(s.presence(t))) return {};
    const Vec3 to = s.position(t, b.x, b.y) - at.position;
    const float distance = glm::length(to);
    if (!(distance > 0.0f)) return {};
    const float cosine = -glm::dot(to, s.geometric_normal(t)) / distance;
    if (cosine == 0.0f || (cosine < 0.0f && world_.has_dead_back(t))) return {};
    const float density = triangle_density(t, distance, std::abs(cosine));
    return {to / distance, distance, s.emission(t, b.x, b.y) * (state.light_set(s.instance_of(t).light_set) / density),
            density};
}

Lights::Sample Lights::sample_sky(Pcg& random) const {
    const Sky& sky = world_.scene.sky;
    const size_t i = find(sky_running_, random.uniform());
    const auto x = static_cast<uint32_t>(i % sky.image.width), y = static_cast<uint32_t>(i / sky.image.width);
    const auto sine = [&](float row) { return std::sin((row / static_cast<float>(sky.image.height) - 0.5f) * kPi); };
    const float low = sine(static_cast<float>(y)), high = sine(static_cast<float>(y) + 1.0f);
    const float z = low + (high - low) * random.uniform(), r = std::sqrt(std::max(0.0f, 1.0f - z * z));
    const float u = (static_cast<float>(x) + random.uniform()) / static_cast<float>(sky.image.width);
    const float angle = (0.5f - u) * 2.0f * kPi, density = sky_density(x, y);
    if (!(density > 0.0f)) return {};
    return {{r * std::cos(angle), r * std::sin(angle), z},
            std::numeric_limits<float>::infinity(),
            sky.color * Vec3(sky.image.texel(x, y)) / density,
            density};
}

/// Per steradian, of a texel of the sky's image.
float Lights::sky_density(uint32_t x, uint32_t y) const {
    const Texture& image = world_.scene.sky.image;
    const size_t i = size_t{y} * image.width + x;
    const double chance = (sky_running_[i] - (i > 0 ? sky_running_[i - 1] : 0.0)) / sky_running_.back();
    const auto sine = [&](double row) { return std::sin((row / image.height - 0.5) * double{kPi}); };
    return static_cast<float>(chance / ((sine(y + 1.0) - sine(y)) * 2.0 * double{kPi} / image.width));
}

float Lights::triangle_density(uint32_t triangle, float distance, float facing) const {
    return chance_per_area_[triangle] * distance * distance / std::max(facing, 1e-9f);
}

Vec3 Lights::arriving(const Vertex& at, const Sample& sample, const SceneState& state) const {
    const float cosine = glm::dot(sample.direction, at.normal);
    if (!(cosine > 0.0f) || !(glm::dot(sample.direction, at.side) > 0.0f) || sample.light == Vec3(0.0f))
        return Vec3(0.0f);
    // Stops short of the source's own surface.
    const Vec3 target = at.position + sample.direction * sample.distance;
    const float end = std::isfinite(sample.distance)
                          ? sample.distance * (1.0f - 2e-5f) - 2.0f * world_.tracer.offset_distance(target)
                          : sample.distance;
    const Vec3 light = sample.light * (sample.density > 0.0f ? share(sample.density, cosine * kInvPi) : 1.0f) * cosine;
    if (!sample.casts_shadow) return light;
    return light * world_.transmittance({at.position, sample.direction, 0.0f, std::max(end, 0.0f)}, state);
}

Vec3 Lights::direct(const Vertex& at, const SceneState& state, Pcg& random) const {
    Vec3 sum(0.0f);
    if (!lamps_.empty()) sum += arriving(at, sample_lamp(at, random), state);
    if (!triangles_.empty()) sum += arriving(at, sample_triangle(at, state, random), state);
    if (!sky_running_.empty()) sum += arriving(at, sample_sky(random), state);
    return sum;
}

float Lights::ray_share_of_triangle(uint32_t triangle, float cosine, float distance, float facing) const {
    if (chance_per_area_.empty()) return 1.0f;
    return share(cosine * kInvPi, triangle_density(triangle, distance, facing));
}

float Lights::ray_share_of_sky(const Vec3& direction, float cosine) const {
    if (sky_running_.empty()) return 1.0f;
    const Texture& image = world_.scene.sky.image;
    const Vec2 uv = Sky::direction_to_uv(direction);
    const auto column = [](float u, uint32_t size) {
        return std::min(static_cast<uint32_t>(std::max(u, 0.0f) * static_cast<float>(size)), size - 1);
    };
    return share(cosine * kInvPi, sky_density(column(uv.x, image.width), column(uv.y, image.height)));
}

} // namespace ajar
