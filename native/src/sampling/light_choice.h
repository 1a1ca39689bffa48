// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "receiver/lightmap.h"
#include "sampling/emitters.h"

namespace ajar {

/// Which emitters count: all feed the bounces; those whose direct light is stored; bright texels alone, in a bounce.
enum class LightRoles { all, stored, reflected };

/// Picks emitters for the receivers of one tile in proportion to what they probably contribute:
/// unshadowed irradiance at the receiver times the visibility that a few shadow rays of the tile
/// found. Every emitter that could matter keeps a chance, so the estimate stays unbiased.
class LightChoice {
public:
    /// choices: ids of the emitters to choose from.
    LightChoice(const EmitterSet& emitters, LightRoles roles, std::vector<uint32_t> choices)
        : emitters_(emitters), roles_(roles), choices_(std::move(choices)) {}

    /// Prepares for a tile; traces the visibility rays. Returns how many.
    uint64_t begin(const Tracer& tracer, const LightmapReceivers& receivers, const Tile& tile, uint32_t seed);
    /// Nothing lights this tile.
    bool empty() const { return candidates_.empty(); }
    /// Some visibility ray met a light, or there was too little to choose from to ask.
    bool seen() const { return seen_; }
    /// Rough variance of one sample over its squared mean, from the visibility rays; 0 if they saw nothing.
    float relative_variance() const { return relative_variance_; }
    /// What a receiver probably gets from all of them, unshadowed irradiance times visibility, luminance. Counts from
    /// the tile's first receiver, whatever start_at() says.
    float expected_light(uint32_t receiver) const {
        return candidates_.empty() ? 0.0f : running_[size_t{receiver} * (fine_ + 1) + fine_];
    }
    /// From now on receivers count from this one of the tile on.
    void start_at(uint32_t local) { base_ = local; }
    /// Emitter for u in [0,1) and the chance it had; u is rescaled to be used again.
    uint32_t pick(uint32_t local, float& u, float& chance) const;
    /// Chance of an emitter at a receiver of the tile, for MIS.
    float chance(uint32_t local, uint32_t emitter) const;

private:
    struct Candidate {
        uint32_t emitter;
        float weight;               ///< mean importance over the tile
        float share;                ///< of all importance at a receiver, mean over the tile
        std::vector<float> running; ///< [probes] running importance: where in the tile it matters
    };
    void find_candidates(const LightmapReceivers& receivers, const Tile& tile);
    void weigh_candidates(const LightmapReceivers& receivers, const Tile& tile);
    static uint32_t place_of(const Candidate& candidate, const Tile& tile, const Vec2& u);
    /// What a candidate's visibility rays brought, each over the importance where it started.
    struct Seen {
        uint32_t rays = 0, arrived = 0;
        float sum = 0.0f, squares = 0.0f;
    };
    Seen look(const Tracer& tracer, const LightmapReceivers& receivers, const Tile& tile, uint32_t candidate,
              uint32_t seed) const;
    std::vector<Seen> look_for_candidates(const Tracer& tracer, const LightmapReceivers& receivers, const Tile& tile,
                                          uint32_t seed, uint64_t& rays);
    uint64_t learn_visibility(const Tracer& tracer, const LightmapReceivers& receivers, const Tile& tile,
                              uint32_t seed);
    void find_variance(const std::vector<Seen>& seen);

    const float* row(uint32_t local) const { return &running_[size_t{base_ + local} * (fine_ + 1)]; }

    const EmitterSet& emitters_;
    LightRoles roles_;
    std::vector<uint32_t> choices_;
    bool seen_ = true;
    float relative_variance_ = 0.0f;
    std::vector<Candidate> candidates_; ///< strongest first; the first fine_ are weighed per receiver
    uint32_t fine_ = 0, base_ = 0;
    std::vector<float> visibility_;   ///< [fine_]
    float rest_scale_ = 1.0f;         ///< of the weights of the others
    std::vector<float> running_;      ///< [tile.count][fine_ + 1] running weights, last is the rest
    std::vector<float> rest_running_; ///< candidates from fine_ on
    std::vector<uint32_t> slot_of_;   ///< per emitter: candidate index or kNone
};

} // namespace ajar
