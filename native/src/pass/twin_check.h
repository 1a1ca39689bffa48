// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pass/bake.h"

namespace ajar {

/// The strata estimate of noise is biased up where strata differ in mean, and knows nothing of the noise of the
/// light that the final gather reflects. Further independent answers for some receivers of a bake measure both,
/// in the norm in which the error is stated: relative to the light, root mean square over valid texels, where no texel
/// counts as more than all wrong.
class TwinCheck {
public:
    /// Of a bake whose result holds light and validity already. Both must outlive it.
    TwinCheck(const LightmapReceivers& receivers, const BakeResult& result);

    /// Tiles that are estimated twice: every step-th.
    size_t step() const { return step_; }
    size_t count() const { return parts_.size(); }
    /// Part of a bake's rays that make another source, of the light that its final gather reflects.
    static constexpr uint32_t kSourcePart = 4;

    /// The receivers of tile i that are estimated twice, all on charts: of one tile the first, of another the last.
    static Tile part(const LightmapReceivers& receivers, size_t i);

    /// Answers for a receiver, as luminance, W/m^2.
    struct Answers {
        float first, second;   ///< from the bake's source
        float other;           ///< from another source, of fewer rays; second if there is none
        double variance = 0.0; ///< what strata say of the first two, mean
    };
    /// Notes the answers for a receiver of tile k * step(). Safe from threads with different k.
    void compare(size_t k, uint32_t receiver, const Answers& answers);
    /// What follows for all standard errors; to 1 if the answers are too few.
    /// ratio: rays of the bake's source over those of the other.
    ErrorCalibration finish(double ratio) const;

private:
    /// Sums over the receivers of one tile.
    struct Part {
        double twin = 0.0;   ///< half squared differences of answers from one source
        double other = 0.0;  ///< from two sources
        double strata = 0.0; ///< variances that the strata state
    };
    const LightmapReceivers& receivers_;
    const BakeResult& result_;
    size_t step_;
    float dark_;
    std::vector<Part> parts_;
};

/// Seconds that the check of a bake's error takes: another source, and further answers. source, gather: seconds of
/// the bake's own source and final gather.
double check_seconds(size_t tiles, uint32_t bounces, double source, double gather);
/// Seconds that a time limit leaves, once the source is there, for the final gather and what follows its check.
/// source_end: elapsed when the source was there.
double seconds_left(const ajar_settings& settings, const Progress& progress, size_t tiles, double source_end);

/// Settings of a bake that makes another source for one with these.
ajar_settings other_source_settings(ajar_settings settings);
/// Bounce rays of a bake with these settings over those of its other source.
double source_rays_ratio(const ajar_settings& settings);
/// Emitter samples of the other source of a bake with samples: fewer by the same ratio, so that all of its noise is
/// larger by one factor.
uint32_t other_source_samples(const ajar_settings& settings, uint32_t samples);

} // namespace ajar
