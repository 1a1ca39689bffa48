// SPDX-License-Identifier: GPL-3.0-or-later
#include "pass/bake_parts.h"

#include <bit>

namespace ajar {

namespace {

constexpr double kBounceShare = 0.2; ///< most of the time left that bounces after the first may take
constexpr uint32_t kLeastBounceSamples = 16;
constexpr uint32_t kLeastRingRays = 16;
constexpr float kQuadNormal = 0.95f; ///< receivers of a 2x2 block share bounce rays if their normals agree

} // namespace

bool may_share(const LightmapReceivers& receivers, uint32_t a, uint32_t b) {
    return receivers.shares[a] != 0 && receivers.shares[b] != 0 &&
           glm::dot(receivers.frame[a].z, receivers.frame[b].z) >= kQuadNormal;
}

RayPlan ring_rays(const RayPlan& plan) {
    const auto part = [](uint32_t rays) {
        return std::bit_floor(std::max(rays / kRingShare, std::min(rays, kLeastRingRays)));
    };
    return {part(plan.gather), part(plan.direct)};
}

std::vector<double> ray_weights(const LightmapReceivers& receivers) {
    std::vector<double> weights;
    for (const Tile& tile : receivers.tiles) {
        const TileParts parts = split(receivers, tile);
        weights.push_back(parts.own.count + parts.ring.count / double{kRingShare});
    }
    return weights;
}

uint32_t part_begin(uint32_t count, uint32_t k) {
    const uint32_t packets = (count + kLanes - 1) / kLanes;
    return std::min(packets * k / kPilotParts * kLanes, count);
}

Tile tile_part(const Tile& tile, uint32_t k) {
    const uint32_t begin = part_begin(tile.count, k);
    return {tile.first + begin, part_begin(tile.count, k + 1) - begin};
}

uint32_t part_of(uint32_t count, uint32_t local) {
    uint32_t k = kPilotParts - 1;
    while (part_begin(count, k) > local) --k;
    return k;
}

Tile pilot_part(const Tile& tile, uint32_t part) {
    const uint32_t first = part_begin(tile.count, part);
    return {tile.first + first, std::min(kPilotReceivers, tile.count - first)};
}

float dark_level(std::vector<float> levels) {
    if (levels.empty()) return 0.0f;
    const auto middle = levels.begin() + static_cast<ptrdiff_t>(levels.size() / 2);
    std::nth_element(levels.begin(), middle, levels.end());
    return 0.01f * *middle;
}

float dark_level(const std::vector<MeasuredNoise>& pilot) {
    std::vector<float> levels;
    for (const MeasuredNoise& p : pilot) levels.push_back(p.level);
    return dark_level(std::move(levels));
}

GatherOptions source_options(const ajar_settings& settings, const DirectGroups& groups, uint32_t seed) {
    GatherOptions o;
    o.samples = bounce_rays(settings);
    o.emission = true;
    o.direct = &groups;
    o.seed = seed;
    return o;
}

GatherOptions bounce_options(const ajar_settings& settings, uint32_t index) {
    GatherOptions o;
    o.samples = bounce_rays(settings);
    o.unmapped_direct = index == 1;
    o.seed = hash_combine(hash_combine(settings.seed, kSaltBounce), index);
    return o;
}

uint64_t begin_bounce(const GatherScene& scene, const Tile& tile, GatherOptions& options, DirectGroups& groups) {
    const uint32_t samples = std::max(options.samples / kBrightShare, 1u);
    options.direct = &groups;
    return groups.begin(scene.tracer, scene.receivers, tile, samples, samples,
                        hash_combine(options.seed, scene.receivers.texel[tile.first]));
}

GatherOptions final_options(const RayPlan& plan, const ajar_settings& settings, const DirectGroups& groups,
                            uint32_t seed) {
    GatherOptions o;
    o.samples = plan.gather;
    o.share = kFinalShare;
    o.emission = true;
    o.unmapped_direct = settings.bounces > 0;
    o.direct = &groups;
    o.seed = seed;
    return o;
}

uint32_t bounce_samples_in_time(const ajar_settings& settings, double start, double now, uint32_t passes_left) {
    uint32_t samples = settings.bounce_samples;
    if (!(settings.time_limit > 0.0f)) return samples;
    const double allowed = kBounceShare * std::max(settings.time_limit - now, 0.0);
    for (double seconds = (now - start) * passes_left; seconds > allowed && samples > kLeastBounceSamples; seconds /= 2)
        samples /= 2;
    return samples;
}

void run_bounces(uint32_t count, ajar_settings& settings, const Progress& progress, TrialTimes& trial,
                 const std::function<void(uint32_t)>& bounce) {
    const uint32_t wanted = settings.bounce_samples;
    if (settings.trial != 0) settings.bounce_samples = trial_bounce_samples(wanted);
    const double rays = settings.bounce_samples;
    for (uint32_t b = 1; b < count; ++b) {
        const double start = progress.elapsed();
        bounce(b);
        if (settings.trial != 0)
            trial.bounces += (progress.elapsed() - start) * wanted / rays;
        else
            settings.bounce_samples = bounce_samples_in_time(settings, start, progress.elapsed(), count - 1 - b);
    }
}

} // namespace ajar
