// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pass/noise_plan.h"

namespace ajar {

/// First rays of a receiver whose noise decides on further ones: enough to measure it by.
inline constexpr RayPlan kFirstRays = {64, 64};

/// Keeps a final gather inside its time. A pilot predicts what a noise costs in rays, but not exactly, nor how long
/// a ray takes; so the gather goes in rounds, and after each one the noise that the rest aims at follows the
/// pace so far.
class GatherPace {
public:
    /// pilot: [tiles][kPilotParts], measured with pilot_rays. receivers: of the whole scene.
    GatherPace(std::vector<MeasuredNoise> pilot, const RayPlan& pilot_rays, std::vector<Tile> tiles,
               uint32_t receivers);

    /// Plans the gather for seconds at the pilot's speed: raises goal.target above what it is, the noise that is
    /// wanted, and lowers the first rays if even that is too much. True if it had to.
    bool begin(double seconds, double seconds_per_ray, RayPlan& first, NoiseGoal& goal);
    /// After some receivers took seconds_taken: the noise for the others, who have seconds_left. Never less than
    /// is wanted. True if it is more.
    bool follow(uint32_t receivers, double seconds_taken, double seconds_left, const RayPlan& first, NoiseGoal& goal);

private:
    /// Predicted rays per receiver.
    double rays(const RayPlan& first, const NoiseGoal& goal) const;
    void fit(double affordable, const RayPlan& first, NoiseGoal& goal) const;

    std::vector<MeasuredNoise> pilot_;
    RayPlan pilot_rays_;
    std::vector<Tile> tiles_;
    double pilot_receivers_ = 0.0;
    uint32_t left_;
    float wanted_ = 0.0f;
    double predicted_ = 0.0, taken_ = 0.0; ///< rays and seconds of what is done
};

} // namespace ajar
