// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What the passes with and without elements share.

#include <vector>

#include "base/hash.h"
#include "pass/trial_gather.h"
#include "transport/direct.h"

namespace ajar {

inline constexpr uint32_t kPilotRays = 32;
inline constexpr uint32_t kPilotParts = 4;     ///< of each tile: its light may differ much from place to place
inline constexpr uint32_t kPilotReceivers = 8; ///< of each part
inline constexpr double kPlannedPart = 0.97;   ///< of the time left for the final gather; checks of the error follow
inline constexpr float kFinalShare = 0.5f;     ///< cosine share of the final rays (algorithms.md 1.10)

enum BakeSalt : uint32_t {
    kSaltSource = 1,
    kSaltBounce = 2,
    kSaltPilot = 3,
    kSaltFinal = 4,
    kSaltTwin = 5,
    kSaltRareLight = 6
};

/// Ray counts of a tile.
struct RayPlan {
    uint32_t gather = 0, direct = 0;
};

/// The rays of a ring receiver are a quarter of what its place would get. Lookups at a chart's edge give it at most
/// half their weight, at a corner three of them a quarter each: with twice the standard error there, none is much
/// noisier than the texels of the chart are.
inline constexpr uint32_t kRingShare = 4;
RayPlan ring_rays(const RayPlan& plan);
/// Whether receivers of the ring get that: else rays follow neither a noise nor a time, and all get the same number.
inline bool spares_rays(const ajar_settings& s) { return s.noise_target > 0.0f || s.time_limit > 0.0f; }
/// Receivers of each tile as rays count them then: those of the ring are a part of one.
std::vector<double> ray_weights(const LightmapReceivers& receivers);

/// Light and noise of some receivers with given ray counts, pooled.
struct MeasuredNoise {
    float level = 0.0f;           ///< mean luminance of the irradiance
    float gather_variance = 0.0f; ///< of a receiver's estimate
    float direct_variance = 0.0f;
};

/// Receivers of one block share coarse light if no wall stands between and their normals agree.
bool may_share(const LightmapReceivers& receivers, uint32_t a, uint32_t b);

/// Samples per receiver and bounce that aim at bright texels, over the rays of a bounce.
inline constexpr uint32_t kBrightShare = 4;

/// Share of bright texels in all light from which on bounces aim at them: a lamp in the corner of a room has .86, and
/// aiming halves the noise that its bounces leave; game levels of .01 to .03 only get slower.
inline constexpr double kAimedBounce = 0.1;

/// Rays per receiver of a bounce: blocks of four receivers share theirs.
inline uint32_t bounce_rays(const ajar_settings& settings) { return std::max(settings.bounce_samples / 4, 4u); }

/// Emitter samples per receiver that feed the bounces, of a light set.
inline constexpr uint32_t kSourceSamples = 16;
/// Of the emitters of none: as many as a bounce has rays, so that both get less noisy together. With 16 the sun through
/// a window of 40 cm, a spot of 1.6 texels, left 5 % of noise in all light that it throws around the room, whatever the
/// preset; with the 256 of Production .9 %, for 1 % of the time.
inline uint32_t source_samples(const ajar_settings& settings) {
    return std::max(bounce_rays(settings), kSourceSamples);
}

/// 1% of the median level: what counts as dark.
float dark_level(std::vector<float> levels);
float dark_level(const std::vector<MeasuredNoise>& pilot);

/// First receiver of part k of a tile that has count; count for kPilotParts. Parts are whole packets.
uint32_t part_begin(uint32_t count, uint32_t k);
/// The receivers of part k.
Tile tile_part(const Tile& tile, uint32_t k);
/// The part that a receiver lies in.
uint32_t part_of(uint32_t count, uint32_t local);
/// Receivers that stand for a part of a tile in the pilot pass.
Tile pilot_part(const Tile& tile, uint32_t part);

/// Gather rays that meet what shines, beside the emitter samples of groups; they feed the bounces.
GatherOptions source_options(const ajar_settings& settings, const DirectGroups& groups, uint32_t seed);
/// Gather rays of a bounce, counted from 1.
GatherOptions bounce_options(const ajar_settings& settings, uint32_t index);
/// Prepares samples of bright texels (LightRoles::reflected) for a tile, with which those rays share. Returns the rays
/// traced.
uint64_t begin_bounce(const GatherScene& scene, const Tile& tile, GatherOptions& options, DirectGroups& groups);
/// Final gather rays of a plan that share emission with the emitter samples of groups.
GatherOptions final_options(const RayPlan& plan, const ajar_settings& settings, const DirectGroups& groups,
                            uint32_t seed);

/// Tiles of a gather against the clock are done in rounds, each of tiles from all over the scene.
struct Rounds {
    static constexpr size_t kMost = 16;
    size_t tiles;

    size_t count() const { return std::min(tiles, kMost); }
    size_t size(size_t round) const { return (tiles - round + count() - 1) / count(); }
    /// Number k of a round.
    size_t tile(size_t round, size_t k) const { return round + k * count(); }
    /// Round of a tile.
    size_t of(size_t tile) const { return tile % count(); }
};

/// Rays per bounce for the passes that are left after one that began at start, so that a short time limit leaves
/// most of the time to the final gather. Seconds.
uint32_t bounce_samples_in_time(const ajar_settings& settings, double start, double now, uint32_t passes_left);

/// Runs passes 1 to count - 1 by bounce(pass). settings.bounce_samples follows a time limit from pass to pass; in a
/// trial it is fewer, and trial.bounces becomes what all of them would have taken.
void run_bounces(uint32_t count, ajar_settings& settings, const Progress& progress, TrialTimes& trial,
                 const std::function<void(uint32_t)>& bounce);

} // namespace ajar
