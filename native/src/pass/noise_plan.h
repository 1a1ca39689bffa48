// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "pass/bake_parts.h"

namespace ajar {

/// How the noise of answers behaves, as a scene's pilot found it.
struct NoiseModel {
    /// True variance over the strata estimate's (algorithms.md 10.2), of gathered and of sampled light: samples of
    /// lamps are spread far more evenly than two neighbours tell.
    float gather_calibration = 1.0f, direct_calibration = 1.0f;
    float gather_power = 1.0f; ///< variance falls with rays to this power; strata make it more than 1
    float direct_power = 1.0f;
};

/// Noise target of a preview, the default.
inline constexpr float kPreviewNoise = 0.12f;

/// A noise target is one that 95 % of the texels keep. Places of some texels are planned as one, and the noise of their
/// texels spreads: the 95th percentile over the noise planned was 1.65 for packets of 8 of two game levels (0.9 and 0.3
/// million texels), 1.38 of an office, and 1.79 and 1.66 for quarters of its tiles with 130 light sets and with 25
/// doors.
inline constexpr float kPacketSpread = 1.8f, kPartSpread = 1.85f;

/// Light that few rays meet, and the variance it makes, of a mean over receivers.
struct RareLight {
    float level = 0.0f, variance = 0.0f;

    void add(const RareLight& other, float share) { level += other.level * share, variance += other.variance * share; }
};

/// The noise that a bake aims at, and the rays that it may take for it.
struct NoiseGoal {
    float target = 0.0f; ///< relative standard error of a place; 0: every receiver gets the first rays alone
    float dark = 0.0f;   ///< W/m^2; light below it may be as noisy as this much light
    RayPlan most = {};   ///< per receiver
    bool gathers = true;
    NoiseModel model = {};
    RareLight rare = {}; ///< of the whole scene, with the first rays
    /// Above 0 where time is short: a place may then have this times its relative standard error with one ray as its
    /// relative variance. So rays go as the standard errors of one, which makes the mean squared error the least that
    /// a number of rays can (Neyman 1934); one noise for all would give the few noisiest places most of them.
    float shortage = 0.0f;
};

/// Noise of one place with few and with many rays, and what two answers with many say of it.
struct NoiseTrial {
    MeasuredNoise few, many;
    MeasuredNoise strata; ///< of all light with many rays
    MeasuredNoise twin;   ///< of the same: half the mean squared difference of the two
};

/// Powers and calibrations are typical ones: a few places with rare bright samples say little of the others.
NoiseModel fit_noise_model(const std::vector<NoiseTrial>& trials, const RayPlan& few, const RayPlan& many);

inline constexpr uint32_t kTrialStep = 8; ///< every n-th tile has a place where the pilot looks twice

/// Rays of the pilot (few) and of the places where it looks twice (many), within the most that receivers may have.
RayPlan pilot_rays(const RayPlan& most, bool gathers);
RayPlan trial_rays(const RayPlan& most, bool gathers);
/// The pilot looks twice at this part of a tile.
bool is_trial(size_t tile, uint32_t part);

/// Rays that receivers still need after rays whose noise was measured; {0, 0}: none. Their answer is to be
/// averaged with the first one, weighed by share_of_more() (algorithms.md 10.3: one decision).
RayPlan missing_rays(const MeasuredNoise& noise, const RayPlan& done, const NoiseGoal& goal);

/// Ray counts of a tile's parts.
using TilePlan = std::array<RayPlan, kPilotParts>;
/// Those that reach the goal by what the pilot found in them ([kPilotParts]; algorithms.md 10.3, 10.4).
TilePlan plan_tile(const MeasuredNoise* parts, const RayPlan& pilot_rays, const NoiseGoal& goal);
/// The same for all tiles, [tiles][kPilotParts].
std::vector<TilePlan> plan_tiles(const std::vector<MeasuredNoise>& pilot, const RayPlan& pilot_rays,
                                 const NoiseGoal& goal);
/// What receivers of the ring around parts with these get.
RayPlan ring_rays(const TilePlan& plan);
/// Mean of the parts, rays of both kinds.
double mean_rays(const TilePlan& plan);

/// Weight of the answer of the further rays, by inverse variance.
float share_of_more(const MeasuredNoise& noise, const RayPlan& done, const RayPlan& more, const NoiseGoal& goal);

/// What the final gather will take in rays: first for every receiver, then what the pilot's parts
/// ([tiles][kPilotParts], measured with pilot_rays) say is missing.
double predict_rays(const std::vector<MeasuredNoise>& pilot, const RayPlan& pilot_rays, const std::vector<Tile>& tiles,
                    const RayPlan& first, const NoiseGoal& goal);

} // namespace ajar
