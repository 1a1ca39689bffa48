// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "accel/embree_scene.h"
#include "package/baked_pages.h"

namespace ajar {

/// What brute force said of a finished bake at random texels, with every element at weight 1: base and all
/// terms together.
struct SelfCheck {
    uint32_t points = 0;
    double ratio = 1.0;       ///< light of the bake over that of the reference, both summed
    double ratio_error = 0.0; ///< standard error of it
    double far_share = 0.0;   ///< of the points: further apart than a tenth and 4 standard errors
    BounceGain bounce_gain;   ///< the step from bounce to bounce that most surely grows; light that grows is wrong
    std::string not_checked;  ///< why nothing above is known but the gain; empty: it is
    double seconds = 0.0;
};

/// Traces the reference at settings.check_points texels and compares. A failure, and no place to look at, become
/// not_checked: a finished bake is worth keeping without a check. Throws Cancelled.
SelfCheck check_bake(const Snapshot& scene, const Tracer& tracer, const LightmapReceivers& receivers,
                     const BakeResult& bake, const BakedPages& pages, const ajar_settings& settings, ThreadPool& pool,
                     Progress& progress);

/// Seconds that a check takes: those of its reference, which is traced for that and dropped.
double try_check(const Snapshot& scene, const Tracer& tracer, const ajar_settings& settings, ThreadPool& pool,
                 Progress& progress);

/// One texel of both answers: luminance and its standard error, W/m^2.
struct CheckPoint {
    float baked, baked_error, reference, reference_error;
};

/// What work throws, in words; empty if it succeeds. Lets Cancelled pass.
std::string why_not(const std::function<void()>& work);

/// The step that grows by most beyond 4 standard errors, the first one left out.
BounceGain largest_gain(const std::vector<BounceGain>& steps);

/// Compares; bounce_gain and seconds are left alone.
void compare_points(const std::vector<CheckPoint>& points, SelfCheck& check);

/// What a check that is out of bounds tells the artist.
std::vector<Warning> check_warnings(const SelfCheck& check, const std::string& scene_name);

} // namespace ajar
