// SPDX-License-Identifier: GPL-3.0-or-later
#include "pass/packet_noise.h"

namespace ajar {

namespace {

constexpr uint32_t kPool = 4; ///< packets whose noise speaks for each of them
/// Variance of a receiver over the next one's of its packet from which on its light is rare. Rooms whose light comes
/// through holes of 5 to 20 cm (tests/hard/hard_holes.cpp) get the same with 1.5 and with 16.
constexpr double kRare = 4.0;

/// Takes the rare light out of a tile's packets, if there is much of it; returns what each has on average.
RareLight share_rare_light(const TileEstimate& t, uint32_t lanes, const NoiseGoal& goal,
                           std::vector<MeasuredNoise>& packets) {
    std::vector<RareLight> met;
    RareLight mean;
    float level = 0.0f;
    const float share = 1.0f / static_cast<float>(packets.size());
    for (uint32_t p = 0; p < packets.size(); ++p) {
        met.push_back(rare_light(t, p * kLanes, std::min((p + 1) * kLanes, lanes)));
        mean.add(met[p], share), level += packets[p].level * share;
    }
    const float noise = goal.target * (level + goal.dark);
    if (goal.rare.level > mean.level + noise) mean = goal.rare;
    if (!(mean.level > noise)) return {};
    for (size_t p = 0; p < packets.size(); ++p)
        packets[p].level -= met[p].level, packets[p].gather_variance -= met[p].variance;
    return mean;
}

} // namespace

MeasuredNoise mean_noise(const TileEstimate& t, uint32_t first, uint32_t end) {
    MeasuredNoise out{};
    const float share = 1.0f / static_cast<float>(end - first);
    for (uint32_t lane = first; lane < end; ++lane) {
        out.level += luminance(t.irradiance(lane)) * share;
        out.gather_variance += static_cast<float>(t.gather_variance(lane)) * share;
        out.direct_variance += static_cast<float>(t.direct_variance(lane)) * share;
    }
    return out;
}

RareLight rare_light(const TileEstimate& t, uint32_t first, uint32_t end) {
    if (end - first < 2) return {};
    uint32_t most = first;
    for (uint32_t lane = first; lane < end; ++lane)
        if (t.gather_variance(lane) > t.gather_variance(most)) most = lane;
    double next = 0.0;
    float others = 0.0f;
    for (uint32_t lane = first; lane < end; ++lane) {
        if (lane == most) continue;
        next = std::max(next, t.gather_variance(lane));
        others += luminance(gathered(*t.gather, lane)) / static_cast<float>(end - first - 1);
    }
    if (!(t.gather_variance(most) > kRare * next)) return {};
    const float share = 1.0f / static_cast<float>(end - first);
    return {std::max(luminance(gathered(*t.gather, most)) - others, 0.0f) * share,
            static_cast<float>(t.gather_variance(most) - next) * share};
}

RareLight mean_rare_light(const std::vector<RareLight>& parts, uint32_t measured_rays, uint32_t rays) {
    RareLight mean;
    for (const RareLight& r : parts) mean.add(r, 1.0f / static_cast<float>(parts.size()));
    // Few hits are independent: strata do not help.
    mean.variance *= static_cast<float>(measured_rays) / static_cast<float>(std::max(rays, 1u));
    return mean;
}

float mean_level(const std::vector<MeasuredNoise>& parts) {
    float mean = 0.0f;
    for (const MeasuredNoise& p : parts) mean += p.level / static_cast<float>(parts.size());
    return mean;
}

std::vector<MeasuredNoise> packet_noise(const TileEstimate& t, uint32_t lanes, const NoiseGoal& goal) {
    std::vector<MeasuredNoise> own((lanes + kLanes - 1) / kLanes);
    for (uint32_t p = 0; p < own.size(); ++p) own[p] = mean_noise(t, p * kLanes, std::min((p + 1) * kLanes, lanes));
    const RareLight rare = share_rare_light(t, lanes, goal, own);
    std::vector<MeasuredNoise> pooled = own;
    for (size_t p = 0; p < own.size(); ++p) {
        const size_t first = p / kPool * kPool, end = std::min(first + kPool, own.size());
        float gather = 0.0f, direct = 0.0f;
        for (size_t q = first; q < end; ++q) gather += own[q].gather_variance, direct += own[q].direct_variance;
        pooled[p].level += rare.level;
        pooled[p].gather_variance =
            std::max(own[p].gather_variance, gather / static_cast<float>(end - first)) + rare.variance;
        pooled[p].direct_variance = std::max(own[p].direct_variance, direct / static_cast<float>(end - first));
    }
    return pooled;
}

} // namespace ajar
