// SPDX-License-Identifier: GPL-3.0-or-later
// The rays of one tile: which of its light sets and doors get how many.
#include "pass/term_estimate.h"

namespace ajar {

namespace {

constexpr uint32_t kDarkSamples = 2; ///< per receiver and set, where the source pass found the set dark
constexpr float kEvenLight = 0.8f;   ///< least over most light of neighbours that lie in no shadow's edge
constexpr float kFullShare = 0.125f; ///< of a place's light: light sets with less get fewer samples, in proportion
constexpr uint32_t kFewSamples = 4;  ///< per receiver, of such sets
constexpr float kPlanShare = 0.1f;   ///< terms below this share of a tile's light do not drive its ray counts

/// Luminance that receivers first to end of a tile probably get from some emitters, summed.
float expected_light(const LightChoice& emitters, uint32_t first, uint32_t end) {
    float sum = 0.0f;
    for (uint32_t lane = first; lane < end; ++lane) sum += emitters.expected_light(lane);
    return sum;
}

} // namespace

/// Light sets that shine on the tile directly, as the source pass saw it.
std::vector<uint32_t> TermBaker::sets_of(const Tile& tile) const {
    std::vector<uint32_t> sets;
    for (uint32_t r = tile.first; r < tile.first + tile.count; ++r)
        for (const TermColor* e = direct_.begin(r); e != direct_.end(r); ++e)
            if (table_[e->term].set() != kNoElement) sets.push_back(table_[e->term].set());
    std::sort(sets.begin(), sets.end());
    sets.erase(std::unique(sets.begin(), sets.end()), sets.end());
    return sets;
}

/// Whether some receivers of a tile are lit alike by a set, as the source pass saw it: while no switchable thing
/// is there, and in what these change.
struct TermBaker::Evenness {
    float least[2], most[2];
    float sum = 0.0f; ///< over the receivers

    Evenness() {
        std::fill(least, least + 2, std::numeric_limits<float>::infinity());
        std::fill(most, most + 2, 0.0f);
    }
    void add(int part, float light) {
        least[part] = std::min(least[part], light), most[part] = std::max(most[part], light);
        sum += light;
    }
    bool is_dark() const { return most[0] == 0.0f && most[1] == 0.0f; }
    bool is_even() const { return least[0] >= kEvenLight * most[0] && least[1] >= kEvenLight * most[1]; }
};

TermBaker::Evenness TermBaker::evenness(uint32_t set, uint32_t begin, uint32_t end) const {
    Evenness out;
    for (uint32_t r = begin; r < end; ++r) {
        float light[2] = {};
        for (const TermColor* e = direct_.begin(r); e != direct_.end(r); ++e)
            if (const Term& term = table_[e->term]; term.set() == set)
                light[term.switch_count() != 0] += std::abs(luminance(e->color));
        for (int part = 0; part < 2; ++part) out.add(part, light[part]);
    }
    return out;
}

/// Light that receivers begin to end will store, luminance, summed, or less: the source pass does not tell the lamps
/// of no set apart whose direct light is stored and those whose is not.
float TermBaker::stored_light(uint32_t begin, uint32_t end) const {
    float sum = 0.0f;
    for (uint32_t r = begin; r < end; ++r) {
        sum += luminance(source_.total(table_, r));
        if (!has_primary_) continue;
        for (const TermColor* e = direct_.begin(r); e != direct_.end(r); ++e)
            if (table_[e->term].set() == kNoElement) sum -= luminance(e->color);
    }
    return sum;
}

float TermBaker::limit_set(DirectGroups& groups, const DirectGroups::Group& g, const Tile& tile, uint32_t first,
                           uint32_t end) const {
    const Evenness seen = evenness(g.set, tile.first + first, tile.first + end);
    if (seen.is_dark())
        groups.limit(g.set, first / kLanes, kDarkSamples);
    else if (seen.is_even())
        groups.limit(g.set, first / kLanes, std::max(g.samples / 4, kDarkSamples));
    return seen.sum;
}

/// For the packet of receivers first to end of a tile: where the source pass met no light of a set, or much the same
/// everywhere, few samples of the set do; and so they do where a group is a small part of the light: its noise may be
/// as much larger (pilot_noise). The source pass knows no bright texels, which are of no set: of that group counts
/// what its emitters are expected to bring.
void TermBaker::limit_samples(DirectGroups& groups, const Tile& tile, uint32_t first, uint32_t end) const {
    const uint32_t packet = first / kLanes;
    const float full = kFullShare * stored_light(tile.first + first, tile.first + end);
    for (const DirectGroups::Group& g : groups.groups()) {
        const float light =
            g.set == kNoElement ? expected_light(g.choice, first, end) : limit_set(groups, g, tile, first, end);
        if (light < full)
            groups.limit(
                g.set, packet,
                std::max(kFewSamples, static_cast<uint32_t>(std::ceil(static_cast<float>(g.samples) * light / full))));
    }
}

/// The tile's emitters, with visibility asked for.
DirectGroups TermBaker::look_around(const Tile& tile, uint32_t seed) const {
    DirectGroups groups(*final_emitters_, LightRoles::stored, guide().sets_of(tile));
    progress_.add_rays(
        groups.begin(s_.tracer, s_.receivers, tile, 1, 1, hash_combine(seed, s_.receivers.texel[tile.first])));
    return groups;
}

/// Shares samples per receiver out to the receivers of a part of the tile, which count from its first from then on.
void TermBaker::share_samples(DirectGroups& groups, const Tile& tile, const Tile& part, uint32_t samples) const {
    groups.start_at(0);
    groups.allot(samples, samples);
    const uint32_t begin = part.first - tile.first, end = begin + part.count;
    for (uint32_t first = begin; first < end; first += kLanes)
        guide().limit_samples(groups, tile, first, std::min(first + kLanes, tile.count));
    groups.start_at(begin);
}

TermBaker::Estimate TermBaker::estimate(const Tile& tile, const RayPlan& plan, const DirectGroups& groups,
                                        const std::vector<uint32_t>& doors, uint32_t seed) const {
    Estimate t(table_);
    t.plan = plan;
    const GatherScene scene = final_scene();
    uint64_t rays = 0;
    const TermRows* rows = settings_.bounces > 0 ? &radiance_ : nullptr;
    const TileAims aims = aim_at(doors, tile, plan.gather);
    const TileAims* aimed = aims.empty() ? nullptr : &aims;
    rays += sample_direct(scene, groups, tile, {static_cast<float>(plan.gather), kFinalShare, aimed}, seed, false, rows,
                          limits_at(tile), t.direct);
    if (plan.gather != 0) {
        GatherOptions o = final_options(plan, settings_, groups, seed);
        o.aims = aimed;
        rays += gather_tile(scene, tile, o, rows, limits_at(tile), t.gather);
    }
    progress_.add_rays(rays);
    t.finish(tile.count);
    return t;
}

/// What drives a tile's ray counts: all light together, and each term that is a fair part of it. Of the variance
/// that all light may have, a term may have as large a part as it has of the light: dim terms may be noisier.
/// Products of elements are made of the same samples as what they change, and add nothing that those do not tell.
MeasuredNoise TermBaker::pilot_noise(const Estimate& t, uint32_t lanes) {
    const float share = 1.0f / static_cast<float>(lanes);
    MeasuredNoise p;
    for (uint32_t lane = 0; lane < lanes; ++lane) {
        p.level += std::max(0.0f, luminance(t.total(lane))) * share;
        p.gather_variance += static_cast<float>(t.gather_variance(t.gather.total_squares(lane))) * share;
        p.direct_variance += static_cast<float>(t.direct.total_squares(lane)) * share;
    }
    for (size_t term = 0; term < t.terms.size(); ++term) {
        if (t.terms[term].order() >= 2) continue;
        float level = 0.0f;
        double gather = 0.0, direct = 0.0;
        for (uint32_t lane = 0; lane < lanes; ++lane) {
            level += std::abs(luminance(t.irradiance(term, lane))) * share;
            if (const auto* b = t.gathered(term, lane)) gather += t.gather_variance(b->squares) * share;
            if (const auto* b = t.sampled(term, lane)) direct += std::max(b->squares, 0.0) * share;
        }
        if (level < kPlanShare * p.level || !(level > 0.0f)) continue;
        const double scale = double(p.level) / level;
        p.gather_variance = std::max(p.gather_variance, static_cast<float>(gather * scale));
        p.direct_variance = std::max(p.direct_variance, static_cast<float>(direct * scale));
    }
    return p;
}

NoiseTrial TermBaker::try_noise(const Tile& tile, const Tile& part, const MeasuredNoise& few, const RayPlan& rays,
                                DirectGroups groups, const std::vector<uint32_t>& doors) const {
    const uint32_t seed = hash_combine(settings_.seed, kSaltPilot);
    share_samples(groups, tile, part, rays.direct);
    const Estimate a = estimate(part, rays, groups, doors, hash_combine(seed, 1)),
                   b = estimate(part, rays, groups, doors, hash_combine(seed, 2));
    NoiseTrial trial{few, pilot_noise(a, part.count), {}, {}};
    const float half = 0.5f / static_cast<float>(part.count);
    for (uint32_t lane = 0; lane < part.count; ++lane) {
        for (const Estimate* e : {&a, &b}) {
            trial.strata.gather_variance +=
                half * static_cast<float>(e->gather_variance(e->gather.total_squares(lane)));
            trial.strata.direct_variance += half * static_cast<float>(e->direct.total_squares(lane));
        }
        const float g = luminance(a.gathered_total(lane) - b.gathered_total(lane)),
                    d = luminance(a.sampled_total(lane) - b.sampled_total(lane));
        trial.twin.gather_variance += half * g * g, trial.twin.direct_variance += half * d * d;
    }
    return trial;
}

std::vector<TilePlan> TermBaker::plan_rays() {
    const size_t count = s_.receivers.tiles.size();
    TilePlan same;
    same.fill({gathers() ? settings_.samples : 0, settings_.direct_samples});
    std::vector<TilePlan> plan(count, same);
    if (!spares_rays(settings_)) return plan;
    std::vector<MeasuredNoise> pilot(count * kPilotParts);
    const uint64_t rays_before = progress_.rays();
    const double start = progress_.elapsed();
    const RayPlan most{settings_.samples, settings_.direct_samples}, small = pilot_rays(most, gathers()),
                                                                     large = trial_rays(most, gathers());
    std::vector<NoiseTrial> trials((count + kTrialStep - 1) / kTrialStep);
    pool_.for_each(count, progress_, [&](size_t i) {
        const Tile& tile = s_.receivers.tiles[i];
        const uint32_t seed = hash_combine(settings_.seed, kSaltPilot);
        DirectGroups groups = look_around(tile, seed);
        const Tile typical = split(s_.receivers, tile).typical();
        for (uint32_t k = 0; k < kPilotParts; ++k) {
            const Tile part = pilot_part(typical, k);
            const std::vector<uint32_t>& doors = doors_of(i, part);
            share_samples(groups, tile, part, small.direct);
            pilot[i * kPilotParts + k] = pilot_noise(estimate(part, small, groups, doors, seed), part.count);
            if (is_trial(i, k))
                trials[i / kTrialStep] = try_noise(tile, part, pilot[i * kPilotParts + k], large, groups, doors);
        }
    });
    pilot_pace_ =
        (progress_.elapsed() - start) / std::max<double>(1.0, static_cast<double>(progress_.rays() - rays_before));
    const NoiseGoal goal{settings_.noise_target / kPartSpread, dark_level(pilot), most, gathers(),
                         fit_noise_model(trials, small, large)};
    if (settings_.noise_target > 0.0f) plan = plan_tiles(pilot, small, goal);
    if (settings_.time_limit > 0.0f)
        pace_ = std::make_unique<TilePace>(std::move(pilot), small, ray_weights(s_.receivers), goal, plan);
    return plan;
}

} // namespace ajar
