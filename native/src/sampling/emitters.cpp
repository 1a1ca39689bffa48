// SPDX-License-Identifier: GPL-3.0-or-later
#include "sampling/emitters.h"

#include <limits>
#include <map>
#include <tuple>

#include "sampling/warp.h"
#include "sampling/wide_lamp.h"

namespace ajar {

namespace {

constexpr uint32_t kClusterSize = 8; ///< most triangles of an emitter
constexpr float kFlatBend = 0.25f;   ///< clusters more bent than this count as shining everywhere
constexpr float kLargeShare = 0.2f;  ///< of the scene's area; larger emitters are left to the gather

bool two_sided(const Snapshot& s, uint32_t triangle) { return !s.materials[s.triangles[triangle].material].one_sided; }

} // namespace

EmitterSet::EmitterSet(const Snapshot& scene, ThreadPool& pool, Progress& progress, uint32_t singles)
    : scene_(scene), sky_(std::make_shared<SkySampler>(scene.sky)) {
    for (uint32_t i = 0; i < scene.lights.size(); ++i)
        if (!scene.lights[i].dark()) emitters_.push_back({Kind::lamp, i});
    collect(pool, progress);
    drop_large();
    const size_t crowd = (triangles_.size() + singles - 1) / std::max(singles, 1u);
    cluster_size_ = static_cast<uint32_t>(std::clamp<size_t>(crowd, 1, kClusterSize));
    triangle_density_.resize(triangles_.empty() ? 0 : scene.triangles.size(), 0.0f);
    triangle_emitter_.resize(triangles_.empty() ? 0 : scene.triangles.size(), kNone);
    split_by_element();
    if (sky_->total() > 0.0f) {
        sky_emitter_ = count();
        emitters_.push_back({Kind::sky, 0});
    }
    weigh_for_anywhere();
}

void EmitterSet::collect(ThreadPool& pool, Progress& progress) {
    std::vector<uint32_t> candidates;
    for (uint32_t t = 0; t < scene_.triangles.size(); ++t)
        if (scene_.materials[scene_.triangles[t].material].emits && scene_.is_gathered(t)) candidates.push_back(t);
    cells_ = std::make_shared<const EmissionCells>(scene_, candidates, pool, progress);
    for (const uint32_t t : candidates) {
        const float area = scene_.area(t), power = cells_->mean(t) * area;
        if (power > 0.0f) triangles_.push_back({t, area, power, 0.0f});
    }
    emissive_count_ = static_cast<uint32_t>(triangles_.size());
}

void EmitterSet::drop_large() {
    if (triangles_.empty()) return;
    double total = 0.0;
    for (uint32_t t = 0; t < scene_.triangles.size(); ++t) total += scene_.area(t);
    std::map<uint32_t, double> by_material;
    for (const auto& t : triangles_) by_material[scene_.triangles[t.triangle].material] += t.area;
    std::erase_if(triangles_, [&](const EmissiveTriangle& t) {
        return by_material[scene_.triangles[t.triangle].material] > kLargeShare * total;
    });
}

/// Clusters never mix light sets, nor surfaces that are there at different times.
void EmitterSet::split_by_element() {
    const auto key = [&](const EmissiveTriangle& t) {
        const Instance& i = scene_.instance_of(t.triangle);
        return std::tuple(i.light_set, i.element, i.open_pose);
    };
    std::stable_sort(triangles_.begin(), triangles_.end(),
                     [&](const EmissiveTriangle& a, const EmissiveTriangle& b) { return key(a) < key(b); });
    const auto total = static_cast<uint32_t>(triangles_.size());
    for (uint32_t first = 0, end; first < total; first = end) {
        for (end = first + 1; end < total && key(triangles_[end]) == key(triangles_[first]);) ++end;
        split(first, end - first);
    }
}

Effect EmitterSet::effect(uint32_t e) const {
    switch (emitters_[e].kind) {
        case Kind::lamp:
            return is_primary(e) ? Effect::primary_lights : Effect::static_lights;
        case Kind::cluster:
            return Effect::emissive_surfaces;
        case Kind::sky:
            return Effect::sky;
        case Kind::bright:
            return Effect::bright_texels;
    }
    return Effect::rest;
}

uint32_t EmitterSet::set_of(uint32_t e) const {
    const Emitter& emitter = emitters_[e];
    if (emitter.kind == Kind::lamp) return scene_.lights[emitter.index].light_set;
    return emitter.kind == Kind::cluster ? clusters_[emitter.index].set : kNoElement;
}

std::vector<uint32_t> EmitterSet::of_set(uint32_t set) const {
    std::vector<uint32_t> out;
    for (uint32_t e = 0; e < count(); ++e)
        if (set_of(e) == set) out.push_back(e);
    return out;
}

Presence EmitterSet::presence(uint32_t e) const {
    const Kind kind = emitters_[e].kind;
    return kind == Kind::cluster || kind == Kind::bright ? clusters_[emitters_[e].index].presence : Presence{};
}

void EmitterSet::split(uint32_t first, uint32_t count) {
    if (count <= cluster_size_) return add_cluster(first, count);
    const auto centroid = [&](const EmissiveTriangle& t) {
        return scene_.position(t.triangle, 1.0f / 3.0f, 1.0f / 3.0f);
    };
    Vec3 low(1e30f), high(-1e30f);
    for (uint32_t i = first; i < first + count; ++i) {
        low = glm::min(low, centroid(triangles_[i]));
        high = glm::max(high, centroid(triangles_[i]));
    }
    const Vec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto begin = triangles_.begin() + first;
    // A full sort with the index as tie breaker keeps the order independent of the library.
    std::sort(begin, begin + count, [&](const EmissiveTriangle& a, const EmissiveTriangle& b) {
        const float ca = centroid(a)[axis], cb = centroid(b)[axis];
        return ca != cb ? ca < cb : a.triangle < b.triangle;
    });
    split(first, count / 2);
    split(first + count / 2, count - count / 2);
}

void EmitterSet::add_cluster(uint32_t first, uint32_t count) {
    Cluster c{first, count, Vec3(0.0f), 0.0f, Vec3(0.0f), 0.0f, false, 0.0f, kNoElement, {}};
    for (uint32_t i = first; i < first + count; ++i) {
        EmissiveTriangle& t = triangles_[i];
        c.power += t.power;
        t.running = c.power;
        c.axis += scene_.geometric_normal(t.triangle) * t.power;
        c.two_sided |= two_sided(scene_, t.triangle);
        c.center += scene_.position(t.triangle, 1.0f / 3.0f, 1.0f / 3.0f) / static_cast<float>(count);
    }
    for (uint32_t i = first; i < first + count; ++i)
        for (const uint32_t v : scene_.triangles[triangles_[i].triangle].vertex)
            c.radius = std::max(c.radius, glm::distance(scene_.positions[v], c.center));
    c.axis = normalize_or(c.axis, {0, 0, 1});
    c.set = scene_.instance_of(triangles_[first].triangle).light_set;
    c.presence = scene_.presence(triangles_[first].triangle);
    for (uint32_t i = first; i < first + count; ++i) {
        const EmissiveTriangle& t = triangles_[i];
        c.bend = std::max(c.bend, sine_between(scene_.geometric_normal(t.triangle), c.axis));
        triangle_density_[t.triangle] = t.power / (c.power * t.area);
        triangle_emitter_[t.triangle] = this->count();
    }
    clusters_.push_back(c);
    emitters_.push_back({Kind::cluster, static_cast<uint32_t>(clusters_.size() - 1)});
}

float EmitterSet::cluster_importance(const Cluster& c, const Vec3& p, const Vec3& n) const {
    const Vec3 to = c.center - p;
    const float distance2 = glm::dot(to, to), distance = std::max(std::sqrt(distance2), 1e-6f);
    const float cosine = std::clamp((glm::dot(to, n) + c.radius) / distance, 0.0f, 1.0f);
    float facing = 1.0f;
    if (c.bend < kFlatBend) {
        const float toward = -glm::dot(to, c.axis);
        facing = std::clamp(
            ((c.two_sided ? std::abs(toward) : toward) + c.radius * (1.0f + c.bend)) / distance + c.bend, 0.0f, 1.0f);
    }
    return c.power * cosine * facing / std::max(distance2, 0.25f * c.radius * c.radius);
}

float EmitterSet::importance(uint32_t e, const Vec3& p, const Vec3& n, float reach) const {
    const Emitter& emitter = emitters_[e];
    if (emitter.kind == Kind::lamp) return scene_.lights[emitter.index].importance(p, n, reach);
    if (emitter.kind != Kind::sky) return cluster_importance(clusters_[emitter.index], p, n);
    return 0.25f * sky_->total();
}

EmitterSample EmitterSet::sample(uint32_t e, const Vec3& p, const Vec2& u) const {
    const Emitter& emitter = emitters_[e];
    if (emitter.kind == Kind::cluster) return sample_cluster(clusters_[emitter.index], p, u);
    if (emitter.kind == Kind::bright) return sample_bright(clusters_[emitter.index], p, u);
    if (emitter.kind == Kind::sky) return sample_sky(u);
    const Light& light = scene_.lights[emitter.index];
    const LightSample s = light.sample(p, u);
    return {s.direction,
            s.distance,
            p + s.direction * s.distance,
            s.weight,
            0.0f,
            light.casts_shadow,
            light.type == Light::Type::point || light.type == Light::Type::spot,
            light.area > 0.0f && light.spread_tan == 0.0f ? light.axis : Vec3(0.0f)};
}

EmitterSample EmitterSet::sample_wide(uint32_t e, const Vec3& p, const Vec2& u) const {
    const Light& light = scene_.lights[emitters_[e].index];
    const LightSample s = sample_wide_lamp(light, p, u);
    return {s.direction, s.distance, p + s.direction * s.distance, s.weight, 0.0f, light.casts_shadow};
}

EmitterSample EmitterSet::sample_cluster(const Cluster& c, const Vec3& p, Vec2 u) const {
    const EmissiveTriangle& t = triangles_[find_triangle(c, u)];
    float spread;
    const Vec2 b = cells_->sample(t.triangle, u, spread);
    const Vec3 q = scene_.position(t.triangle, b.x, b.y), to = q - p;
    const float length2 = glm::dot(to, to);
    if (!(length2 > 0.0f)) return {};
    const float length = std::sqrt(length2);
    const Vec3 w = to / length, normal = scene_.geometric_normal(t.triangle);
    float cosine = -glm::dot(w, normal);
    if (cosine < 0.0f && two_sided(scene_, t.triangle)) cosine = -cosine;
    if (!(cosine > 0.0f)) return {};
    const float density = spread * plain_pdf(t.triangle, length, cosine);
    const Vec3 emission = scene_.emission(t.triangle, b.x, b.y);
    return {w, length, q, emission / density, density, true};
}

EmitterSample EmitterSet::sample_sky(const Vec2& u) const {
    const SkySample s = sky_->sample(u);
    if (!(s.pdf > 0.0f)) return {};
    return {s.direction, std::numeric_limits<float>::infinity(), Vec3(0.0f), s.radiance / s.pdf, s.pdf, true};
}

float EmitterSet::plain_pdf(uint32_t triangle, float distance, float cosine) const {
    return triangle_density_[triangle] * distance * distance / std::max(cosine, 1e-9f);
}

float EmitterSet::triangle_pdf(uint32_t triangle, const Vec2& uv, float distance, float cosine) const {
    return cells_->density(triangle, uv.x, uv.y) * plain_pdf(triangle, distance, cosine);
}

} // namespace ajar
