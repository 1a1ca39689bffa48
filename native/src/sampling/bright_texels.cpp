// SPDX-License-Identifier: GPL-3.0-or-later
// Bright texels as emitters: a lamp close to a wall leaves a spot that few gather rays find; aimed
// at, it costs no more noise than an area lamp. MIS keeps the sum with the gather unbiased.
#include "sampling/emitters.h"

namespace ajar {

namespace {

constexpr uint32_t kClusterTexels = 16;
constexpr float kClusterNormal = 0.98f;
constexpr float kClusterSpan = 6.0f; ///< texel edges

bool joins(const BrightPatch& first, const BrightPatch& next) {
    const float span = kClusterSpan * glm::length(first.edge_x);
    if (first.presence.element != next.presence.element || first.presence.state != next.presence.state) return false;
    return glm::dot(first.normal, next.normal) > kClusterNormal && glm::distance(next.center(), first.center()) < span;
}

} // namespace

Vec3 BrightPatch::center() const {
    Vec2 sum(0.0f);
    for (int i = 0; i < shape.count; ++i) sum += shape.corner[i];
    return at(sum / static_cast<float>(std::max(shape.count, 1)));
}

EmitterSet EmitterSet::with_bright_texels(std::vector<BrightPatch> patches) const {
    EmitterSet out(*this);
    out.bright_ = std::move(patches);
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
        const BrightPatch& t = bright_[i];
        c.power += luminance(t.radiance) * t.area();
        bright_running_[i] = c.power;
        c.axis += t.normal;
        c.center += t.center() / static_cast<float>(count);
    }
    for (uint32_t i = first; i < first + count; ++i) {
        const BrightPatch& t = bright_[i];
        for (int k = 0; k < t.shape.count; ++k)
            c.radius = std::max(c.radius, glm::distance(t.at(t.shape.corner[k]), c.center));
    }
    c.axis = normalize_or(c.axis, bright_[first].normal);
    c.presence = bright_[first].presence;
    for (uint32_t i = first; i < first + count; ++i) {
        const BrightPatch& t = bright_[i];
        if (bright_index_[t.texel] == kNone) bright_index_[t.texel] = static_cast<uint32_t>(bright_entries_.size());
        bright_entries_.push_back({t.texel, t.triangle, this->count(), luminance(t.radiance) / c.power});
        c.bend = std::max(c.bend, sine_between(t.normal, c.axis));
    }
    clusters_.push_back(c);
    emitters_.push_back({Kind::bright, static_cast<uint32_t>(clusters_.size() - 1)});
}

uint32_t EmitterSet::bright_emitter(uint32_t texel, uint32_t triangle, float& density) const {
    if (bright_index_.empty()) return kNone;
    for (size_t i = bright_index_[texel]; i < bright_entries_.size() && bright_entries_[i].texel == texel; ++i)
        if (bright_entries_[i].triangle == triangle) {
            density = bright_entries_[i].density;
            return bright_entries_[i].emitter;
        }
    return kNone;
}

EmitterSample EmitterSet::sample_bright(const Cluster& c, const Vec3& p, Vec2 u) const {
    const float target = u.x * c.power;
    uint32_t i = c.first;
    while (i + 1 < c.first + c.count && bright_running_[i] <= target) ++i;
    const BrightPatch& t = bright_[i];
    const float before = i > c.first ? bright_running_[i - 1] : 0.0f;
    u.x = std::clamp((target - before) / std::max(bright_running_[i] - before, 1e-30f), 0.0f, 0x1.fffffep-1f);
    const Vec3 q = t.at(t.shape.sample(u)), to = q - p;
    const float length2 = glm::dot(to, to);
    if (!(length2 > 0.0f)) return {};
    const float length = std::sqrt(length2);
    const float cosine = -glm::dot(to, t.normal) / length;
    if (!(cosine > 0.0f)) return {};
    const float density = luminance(t.radiance) / c.power * length2 / cosine;
    return {to / length, length, q, t.radiance / density, density, true, false, Vec3(0.0f), t.texel, 1.0f / density};
}

} // namespace ajar
