// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pass/noise_plan.h"

namespace ajar {

/// First rays of a receiver whose noise decides on further ones: enough to measure it by.
inline constexpr RayPlan kFirstRays = {64, 64};

/// Keeps a final gather inside its time. A pilot predicts what a noise costs in rays, but not exactly, nor how long
/// a ray takes; so the gather goes in rounds, and after each one the shortage of rays for the rest follows the
/// pace so far.
class GatherPace {
public:
    /// pilot: [tiles][kPilotParts], measured with pilot_rays. receivers: of the whole scene, by ray_weights().
    GatherPace(std::vector<MeasuredNoise> pilot, const RayPlan& pilot_rays, std::vector<Tile> tiles, double receivers);

    /// Plans the gather for seconds at the pilot's speed: sets goal.shortage, and lowers the first rays if even that
    /// is too much. True if it had to. Fixed counts, goal.target 0, become the best that time allows.
    bool begin(double seconds, double seconds_per_ray, RayPlan& first, NoiseGoal& goal);
    /// After some receivers took seconds_taken: the shortage for the others, who have seconds_left. True if there
    /// is any.
    bool follow(double receivers, double seconds_taken, double seconds_left, const RayPlan& first, NoiseGoal& goal);

private:
    /// Predicted rays per receiver.
    double rays(const RayPlan& first, const NoiseGoal& goal) const;
    void fit(double affordable, const RayPlan& first, NoiseGoal& goal) const;

    std::vector<MeasuredNoise> pilot_;
    RayPlan pilot_rays_;
    std::vector<Tile> tiles_;
    double pilot_receivers_ = 0.0;
    double left_;
    double predicted_ = 0.0, taken_ = 0.0; ///< rays and seconds of what is done
};

/// The same for a gather that plans whole tiles before it starts.
class TilePace {
public:
    /// pilot: [tiles][kPilotParts], measured with pilot_rays. receivers: ray_weights(). wanted: [tiles]
    /// without a limit.
    TilePace(std::vector<MeasuredNoise> pilot, const RayPlan& pilot_rays, std::vector<double> receivers,
             const NoiseGoal& goal, std::vector<TilePlan> wanted);

    /// Plans the tiles of the rounds from round on for so many rays, as plan_tiles() with the least shortage. True if
    /// more are wanted.
    bool fit(size_t round, double rays, std::vector<TilePlan>& plan) const;

private:
    void plan_with(float shortage, size_t round, std::vector<TilePlan>& plan) const;
    /// Rays of the rounds from round on.
    double rays(const std::vector<TilePlan>& plan, size_t round) const;

    std::vector<MeasuredNoise> pilot_;
    RayPlan pilot_rays_;
    std::vector<double> receivers_;
    NoiseGoal goal_;
    std::vector<TilePlan> wanted_;
};

} // namespace ajar
