// SPDX-License-Identifier: GPL-3.0-or-later
#include "pass/gather_pace.h"

namespace ajar {

namespace {

constexpr float kLeastTarget = 1e-4f;  ///< stands for "as many rays as allowed" once time is short
constexpr float kWorstTarget = 100.0f; ///< nobody gets further rays

} // namespace

GatherPace::GatherPace(std::vector<MeasuredNoise> pilot, const RayPlan& pilot_rays, std::vector<Tile> tiles,
                       uint32_t receivers)
    : pilot_(std::move(pilot)), pilot_rays_(pilot_rays), tiles_(std::move(tiles)), left_(receivers) {
    for (const Tile& t : tiles_) pilot_receivers_ += t.count;
}

double GatherPace::rays(const RayPlan& first, const NoiseGoal& goal) const {
    return predict_rays(pilot_, pilot_rays_, tiles_, first, goal) / std::max(pilot_receivers_, 1.0);
}

/// The least noise from the wanted one up whose rays are affordable, per receiver.
void GatherPace::fit(double affordable, const RayPlan& first, NoiseGoal& goal) const {
    goal.target = wanted_;
    if (rays(first, goal) <= affordable) return;
    float low = wanted_, high = kWorstTarget;
    for (int i = 0; i < 24; ++i) {
        goal.target = std::sqrt(low * high);
        (rays(first, goal) <= affordable ? high : low) = goal.target;
    }
    goal.target = high;
}

bool GatherPace::begin(double seconds, double seconds_per_ray, RayPlan& first, NoiseGoal& goal) {
    const double affordable = std::max(kPlannedPart * seconds, 0.0) / (seconds_per_ray * std::max(left_, 1u));
    if (rays(first, goal) <= affordable) {
        wanted_ = goal.target;
        return false;
    }
    if (!(goal.target > 0.0f)) {
        goal.target = kLeastTarget;
        first = {std::min(first.gather, kFirstRays.gather), std::min(first.direct, kFirstRays.direct)};
    }
    wanted_ = goal.target;
    fit(affordable, first, goal);
    while (rays(first, goal) > affordable && (first.gather > 8 || first.direct > 4)) {
        if (first.gather > 8) first.gather /= 2;
        if (first.direct > 4) first.direct /= 2;
    }
    return true;
}

bool GatherPace::follow(uint32_t receivers, double seconds_taken, double seconds_left, const RayPlan& first,
                        NoiseGoal& goal) {
    predicted_ += rays(first, goal) * receivers;
    taken_ += seconds_taken;
    left_ -= std::min(receivers, left_);
    if (left_ == 0 || !(wanted_ > 0.0f) || !(taken_ > 0.0)) return false;
    fit(std::max(kPlannedPart * seconds_left, 0.0) * predicted_ / (taken_ * left_), first, goal);
    return goal.target > wanted_;
}

} // namespace ajar
