// SPDX-License-Identifier: GPL-3.0-or-later
#include "sampling/light_choice.h"

#include "base/owen_sobol.h"

namespace ajar {

namespace {

constexpr uint32_t kMostFine = 256;
constexpr float kFineShare = 0.995f;                   ///< of the tile's weight that is chosen from with care
constexpr uint32_t kMoreFine = 32;                     ///< candidates beyond it, where walls hide those
constexpr uint32_t kMostProbes = 32, kLeastProbes = 8; ///< receivers of the tile that estimate importance
constexpr uint32_t kProbedPairs = 8192;                ///< of receivers and emitters, if so few probes do
constexpr uint32_t kVisibilityRays = 16;               ///< per candidate and tile
constexpr float kVisibilityFloor = 0.05f;
constexpr float kUnseenShare = 0.25f; ///< of what the seen weigh that lamps seen by no ray may weigh together
constexpr float kTileShare = 0.01f;   ///< of the tile's weight that each receiver keeps
constexpr float kTexelReach = 0.75f;  ///< texel edges from a receiver's first position to its last

/// Rough irradiance at a receiver from an emitter whose beam may be narrower than spacing texels.
float importance_at(const EmitterSet& emitters, uint32_t emitter, const LightmapReceivers& receivers, uint32_t r,
                    float spacing) {
    return emitters.importance(emitter, receivers.origins(r)[0], receivers.frame[r].z,
                               spacing * receivers.texel_size[r]);
}

} // namespace

void LightChoice::find_candidates(const LightmapReceivers& receivers, const Tile& tile) {
    candidates_.clear();
    slot_of_.assign(emitters_.count(), EmitterSet::kNone);
    for (const uint32_t e : choices_)
        if (roles_ == LightRoles::all || (roles_ == LightRoles::stored && !emitters_.is_primary(e)) ||
            (roles_ == LightRoles::reflected && emitters_.is_bright(e)))
            candidates_.push_back({e, 0.0f, 0.0f, {}});
    weigh_candidates(receivers, tile);
    // A tile may hold surfaces of several rooms: what counts is a lamp's share where it is strong.
    std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& a, const Candidate& b) {
        return a.share != b.share ? a.share > b.share : a.emitter < b.emitter;
    });
    float sum = 0.0f, all = 0.0f;
    for (const Candidate& c : candidates_) all += c.share;
    for (fine_ = 0; fine_ < std::min<size_t>(candidates_.size(), kMostFine) && sum <= kFineShare * all; ++fine_)
        sum += candidates_[fine_].share;
    for (uint32_t i = 0; i < candidates_.size(); ++i) slot_of_[candidates_[i].emitter] = i;
}

void LightChoice::weigh_candidates(const LightmapReceivers& receivers, const Tile& tile) {
    if (candidates_.empty()) return;
    const auto pairs = kProbedPairs / static_cast<uint32_t>(candidates_.size());
    const uint32_t probes = std::min(std::clamp(pairs, kLeastProbes, kMostProbes), tile.count);
    // Each probe speaks for the receivers about it: a narrow beam falls between them.
    const float spacing = std::sqrt(static_cast<float>(tile.count) / static_cast<float>(probes));
    for (uint32_t i = 0; i < probes; ++i) {
        const uint32_t r = tile.first + static_cast<uint32_t>(uint64_t{i} * tile.count / probes);
        float here = 0.0f;
        for (Candidate& c : candidates_) {
            c.running.push_back(importance_at(emitters_, c.emitter, receivers, r, spacing));
            here += c.running.back();
        }
        for (Candidate& c : candidates_) c.share += here > 0.0f ? c.running.back() / here : 0.0f;
    }
    float total = 0.0f;
    for (Candidate& c : candidates_) {
        for (uint32_t i = 1; i < probes; ++i) c.running[i] += c.running[i - 1];
        total += c.weight = c.running.back() / static_cast<float>(probes);
    }
    // Probes can miss a lamp that only some receivers see; it keeps a small chance.
    for (Candidate& c : candidates_) c.weight += 1e-3f * total / static_cast<float>(candidates_.size()) + 1e-20f;
}

/// A receiver of the tile, where a candidate matters most likely one near a probe that it matters to.
uint32_t LightChoice::place_of(const Candidate& c, const Tile& tile, const Vec2& u) {
    const auto probes = static_cast<uint32_t>(c.running.size());
    const float target = c.running.back() > 0.0f ? u.x * c.running.back() : -1.0f;
    auto probe =
        static_cast<uint32_t>(std::upper_bound(c.running.begin(), c.running.end(), target) - c.running.begin());
    if (target < 0.0f) probe = static_cast<uint32_t>(u.x * static_cast<float>(probes));
    probe = std::min(probe, probes - 1);
    const auto first = static_cast<uint32_t>(uint64_t{probe} * tile.count / probes),
               last = static_cast<uint32_t>(uint64_t{probe + 1} * tile.count / probes);
    return tile.first + std::min(first + static_cast<uint32_t>(u.y * static_cast<float>(last - first)), last - 1);
}

LightChoice::Seen LightChoice::look(const Tracer& tracer, const LightmapReceivers& receivers, const Tile& tile,
                                    uint32_t candidate, uint32_t seed) const {
    const uint32_t emitter = candidates_[candidate].emitter, h0 = hash_combine(seed, ~candidate);
    const Working here(emitters_.effect(emitter));
    Seen seen;
    for (uint32_t i = 0; i < kVisibilityRays; ++i) {
        const uint32_t h = hash_combine(seed, (candidate << 8) | i);
        const uint32_t r = place_of(candidates_[candidate], tile, owen_sobol(i, h0));
        const Vec3 p = receivers.origins(r)[i % receivers.positions_per_texel], n = receivers.frame[r].z;
        const EmitterSample s = emitters_.sample(emitter, p, owen_sobol(i, h));
        const float cosine = glm::dot(s.direction, n);
        if (!(max_component(s.weight) > 0.0f) || cosine <= 0.0f) continue;
        ++seen.rays;
        if (s.casts_shadow && tracer.occluded({p, s.direction, 0.0f, s.distance * (1.0f - 1e-4f)}, kMaskShadowOpaque))
            continue;
        ++seen.arrived;
        const float ratio = luminance(s.weight) * cosine / std::max(emitters_.importance(emitter, p, n), 1e-30f);
        seen.sum += ratio;
        seen.squares += ratio * ratio;
    }
    return seen;
}

/// Looks for candidates in the order of their shares: those that make up most of the weight, and while walls hide
/// these, weaker ones, until what is seen outweighs what was not looked for.
std::vector<LightChoice::Seen> LightChoice::look_for_candidates(const Tracer& tracer,
                                                                const LightmapReceivers& receivers, const Tile& tile,
                                                                uint32_t seed, uint64_t& rays) {
    std::vector<Seen> all;
    double seen_weight = 0.0, rest = 0.0;
    for (const Candidate& c : candidates_) rest += c.weight;
    const size_t most = std::min<size_t>({candidates_.size(), kMostFine, fine_ + kMoreFine});
    for (uint32_t c = 0; c < most && (c < fine_ || seen_weight < rest); ++c) {
        const Seen& s = all.emplace_back(look(tracer, receivers, tile, c, seed));
        rays += s.rays;
        if (s.arrived != 0) seen_weight += candidates_[c].weight;
        rest -= candidates_[c].weight;
    }
    fine_ = static_cast<uint32_t>(all.size());
    return all;
}

uint64_t LightChoice::learn_visibility(const Tracer& tracer, const LightmapReceivers& receivers, const Tile& tile,
                                       uint32_t seed) {
    uint64_t rays = 0;
    const std::vector<Seen> all = look_for_candidates(tracer, receivers, tile, seed, rays);
    visibility_.assign(fine_, 1.0f);
    float seen_weight = 0.0f, unseen_weight = 0.0f;
    std::vector<uint32_t> unseen;
    for (uint32_t c = 0; c < fine_; ++c) {
        const Seen& s = all[c];
        visibility_[c] =
            std::max(kVisibilityFloor, (static_cast<float>(s.arrived) + 0.25f) / (static_cast<float>(s.rays) + 0.5f));
        if (s.arrived != 0)
            seen_weight += candidates_[c].weight * visibility_[c];
        else
            unseen.push_back(c), unseen_weight += candidates_[c].weight * visibility_[c];
    }
    // Behind a wall even the strongest lamp should not take the samples from a candle in the room.
    const auto scale_to = [&](float weight) {
        return seen_weight > 0.0f ? std::min(1.0f, kUnseenShare * seen_weight / std::max(weight, 1e-30f)) : 1.0f;
    };
    const float scale = scale_to(unseen_weight);
    for (const uint32_t c : unseen) visibility_[c] *= scale;
    float rest = 0.0f;
    for (size_t c = fine_; c < candidates_.size(); ++c) rest += candidates_[c].weight;
    rest_scale_ = scale_to(rest);
    seen_ = seen_weight > 0.0f || fine_ < candidates_.size();
    find_variance(all);
    return rays;
}

/// A sample brings total * ratio / visibility with chance weight * visibility / total.
void LightChoice::find_variance(const std::vector<Seen>& seen) {
    double total = 0.0, mean = 0.0, second = 0.0;
    for (uint32_t c = 0; c < fine_; ++c) {
        if (seen[c].rays == 0) continue;
        const double n = seen[c].rays, weight = candidates_[c].weight;
        total += weight * visibility_[c];
        mean += weight * seen[c].sum / n;
        second += weight * seen[c].squares / (n * visibility_[c]);
    }
    relative_variance_ = mean > 0.0 ? static_cast<float>(std::max(0.0, total * second / (mean * mean) - 1.0)) : 0.0f;
}

uint64_t LightChoice::begin(const Tracer& tracer, const LightmapReceivers& receivers, const Tile& tile, uint32_t seed) {
    base_ = 0;
    const Working here(choices_.empty() ? Effect::rest : emitters_.effect(choices_.front()));
    find_candidates(receivers, tile);
    if (candidates_.empty()) return 0;
    Worker::mine().set(emitters_.effect(candidates_.front().emitter));
    const uint64_t rays = learn_visibility(tracer, receivers, tile, seed);
    rest_running_.clear();
    float rest = 0.0f;
    for (size_t i = fine_; i < candidates_.size(); ++i)
        rest_running_.push_back(rest += rest_scale_ * candidates_[i].weight);
    running_.resize(size_t{tile.count} * (fine_ + 1));
    for (uint32_t local = 0; local < tile.count; ++local) {
        const uint32_t r = tile.first + local;
        float* row = &running_[size_t{local} * (fine_ + 1)];
        float sum = 0.0f;
        for (uint32_t c = 0; c < fine_; ++c) {
            const float here = importance_at(emitters_, candidates_[c].emitter, receivers, r, kTexelReach);
            row[c] = sum += (here + kTileShare * candidates_[c].weight) * visibility_[c];
        }
        row[fine_] = sum + rest;
    }
    return rays;
}

uint32_t LightChoice::pick(uint32_t local, float& u, float& chance) const {
    const float *row = this->row(local), total = row[fine_];
    float target = u * total;
    const auto slot = static_cast<uint32_t>(std::min<ptrdiff_t>(std::upper_bound(row, row + fine_ + 1, target) - row,
                                                                rest_running_.empty() ? fine_ - 1 : fine_));
    const float before = slot > 0 ? row[slot - 1] : 0.0f, weight = row[slot] - before;
    target -= before;
    if (slot < fine_) {
        u = std::clamp(target / std::max(weight, 1e-30f), 0.0f, 0x1.fffffep-1f);
        chance = weight / total;
        return candidates_[slot].emitter;
    }
    const auto i = static_cast<size_t>(std::min<ptrdiff_t>(
        std::upper_bound(rest_running_.begin(), rest_running_.end(), target) - rest_running_.begin(),
        static_cast<ptrdiff_t>(rest_running_.size()) - 1));
    const float first = i > 0 ? rest_running_[i - 1] : 0.0f, share = rest_running_[i] - first;
    u = std::clamp((target - first) / std::max(share, 1e-30f), 0.0f, 0x1.fffffep-1f);
    chance = share / total;
    return candidates_[fine_ + i].emitter;
}

float LightChoice::chance(uint32_t local, uint32_t emitter) const {
    if (candidates_.empty() || slot_of_[emitter] == EmitterSet::kNone) return 0.0f;
    const uint32_t slot = slot_of_[emitter];
    const float* row = this->row(local);
    if (slot < fine_) return (row[slot] - (slot > 0 ? row[slot - 1] : 0.0f)) / row[fine_];
    const size_t i = slot - fine_;
    return (rest_running_[i] - (i > 0 ? rest_running_[i - 1] : 0.0f)) / row[fine_];
}

} // namespace ajar
