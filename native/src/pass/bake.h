// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "pass/bounce_growth.h"
#include "pass/gather_pace.h"
#include "pass/term_result.h"
#include "pass/trial_gather.h"

namespace ajar {

struct TileEstimate;
struct TileLight;

/// Share of a receiver's rays that may meet the inside of solids before its light is distrusted.
inline constexpr float kInsideShare = 0.3f;

/// What two answers for some receivers say of the standard errors that strata state.
struct ErrorCalibration {
    float factor = 1.0f; ///< measured over stated
    float spread = 0.0f; ///< relative standard error of the factor: large where few bright samples rule the error

    /// Whether the error may as well be twice as large.
    bool is_unsure() const { return spread > 0.25f; }
};

/// What a bake found, per receiver unless said otherwise.
struct BakeResult {
    std::vector<Vec3> irradiance;      ///< W/m^2 along the shading normal, stored part
    std::vector<float> sh;             ///< [count][9] luminance of incident radiance, tangent frame
    std::vector<float> sh_rgb;         ///< [count][27] if kept
    std::vector<float> standard_error; ///< of the irradiance's luminance, W/m^2
    std::vector<float> total;          ///< luminance with everything open, present and lit; empty without elements
    std::vector<float> total_error;    ///< standard error of total
    std::vector<float> missed;       ///< luminance that it lacks where few rays find the light, W/m^2; empty if nothing
    std::vector<float> missed_error; ///< part of the standard error for that
    std::vector<float> samples;      ///< gather rays
    std::vector<float> inside;       ///< share of rays that met the inside of a solid close by
    std::vector<std::vector<Vec3>> bounces; ///< irradiance of every bounce, all lights, if kept
    std::vector<Vec3> source;               ///< irradiance of all lights and bounces that the final gather reflected

    std::vector<double> bounce_means; ///< mean luminance of each bounce's irradiance
    BounceGrowth growth;              ///< of the light from bounce to bounce
    TermResult terms;                 ///< light of every term but the base, which the arrays above hold

    /// Standard errors per receiver with everything open, present and lit.
    const std::vector<float>& all_on_error() const { return total_error.empty() ? standard_error : total_error; }

    uint32_t bright_texels = 0;   ///< aimed at by the final gather
    ErrorCalibration calibration; ///< of the standard errors, already in them
    TrialTimes trial;             ///< of a trial, which leaves the arrays above unfinished
    bool time_limited = false;    ///< the time limit, not the target, set the ray counts
};

/// Runs the transport passes over all receivers. Throws Cancelled.
class Baker {
public:
    /// seconds_to_store: what follows takes per receiver and term; a time limit leaves room for it.
    Baker(const GatherScene& scene, const ajar_settings& settings, ThreadPool& pool, Progress& progress,
          double seconds_to_store = 0.0);
    BakeResult run();

private:
    /// What a packet of a tile got beyond the first rays, and the weight of that answer.
    struct FurtherRays {
        RayPlan rays;
        float share = 0.0f;
    };

    /// The light that the final gather reflects, and its emitters.
    void find_source();
    void direct_source();
    void bounce(uint32_t index);
    void set_radiance(const std::vector<Vec3>& irradiance);
    void share_quads(const Tile& tile, const TileSums& sums, std::vector<Vec3>& out) const;
    /// The scene's emitters, and the texels of radiance_ that stand out, if they send out this share of all light.
    EmitterSet with_bright_texels(double least_share);
    void aimed_bounce(const GatherScene& scene, const Tile& tile, GatherOptions options);
    void keep_bounce(std::vector<Vec3>& irradiance);
    void plan_rays();
    NoiseTrial try_noise(const Tile& part, const MeasuredNoise& few, const RayPlan& rays, DirectGroups& groups,
                         uint32_t seed);
    template <class Visit>
    void visit_parts(const std::vector<Tile>& tiles, uint32_t seed, bool shows_progress, Visit&& visit);
    RareLight look_for_rare_light(const std::vector<Tile>& tiles, const RayPlan& rays);
    DirectGroups look_around(const Tile& tile, uint32_t seed);
    TileEstimate estimate(const Tile& tile, RayPlan plan, DirectGroups& groups, PacketChoice packets, uint32_t seed,
                          bool keep_sh);
    std::vector<FurtherRays> refine(const Tile& part, const TileEstimate& first, const NoiseGoal& goal,
                                    DirectGroups& groups, uint32_t seed, TileLight& light);
    void final_gather();
    void gather_in_rounds();
    void finish_tile(size_t tile);
    std::vector<FurtherRays> finish_part(const Tile& part, const RayPlan& plan, const NoiseGoal& goal,
                                         DirectGroups& groups, uint32_t seed);
    /// A second answer for the part of tile i that is checked.
    TileLight second_answer(size_t i, uint32_t seed);
    /// A baker with another source of fewer rays, to see how much the source's noise matters; null without bounces.
    std::unique_ptr<Baker> other_source();
    void calibrate_error();
    bool gathers() const;
    /// Seconds that the time limit leaves for the passes.
    double time_left() const;
    GatherScene scene_with(const EmitterSet& emitters) const {
        return {s_.scene, s_.tracer, s_.surfaces, emitters, s_.receivers, progress_, s_.spots};
    }
    GatherScene final_scene() const { return scene_with(*final_emitters_); }

    GatherScene s_;
    ajar_settings settings_;
    ThreadPool& pool_;
    Progress& progress_;
    double seconds_to_store_;
    bool in_background_ = false; ///< shows no progress of its own
    uint32_t source_samples_ = source_samples(settings_);
    double source_end_ = 0.0; ///< s, when find_source() was done
    BakeResult result_;
    NoiseGoal goal_;
    RayPlan first_;                    ///< rays of every receiver
    std::unique_ptr<GatherPace> pace_; ///< of a bake with a time limit
    std::vector<FurtherRays> further_; ///< per tile
    std::vector<Vec3> current_;        ///< irradiance of the bounce in hand
    std::unique_ptr<EmitterSet> final_emitters_;
    std::vector<Vec4> radiance_; ///< [page texels] outgoing radiance that the next gather sees; w = TexelFlag bits
};

} // namespace ajar
