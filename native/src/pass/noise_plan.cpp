// SPDX-License-Identifier: GPL-3.0-or-later
#include "pass/noise_plan.h"

#include <bit>
#include <numbers>

namespace ajar {

namespace {

constexpr uint32_t kLeastMore = 16;
constexpr uint32_t kTrialRays = 256; ///< of each kind
constexpr size_t kLeastTrials = 8;
constexpr float kLeastCalibration = 0.05f;
constexpr float kMiddleOfMean = 0.8f; ///< typical over mean ratio: some places are noisier than their neighbours tell
constexpr float kMostPower = 1.6f;
constexpr uint32_t kStep = 256; ///< counts above it are multiples of it, others powers of two

uint32_t round_up(float rays, uint32_t most) {
    if (most < kLeastMore) return 0;
    const auto wanted = static_cast<uint32_t>(std::clamp(rays, float{kLeastMore}, static_cast<float>(most)));
    const uint32_t up = wanted <= kStep ? std::bit_ceil(wanted) : (wanted + kStep - 1) / kStep * kStep;
    return up <= most ? up : most < kStep ? std::bit_floor(most) : most / kStep * kStep;
}

/// The power of two next to v on a logarithmic scale.
uint32_t power_of_two(double v, uint32_t low, uint32_t high) {
    const auto nearest = static_cast<uint32_t>(std::min(v / std::numbers::sqrt2, 1e9));
    return std::bit_ceil(std::clamp(nearest, low, high));
}

uint32_t left(uint32_t most, uint32_t done) { return most > done ? most - done : 0; }

float variance(const MeasuredNoise& n) { return n.gather_variance + n.direct_variance; }

/// Rays of both kinds.
struct Wanted {
    double gather, direct;
};

/// Rays that bring the strata estimate of a measured variance down to another. Both kinds of ray cost about
/// the same; of all splits with one variance this has about the fewest.
Wanted rays_for(const MeasuredNoise& noise, const RayPlan& measured, double wanted, const NoiseModel& model) {
    const double gather = std::sqrt(double(measured.gather) * noise.gather_variance),
                 direct = std::sqrt(double(measured.direct) * noise.direct_variance), sum = gather + direct;
    if (!(sum > 0.0)) return {0.0, 0.0};
    const double power = (gather * model.gather_power + direct * model.direct_power) / sum;
    const double growth = std::pow(std::max(variance(noise) / wanted, 1.0), 1.0 / power - 1.0);
    return {growth * gather * sum / wanted, growth * direct * sum / wanted};
}

/// Variance that a place may have after measured rays told its noise.
double allowed_variance(const MeasuredNoise& noise, const RayPlan& measured, const NoiseGoal& goal) {
    const double level = double(noise.level) + goal.dark, aimed_at = double(goal.target) * level;
    const double of_one_ray = std::sqrt(double(measured.gather) * noise.gather_variance) +
                              std::sqrt(double(measured.direct) * noise.direct_variance);
    return std::max(aimed_at * aimed_at, goal.shortage * of_one_ray * level);
}

/// Strata estimate of a place's variance with other rays than it was measured with.
double variance_with(const MeasuredNoise& n, const RayPlan& measured, const RayPlan& rays, const NoiseModel& model) {
    const auto scaled = [](double v, double had, double has, double power) {
        return v > 0.0 ? v * std::pow(had / std::max(has, 1e-3), power) : 0.0;
    };
    return scaled(n.gather_variance, measured.gather, rays.gather, model.gather_power) +
           scaled(n.direct_variance, measured.direct, rays.direct, model.direct_power);
}

/// Rays that parts need for one variance, as those with the same mean variance and the least sum.
void even_out(std::array<double, kPilotParts>& rays) {
    double roots = 0.0;
    for (const double n : rays) roots += std::sqrt(n) / kPilotParts;
    for (double& n : rays) n = std::sqrt(n) * roots;
}

/// The middle of some numbers; 0 of too few.
float typical(std::vector<float> values) {
    if (values.size() < kLeastTrials) return 0.0f;
    const auto middle = values.begin() + static_cast<ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Power p by which a variance fell: the middle of log(few / many) over log(rays).
float typical_power(std::vector<float> falls, float growth) {
    return growth > 1.0f ? std::clamp(typical(std::move(falls)) / std::log(growth), 1.0f, kMostPower) : 1.0f;
}

/// Middle of twin over strata variances; 1 of too few.
float typical_calibration(std::vector<float> ratios) {
    if (ratios.size() < kLeastTrials) return 1.0f;
    return std::clamp(typical(std::move(ratios)) / kMiddleOfMean, kLeastCalibration, 1.0f);
}

/// What a strata estimate says of the true variance.
MeasuredNoise calibrated(MeasuredNoise n, const NoiseModel& model) {
    n.gather_variance *= model.gather_calibration, n.direct_variance *= model.direct_calibration;
    return n;
}

} // namespace

RayPlan pilot_rays(const RayPlan& most, bool gathers) {
    return {gathers ? kPilotRays : 0, std::min(most.direct, kPilotRays)};
}

RayPlan trial_rays(const RayPlan& most, bool gathers) {
    return {gathers ? std::min(kTrialRays, most.gather) : 0, std::min(kTrialRays, most.direct)};
}

bool is_trial(size_t tile, uint32_t part) { return tile % kTrialStep == 0 && part == tile / kTrialStep % kPilotParts; }

NoiseModel fit_noise_model(const std::vector<NoiseTrial>& trials, const RayPlan& few, const RayPlan& many) {
    std::vector<float> falls[2], ratios[2];
    for (const NoiseTrial& t : trials) {
        const float least = 1e-10f * t.many.level * t.many.level;
        const auto learn = [&](size_t kind, float MeasuredNoise::*v) {
            if (t.many.*v > 0.0f && t.few.*v > 0.0f) falls[kind].push_back(std::log(t.few.*v / t.many.*v));
            if (t.strata.*v > least) ratios[kind].push_back(t.twin.*v / t.strata.*v);
        };
        learn(0, &MeasuredNoise::gather_variance);
        learn(1, &MeasuredNoise::direct_variance);
    }
    const auto growth = [](uint32_t a, uint32_t b) { return a > 0 ? float(b) / static_cast<float>(a) : 1.0f; };
    return {typical_calibration(std::move(ratios[0])), typical_calibration(std::move(ratios[1])),
            typical_power(std::move(falls[0]), growth(few.gather, many.gather)),
            typical_power(std::move(falls[1]), growth(few.direct, many.direct))};
}

RayPlan missing_rays(const MeasuredNoise& measured, const RayPlan& done, const NoiseGoal& goal) {
    if (!(goal.target > 0.0f)) return {};
    const MeasuredNoise noise = calibrated(measured, goal.model);
    const double budget = allowed_variance(noise, done, goal), first = variance(noise);
    if (!(first > budget) || !std::isfinite(first)) return {};
    // Averaged by inverse variance, both answers together reach the budget.
    const Wanted wanted = rays_for(noise, done, std::max(budget * first / (first - budget), 1e-30), goal.model);
    const RayPlan more{
        goal.gathers ? round_up(static_cast<float>(wanted.gather), left(goal.most.gather, done.gather)) : 0,
        round_up(static_cast<float>(wanted.direct), left(goal.most.direct, done.direct))};
    // Each answer stands on its own: emission is shared by both kinds of ray.
    if ((goal.gathers && more.gather == 0) || more.direct == 0) return {};
    return more;
}

TilePlan plan_tile(const MeasuredNoise* parts, const RayPlan& pilot_rays, const NoiseGoal& goal) {
    // Eight receivers are few: all parts of the tile pool with each.
    const auto pooled = [&](size_t k, float MeasuredNoise::*v) {
        float sum = 0.0f;
        for (size_t j = 0; j < kPilotParts; ++j) sum += parts[j].*v;
        return std::max(0.5f * (parts[k].*v + sum / kPilotParts), parts[k].*v);
    };
    TilePlan plan;
    std::array<double, kPilotParts> gather, direct;
    for (size_t k = 0; k < kPilotParts; ++k) {
        const MeasuredNoise noise = calibrated(
            {parts[k].level, pooled(k, &MeasuredNoise::gather_variance), pooled(k, &MeasuredNoise::direct_variance)},
            goal.model);
        const double allowed = allowed_variance(noise, pilot_rays, goal) + 1e-30;
        const Wanted wanted = rays_for(noise, pilot_rays, allowed, goal.model);
        gather[k] = wanted.gather, direct[k] = wanted.direct;
    }
    even_out(gather), even_out(direct);
    for (size_t k = 0; k < kPilotParts; ++k)
        plan[k] = {goal.gathers ? power_of_two(gather[k], 64, std::max(goal.most.gather, 64u)) : 0,
                   power_of_two(direct[k], std::min(16u, goal.most.direct), std::max(goal.most.direct, 1u))};
    return plan;
}

RayPlan ring_rays(const TilePlan& plan) {
    RayPlan sum;
    for (const RayPlan& p : plan) sum.gather += p.gather, sum.direct += p.direct;
    return ring_rays(RayPlan{sum.gather / kPilotParts, sum.direct / kPilotParts});
}

double mean_rays(const TilePlan& plan) {
    double sum = 0.0;
    for (const RayPlan& p : plan) sum += double(p.gather) + p.direct;
    return sum / kPilotParts;
}

std::vector<TilePlan> plan_tiles(const std::vector<MeasuredNoise>& pilot, const RayPlan& pilot_rays,
                                 const NoiseGoal& goal) {
    std::vector<TilePlan> plan;
    for (size_t i = 0; i < pilot.size(); i += kPilotParts) plan.push_back(plan_tile(&pilot[i], pilot_rays, goal));
    return plan;
}

float share_of_more(const MeasuredNoise& measured, const RayPlan& done, const RayPlan& more, const NoiseGoal& goal) {
    const MeasuredNoise noise = calibrated(measured, goal.model);
    const double first = variance(noise), second = variance_with(noise, done, more, goal.model);
    return first + second > 0.0 ? static_cast<float>(first / (first + second)) : 0.5f;
}

double predict_rays(const std::vector<MeasuredNoise>& pilot, const RayPlan& pilot_rays, const std::vector<Tile>& tiles,
                    const RayPlan& first, const NoiseGoal& goal) {
    double sum = 0.0;
    for (size_t i = 0; i < pilot.size(); ++i) {
        MeasuredNoise n = pilot[i], gather = n, direct = n;
        gather.direct_variance = direct.gather_variance = 0.0f;
        n.gather_variance = static_cast<float>(variance_with(gather, pilot_rays, first, goal.model));
        n.direct_variance = static_cast<float>(variance_with(direct, pilot_rays, first, goal.model));
        const RayPlan more = missing_rays(n, first, goal);
        sum += double(tiles[i / kPilotParts].count) / kPilotParts *
               (first.gather + first.direct + more.gather + more.direct);
    }
    return sum;
}

} // namespace ajar
