// SPDX-License-Identifier: GPL-3.0-or-later
#include "pass/gather_pace.h"

namespace ajar {

namespace {

constexpr float kLeastTarget = 1e-4f; ///< stands for "as many rays as allowed" once time is short
constexpr float kLeastShortage = 1e-8f, kWorstShortage = 1e4f;
constexpr double kExact = 1.02; ///< ratio that the shortage is found to

/// Fewer rays, the last resort; false if they are the fewest already.
bool halve(RayPlan& plan) {
    const bool gather = plan.gather > 8, direct = plan.direct > 4;
    if (gather) plan.gather /= 2;
    if (direct) plan.direct /= 2;
    return gather || direct;
}

/// The least shortage, to within kExact, whose rays are affordable. The worst if none is.
template <class Affordable>
float least_shortage(Affordable&& affordable) {
    double low = kLeastShortage, high = kWorstShortage;
    while (high > low * kExact) {
        const double middle = std::sqrt(low * high);
        (affordable(static_cast<float>(middle)) ? high : low) = middle;
    }
    return static_cast<float>(high);
}

} // namespace

GatherPace::GatherPace(std::vector<MeasuredNoise> pilot, const RayPlan& pilot_rays, std::vector<Tile> tiles,
                       double receivers)
    : pilot_(std::move(pilot)), pilot_rays_(pilot_rays), tiles_(std::move(tiles)), left_(receivers) {
    for (const Tile& t : tiles_) pilot_receivers_ += t.count;
}

double GatherPace::rays(const RayPlan& first, const NoiseGoal& goal) const {
    return predict_rays(pilot_, pilot_rays_, tiles_, first, goal) / std::max(pilot_receivers_, 1.0);
}

void GatherPace::fit(double affordable, const RayPlan& first, NoiseGoal& goal) const {
    const auto suffices = [&](float shortage) {
        goal.shortage = shortage;
        return rays(first, goal) <= affordable;
    };
    if (!suffices(0.0f)) goal.shortage = least_shortage(suffices);
}

bool GatherPace::begin(double seconds, double seconds_per_ray, RayPlan& first, NoiseGoal& goal) {
    const double affordable = std::max(kPlannedPart * seconds, 0.0) / (seconds_per_ray * std::max(left_, 1.0));
    if (rays(first, goal) <= affordable) return false;
    if (!(goal.target > 0.0f)) {
        goal.target = kLeastTarget;
        first = {std::min(first.gather, kFirstRays.gather), std::min(first.direct, kFirstRays.direct)};
    }
    fit(affordable, first, goal);
    while (rays(first, goal) > affordable && halve(first)) {
    }
    return true;
}

bool GatherPace::follow(double receivers, double seconds_taken, double seconds_left, const RayPlan& first,
                        NoiseGoal& goal) {
    predicted_ += rays(first, goal) * receivers;
    taken_ += seconds_taken;
    left_ -= std::min(receivers, left_);
    if (left_ <= 0.0 || !(goal.target > 0.0f) || !(taken_ > 0.0)) return false;
    fit(std::max(kPlannedPart * seconds_left, 0.0) * predicted_ / (taken_ * left_), first, goal);
    return goal.shortage > 0.0f;
}

TilePace::TilePace(std::vector<MeasuredNoise> pilot, const RayPlan& pilot_rays, std::vector<double> receivers,
                   const NoiseGoal& goal, std::vector<TilePlan> wanted)
    : pilot_(std::move(pilot)),
      pilot_rays_(pilot_rays),
      receivers_(std::move(receivers)),
      goal_(goal),
      wanted_(std::move(wanted)) {
    goal_.target = std::max(goal_.target, kLeastTarget);
}

double TilePace::rays(const std::vector<TilePlan>& plan, size_t round) const {
    const Rounds rounds{receivers_.size()};
    double sum = 0.0;
    for (size_t i = 0; i < receivers_.size(); ++i)
        if (rounds.of(i) >= round) sum += mean_rays(plan[i]) * receivers_[i];
    return sum;
}

void TilePace::plan_with(float shortage, size_t round, std::vector<TilePlan>& plan) const {
    NoiseGoal goal = goal_;
    goal.shortage = shortage;
    const Rounds rounds{receivers_.size()};
    for (size_t i = 0; i < receivers_.size(); ++i) {
        if (rounds.of(i) < round) continue;
        plan[i] = wanted_[i];
        if (!(shortage > 0.0f)) continue;
        const TilePlan fewer = plan_tile(&pilot_[i * kPilotParts], pilot_rays_, goal);
        for (uint32_t k = 0; k < kPilotParts; ++k)
            plan[i][k] = {std::min(plan[i][k].gather, fewer[k].gather), std::min(plan[i][k].direct, fewer[k].direct)};
    }
}

bool TilePace::fit(size_t round, double affordable, std::vector<TilePlan>& plan) const {
    const auto suffices = [&](float shortage) {
        plan_with(shortage, round, plan);
        return rays(plan, round) <= affordable;
    };
    if (suffices(0.0f)) return false;
    plan_with(least_shortage(suffices), round, plan);
    for (bool changed = true; changed && rays(plan, round) > affordable;) {
        changed = false;
        for (size_t i = 0; i < plan.size(); ++i)
            if (Rounds{receivers_.size()}.of(i) >= round)
                for (RayPlan& p : plan[i]) changed |= halve(p);
    }
    return true;
}

} // namespace ajar
