// SPDX-License-Identifier: GPL-3.0-or-later
// Bright texels as emitters: a lamp close to a wall leaves a spot that few gather rays find; aimed
// at, it costs no more noise than an area lamp. MIS keeps the sum with the gather unbiased.
#include "sampling/emitters.h"

namespace ajar {

namespace {

constexpr uint32_t kClusterTexels = 16;
constexpr float kClusterNormal = 0.98f;
constexpr float kClusterSpan = 6.0f; ///< texel edges

float area_of(const BrightTexel& t) { return glm::length(glm::cross(t.edge_x, t.edge_y)); }

bool joins(const BrightTexel& first, const BrightTexel& next) {
    const float span = kClusterSpan * glm::length(first.edge_x);
    if (first.presence.element != next.presence.element || first.presence.state != next.presence.state) return false;
    return glm::dot(first.normal, next.normal) > kClusterNormal && glm::length(next.center - first.center) < span;
}

} // namespace

EmitterSet EmitterSet::with_bright_texels(std::vector<BrightTexel> texels) const {
    EmitterSet out(*this);
    out.bright_ = std::move(texels);
    out.bright_running_.resize(out.bright_.size());
    out.bright_index_.assign(out.bright_.empty() ? 0 : scene_.texel_count(), kNone);
    const auto total = static_cast<uint32_t>(out.bright_.size());
    for (uint32_t first = 0, end; first < total; first = end) {
        for (end = first + 1;
             end < total && end - first < kClusterTexels && joins(out.bright_[first], out.bright_[end]);)
            ++end;
        out.add_bright_cluster(first, end - first);
    }
    return out;
}

void EmitterSet::add_bright_cluster(uint32_t first, uint32_t count) {
    Cluster c{first, count, Vec3(0.0f), 0.0f, Vec3(0.0f), 0.0f, false, 0.0f, kNoElement, {}};
    for (uint32_t i = first; i < first + count; ++i) {
        const BrightTexel& t = bright_[i];
        c.power += luminance(t.radiance) * area_of(t);
        bright_running_[i] = c.power;
        c.axis += t.normal;
        c.center += t.center / static_cast<float>(count);
    }
    for (uint32_t i = first; i < first + count; ++i) {
        const BrightTexel& t = bright_[i];
        const float half = 0.5f * std::max(glm::length(t.edge_x + t.edge_y), glm::length(t.edge_x - t.edge_y));
        c.radius = std::max(c.radius, glm::distance(t.center, c.center) + half);
    }
    c.axis = normalize_or(c.axis, bright_[first].normal);
    c.presence = bright_[first].presence;
    for (uint32_t i = first; i < first + count; ++i) {
        bright_index_[bright_[i].texel] = static_cast<uint32_t>(bright_entries_.size());
        bright_entries_.push_back({this->count(), luminance(bright_[i].radiance) / c.power});
        c.bend = std::max(c.bend, sine_between(bright_[i].normal, c.axis));
    }
    clusters_.push_back(c);
    emitters_.push_back({Kind::bright, static_cast<uint32_t>(clusters_.size() - 1)});
}

uint32_t EmitterSet::bright_emitter(uint32_t texel, float& density) const {
    if (bright_index_.empty() || bright_index_[texel] == kNone) return kNone;
    const BrightEntry& e = bright_entries_[bright_index_[texel]];
    density = e.density;
    return e.emitter;
}

EmitterSample EmitterSet::sample_bright(const Cluster& c, const Vec3& p, Vec2 u) const {
    const float target = u.x * c.power;
    uint32_t i = c.first;
    while (i + 1 < c.first + c.count && bright_running_[i] <= target) ++i;
    const BrightTexel& t = bright_[i];
    const float before = i > c.first ? bright_running_[i - 1] : 0.0f;
    u.x = std::clamp((target - before) / std::max(bright_running_[i] - before, 1e-30f), 0.0f, 0x1.fffffep-1f);
    const Vec3 q = t.center + (u.x - 0.5f) * t.edge_x + (u.y - 0.5f) * t.edge_y, to = q - p;
    const float length2 = glm::dot(to, to);
    if (!(length2 > 0.0f)) return {};
    const float length = std::sqrt(length2);
    const float cosine = -glm::dot(to, t.normal) / length;
    if (!(cosine > 0.0f)) return {};
    const float density = luminance(t.radiance) / c.power * length2 / cosine;
    return {to / length, length, q, t.radiance / density, density, true, false, Vec3(0.0f), t.texel, 1.0f / density};
}

} // namespace ajar
