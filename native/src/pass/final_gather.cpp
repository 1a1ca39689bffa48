// SPDX-License-Identifier: GPL-3.0-or-later
// The final gather of a scene without elements: first rays for every receiver, more for those packets
// of receivers whose light is still too noisy.
#include <array>
#include <numeric>

#include "pass/bake.h"
#include "pass/missed_light.h"
#include "pass/packet_noise.h"
#include "pass/twin_check.h"

namespace ajar {

namespace {

constexpr uint32_t kPackets = kTileReceivers / kLanes;
/// Where no ray met light the pilot looks again, so often at most and while all looks together took fewer rays: with
/// one look at a floor of 32 x 32 texels, 70 % of the sky through a hole of 5 cm, 3 m above it, were lost, with these
/// 6 +- 6 %.
constexpr uint32_t kMostLooks = 64;
constexpr uint64_t kRaysInTheDark = 1 << 20;
constexpr size_t kPilotTiles = 2048;           ///< that the pilot looks at, of scenes with more than twice as many
using Packets = std::array<uint8_t, kPackets>; ///< marks

} // namespace

TileEstimate Baker::estimate(const Tile& tile, RayPlan plan, DirectGroups& groups, PacketChoice packets, uint32_t seed,
                             bool keep_sh) {
    groups.allot(plan.direct, plan.direct);
    plan.direct = groups.groups()[0].samples;
    TileEstimate t{make_sums(keep_sh), make_sums(keep_sh), plan};
    const GatherScene scene = final_scene();
    uint64_t rays = sample_direct(scene, groups.groups()[0], tile, {static_cast<float>(plan.gather), kFinalShare}, seed,
                                  packets, *t.direct);
    if (plan.gather != 0) {
        GatherOptions o = final_options(plan, settings_, groups, seed);
        o.packets = packets;
        rays += gather_tile(scene, tile, o, settings_.bounces > 0 ? radiance_.data() : nullptr, *t.gather);
    }
    progress_.add_rays(rays);
    return t;
}

/// Emitters of a tile, with visibility asked for.
DirectGroups Baker::look_around(const Tile& tile, uint32_t seed) {
    DirectGroups groups(*final_emitters_, LightRoles::stored, {});
    progress_.add_rays(
        groups.begin(s_.tracer, s_.receivers, tile, 1, 1, hash_combine(seed, s_.receivers.texel[tile.first])));
    return groups;
}

NoiseTrial Baker::try_noise(const Tile& part, const MeasuredNoise& few, const RayPlan& rays, DirectGroups& groups,
                            uint32_t seed) {
    NoiseTrial trial{few, {}, {}, {}};
    const TileEstimate a = estimate(part, rays, groups, {}, hash_combine(seed, 1), false),
                       b = estimate(part, rays, groups, {}, hash_combine(seed, 2), false);
    trial.many = mean_noise(a, 0, part.count);
    trial.strata = mean_noise(b, 0, part.count);
    trial.strata.gather_variance = 0.5f * (trial.strata.gather_variance + trial.many.gather_variance);
    trial.strata.direct_variance = 0.5f * (trial.strata.direct_variance + trial.many.direct_variance);
    for (uint32_t lane = 0; lane < part.count; ++lane) {
        const auto half_square = [&](const Vec3& d) {
            return 0.5f * luminance(d) * luminance(d) / static_cast<float>(part.count);
        };
        trial.twin.gather_variance += half_square(gathered(*a.gather, lane) - gathered(*b.gather, lane));
        trial.twin.direct_variance +=
            half_square((sum_of(*a.direct, lane) - sum_of(*b.direct, lane)) / std::max(1.0f, float(rays.direct)));
    }
    return trial;
}

/// Calls visit(index, part, groups) for the pilot's parts of tiles; groups: the emitters of the part's tile.
template <class Visit>
void Baker::visit_parts(const std::vector<Tile>& tiles, uint32_t seed, bool shows_progress, Visit&& visit) {
    pool_.for_each(
        tiles.size(), progress_,
        [&](size_t i) {
            DirectGroups groups = look_around(tiles[i], seed);
            const Tile typical = split(s_.receivers, tiles[i]).typical();
            for (uint32_t k = 0; k < kPilotParts; ++k) {
                const Tile part = pilot_part(typical, k);
                groups.start_at(part.first - tiles[i].first);
                visit(i * kPilotParts + k, part, groups);
            }
        },
        shows_progress);
}

/// The scene's rare light, found with more rays than the pilot's, and again where they met none.
RareLight Baker::look_for_rare_light(const std::vector<Tile>& tiles, const RayPlan& rays) {
    const uint64_t enough = progress_.rays() + kRaysInTheDark;
    std::vector<RareLight> parts(tiles.size() * kPilotParts);
    RareLight found;
    for (uint32_t look = 0; look < kMostLooks && !(found.level > 0.0f); ++look) {
        if (look > 0 && progress_.rays() >= enough) break;
        const uint32_t seed = hash_combine(hash_combine(settings_.seed, kSaltRareLight), look);
        visit_parts(tiles, seed, false, [&](size_t i, const Tile& part, DirectGroups& groups) {
            parts[i] = rare_light(estimate(part, rays, groups, {}, seed, false), 0, part.count);
        });
        found = mean_rare_light(parts, rays.gather, first_.gather);
    }
    return found;
}

/// Pilot: few receivers of some tiles with few rays, discarded afterwards. They say what is dark, and what the
/// rays that the noise aimed at needs will cost.
void Baker::plan_rays() {
    const bool timed = settings_.time_limit > 0.0f;
    goal_ = {settings_.noise_target / kPacketSpread, 0.0f, {settings_.samples, settings_.direct_samples}, gathers()};
    first_ = goal_.most;
    if (!goal_.gathers) first_.gather = 0;
    if (!(goal_.target > 0.0f) && !timed) return;
    if (goal_.target > 0.0f)
        first_ = {std::min(first_.gather, kFirstRays.gather), std::min(first_.direct, kFirstRays.direct)};

    std::vector<Tile> tiles;
    const size_t step = std::max<size_t>(s_.receivers.tiles.size() / kPilotTiles, 1);
    for (size_t i = 0; i < s_.receivers.tiles.size(); i += step) tiles.push_back(s_.receivers.tiles[i]);
    std::vector<MeasuredNoise> pilot(tiles.size() * kPilotParts);
    std::vector<RareLight> rare(pilot.size());
    const uint64_t rays_before = progress_.rays();
    const double start = progress_.elapsed();
    const RayPlan small = pilot_rays(goal_.most, goal_.gathers), large = trial_rays(goal_.most, goal_.gathers);
    std::vector<NoiseTrial> trials((tiles.size() + kTrialStep - 1) / kTrialStep);
    const uint32_t seed = hash_combine(settings_.seed, kSaltPilot);
    visit_parts(tiles, seed, true, [&](size_t i, const Tile& part, DirectGroups& groups) {
        const TileEstimate few = estimate(part, small, groups, {}, seed, false);
        pilot[i] = mean_noise(few, 0, part.count);
        rare[i] = rare_light(few, 0, part.count);
        const size_t tile = i / kPilotParts;
        if (is_trial(tile, i % kPilotParts)) trials[tile / kTrialStep] = try_noise(part, pilot[i], large, groups, seed);
    });
    goal_.model = fit_noise_model(trials, small, large);
    goal_.dark = dark_level(pilot);
    goal_.rare = mean_rare_light(rare, small.gather, first_.gather);
    // The few hits that are most of the light tell little of it.
    if (goal_.gathers && !(mean_level(pilot) > 2.0f * goal_.rare.level)) goal_.rare = look_for_rare_light(tiles, large);
    if (!timed) return;
    const double seconds_per_ray =
        (progress_.elapsed() - start) / std::max<double>(1.0, static_cast<double>(progress_.rays() - rays_before));
    const std::vector<double> weights = ray_weights(s_.receivers);
    pace_ = std::make_unique<GatherPace>(std::move(pilot), small, std::move(tiles),
                                         std::reduce(weights.begin(), weights.end()));
    result_.time_limited = pace_->begin(time_left(), seconds_per_ray, first_, goal_);
}

/// Adds further rays to the packets of a part of a tile that need them, all packets with one need together.
std::vector<Baker::FurtherRays> Baker::refine(const Tile& part, const TileEstimate& first, const NoiseGoal& goal,
                                              DirectGroups& groups, uint32_t seed, TileLight& light) {
    const std::vector<MeasuredNoise> noise = packet_noise(first, part.count, goal);
    std::vector<FurtherRays> more;
    for (const MeasuredNoise& n : noise) more.push_back({missing_rays(n, first.plan, goal)});
    std::vector<bool> done(noise.size(), false);
    for (size_t p = 0; p < noise.size(); ++p) {
        const RayPlan plan = more[p].rays;
        if (done[p] || (plan.gather | plan.direct) == 0) continue;
        Packets packets{};
        for (size_t q = p; q < noise.size(); ++q)
            if (more[q].rays.gather == plan.gather && more[q].rays.direct == plan.direct)
                packets[q] = 1, done[q] = true;
        const TileEstimate further = estimate(part, plan, groups, {packets.data()}, seed, settings_.keep_sh != 0);
        for (uint32_t q = 0; q < noise.size(); ++q) {
            if (packets[q] == 0) continue;
            more[q].share = share_of_more(noise[q], first.plan, further.plan, goal);
            light.add(further, q * kLanes, std::min((q + 1) * kLanes, part.count), more[q].share);
        }
    }
    for (uint32_t q = 0; q < noise.size(); ++q)
        light.add(first, q * kLanes, std::min((q + 1) * kLanes, part.count), 1.0f - more[q].share);
    return more;
}

void Baker::final_gather() {
    const uint32_t n = s_.receivers.count();
    const bool keep_sh = settings_.keep_sh != 0;
    result_.irradiance.resize(n);
    result_.sh.resize(size_t{n} * kShCount);
    result_.sh_rgb.resize(keep_sh ? size_t{n} * 3 * kShCount : 0);
    result_.standard_error.resize(n);
    result_.samples.resize(n);
    result_.inside.resize(n);
    further_.resize(s_.receivers.tiles.size());
    if (settings_.trial != 0)
        gather_some(
            s_.receivers, pool_, progress_,
            [&](size_t i) {
                finish_tile(i);
                return 0;
            },
            result_.trial);
    else if (pace_ == nullptr)
        pool_.for_each(s_.receivers.tiles.size(), progress_, [&](size_t i) { finish_tile(i); });
    else
        gather_in_rounds();
}

double Baker::time_left() const {
    return seconds_left(settings_, progress_, s_.receivers.tiles.size(), source_end_) -
           seconds_to_store_ * s_.receivers.count();
}

/// Every round takes tiles from all over the scene, so each takes about as long.
void Baker::gather_in_rounds() {
    const Rounds rounds{s_.receivers.tiles.size()};
    const std::vector<double> weights = ray_weights(s_.receivers);
    const double all = std::reduce(weights.begin(), weights.end());
    double done = 0.0;
    for (size_t round = 0; round < rounds.count(); ++round) {
        const double start = progress_.elapsed();
        double receivers = 0.0;
        for (size_t k = 0; k < rounds.size(round); ++k) receivers += weights[rounds.tile(round, k)];
        pool_.for_each(
            rounds.size(round), progress_, [&](size_t k) { finish_tile(rounds.tile(round, k)); }, false);
        progress_.update(static_cast<float>((done += receivers) / all));
        if (pace_->follow(receivers, progress_.elapsed() - start, time_left(), first_, goal_))
            result_.time_limited = true;
    }
}

void Baker::finish_tile(size_t i) {
    const Tile& tile = s_.receivers.tiles[i];
    const uint32_t seed = hash_combine(settings_.seed, kSaltFinal);
    DirectGroups groups = look_around(tile, seed);
    const TileParts parts = split(s_.receivers, tile);
    NoiseGoal ring = goal_;
    ring.target *= std::sqrt(float{kRingShare}), ring.shortage *= float{kRingShare};
    const std::vector<FurtherRays> further = finish_part(parts.own, first_, goal_, groups, seed);
    groups.start_at(parts.ring.first - tile.first);
    finish_part(parts.ring, spares_rays(settings_) ? ring_rays(first_) : first_, ring, groups, seed);
    const uint32_t watched = (TwinCheck::part(s_.receivers, i).first - tile.first) / kLanes;
    if (watched < further.size()) further_[i] = further[watched];
}

/// Finishes one part of a tile; returns the further rays of its packets.
std::vector<Baker::FurtherRays> Baker::finish_part(const Tile& part, const RayPlan& plan, const NoiseGoal& goal,
                                                   DirectGroups& groups, uint32_t seed) {
    if (part.count == 0) return {};
    const bool keep_sh = settings_.keep_sh != 0;
    auto light = std::make_unique<TileLight>();
    const TileEstimate first = estimate(part, plan, groups, {}, seed, keep_sh);
    std::vector<FurtherRays> further = refine(part, first, goal, groups, hash_combine(seed, 1), *light);
    for (uint32_t lane = 0; lane < part.count; ++lane) {
        const size_t r = part.first + lane;
        result_.irradiance[r] = light->irradiance[lane];
        result_.standard_error[r] = static_cast<float>(std::sqrt(light->variance[lane]));
        result_.samples[r] = light->samples[lane];
        result_.inside[r] = light->inside[lane];
        std::copy_n(light->sh[lane], kShCount, &result_.sh[r * kShCount]);
        if (keep_sh)
            std::copy_n(&light->sh_rgb[size_t{lane} * 3 * kShCount], 3 * kShCount, &result_.sh_rgb[r * 3 * kShCount]);
    }
    return further;
}

TileLight Baker::second_answer(size_t i, uint32_t seed) {
    const Tile &tile = s_.receivers.tiles[i], part = TwinCheck::part(s_.receivers, i);
    const FurtherRays& further = further_[i];
    DirectGroups groups = look_around(tile, seed);
    groups.start_at(part.first - tile.first);
    TileLight light;
    light.add(estimate(part, first_, groups, {}, seed, false), 0, part.count, 1.0f - further.share);
    if (further.share > 0.0f)
        light.add(estimate(part, further.rays, groups, {}, hash_combine(seed, 1), false), 0, part.count, further.share);
    return light;
}

std::unique_ptr<Baker> Baker::other_source() {
    if (settings_.bounces == 0) return nullptr;
    auto other = std::make_unique<Baker>(s_, other_source_settings(settings_), pool_, progress_);
    other->in_background_ = true;
    other->source_samples_ = other_source_samples(settings_, source_samples_);
    other->first_ = first_, other->further_ = further_;
    other->find_source();
    return other;
}

void Baker::calibrate_error() {
    TwinCheck check(s_.receivers, result_);
    const std::unique_ptr<Baker> other = other_source();
    pool_.for_each(
        check.count(), progress_,
        [&](size_t k) {
            const size_t i = k * check.step();
            const Tile part = TwinCheck::part(s_.receivers, i);
            if (part.count == 0) return;
            const uint32_t seed = hash_combine(settings_.seed, kSaltTwin);
            const TileLight second = second_answer(i, seed);
            TileLight third;
            if (other != nullptr) third = other->second_answer(i, hash_combine(seed, 1));
            for (uint32_t lane = 0; lane < part.count; ++lane) {
                const uint32_t r = part.first + lane;
                const double own = double{result_.standard_error[r]} * result_.standard_error[r];
                const float twin = luminance(second.irradiance[lane]);
                check.compare(
                    k, r,
                    {luminance(result_.irradiance[r]), twin,
                     other != nullptr ? luminance(third.irradiance[lane]) : twin, 0.5 * (own + second.variance[lane])});
            }
        },
        false);
    result_.calibration = check.finish(source_rays_ratio(settings_));
    for (float& e : result_.standard_error) e *= result_.calibration.factor;
    state_missed_light(s_.receivers, result_);
}

} // namespace ajar
