// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>

#include "accel/embree_scene.h"
#include "api/check_states.h"
#include "package/baked_pages.h"
#include "package/terms_file.h"

namespace ajar {

/// What brute force said of the stored light in one state.
struct StateCheck {
    CheckedState state;
    uint32_t points = 0;
    double ratio = 1.0;       ///< light of the package over that of the reference, both summed
    double ratio_error = 0.0; ///< standard error of it
    double far_share = 0.0;   ///< of the points: further apart than a tenth and 4 standard errors

    /// How far it is out of bounds; up to 1 it is not.
    double excess() const;
};

/// What brute force said of a finished bake at random texels, as the run-time library shows it in several states.
struct SelfCheck {
    std::vector<StateCheck> states;
    BounceGain bounce_gain;  ///< the step from bounce to bounce that most surely grows; light that grows is wrong
    std::string not_checked; ///< why there are no states; empty: there are
    double seconds = 0.0;
    std::optional<TermsFile> terms_file; ///< of the package, as it was checked; a scene without elements has none

    /// The state that is furthest out of bounds.
    const StateCheck& worst() const;
};

/// Traces the reference at settings.check_points texels, or a quarter of that in each state of a scene with elements,
/// and compares it with the bytes that the package will hold. A failure, and no place to look at, become not_checked:
/// a finished bake is worth keeping without a check. Throws Cancelled.
SelfCheck check_bake(const Snapshot& scene, const Tracer& tracer, const LightmapReceivers& receivers,
                     const BakeResult& bake, const BakedPages& pages, const ajar_settings& settings, ThreadPool& pool,
                     Progress& progress);

/// Seconds that a check takes: those of its reference, which is traced for that and dropped.
double try_check(const Snapshot& scene, const Tracer& tracer, const ajar_settings& settings, ThreadPool& pool,
                 Progress& progress);

/// What work throws, in words; empty if it succeeds. Lets Cancelled pass.
std::string why_not(const std::function<void()>& work);

/// The step that grows by most beyond 4 standard errors, the first one left out.
BounceGain largest_gain(const std::vector<BounceGain>& steps);

/// One texel of both answers: luminance and its standard error, W/m^2.
struct CheckPoint {
    float baked, baked_error, reference, reference_error;
};

/// Compares the points of a state. dark: light that does not matter, W/m^2; differences are over the reference, of a
/// texel or of all, but over dark at least.
StateCheck compare_points(const std::vector<CheckPoint>& points, double dark);

/// What a check that is out of bounds tells the artist.
std::vector<Warning> check_warnings(const SelfCheck& check, const std::string& scene_name);

} // namespace ajar
