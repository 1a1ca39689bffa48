// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <memory>

#include "base/memory.h"
#include "pass/bake.h"
#include "pass/term_merge.h"
#include "transport/boxes_in_sight.h"

namespace ajar {

/// Transport passes of a scene with light sets, doors or toggles. As Baker, but the light of every
/// receiver is a sparse row with one colour per term; the same rays serve all of them.
class TermBaker {
public:
    /// seconds_to_store: what follows takes per receiver and term; a time limit leaves room for it.
    TermBaker(const GatherScene& scene, const ajar_settings& settings, ThreadPool& pool, Progress& progress,
              double seconds_to_store = 0.0);
    /// Runs all passes. Throws Cancelled.
    BakeResult run();

private:
    struct Estimate;

    /// The light that the final gather reflects, its emitters and the doors it aims at.
    void find_source();
    void direct_source();
    void bounce(uint32_t index);
    /// Rows of one pass from its sums: gathered light shared inside blocks, plus direct light.
    TileRows tile_rows(const Tile& tile, const TermSums& gather, const TermSums* direct);
    void take(std::vector<TileRows>& tiles);
    /// Rows with one light set in place of all that combine alike.
    ReceiverRows sets_as_one(const ReceiverRows& rows);
    size_t tile_of(const Tile& part) const;
    TermLimits limits_at(const Tile& part) const;
    bool raise_order(const Tile& part, const TermSums& gather, uint32_t rays, const TermSums* direct);
    EmitterSet with_bright_texels(const ReceiverRows& light, double least_share);
    void find_thresholds();
    bool keeps(uint32_t receiver, const Term& term, const TermLight& light) const;
    ReceiverRows prune(const ReceiverRows& rows, float share, uint32_t seed) const;
    std::vector<TilePlan> plan_rays();
    static MeasuredNoise pilot_noise(const Estimate& estimate, uint32_t lanes);
    NoiseTrial try_noise(const Tile& tile, const Tile& part, const MeasuredNoise& few, const RayPlan& rays,
                         DirectGroups groups, const std::vector<uint32_t>& doors) const;
    DirectGroups look_around(const Tile& tile, uint32_t seed) const;
    void share_samples(DirectGroups& groups, const Tile& tile, const Tile& part, uint32_t samples) const;
    static constexpr uint32_t kAimedParts = kPilotParts + 1; ///< of a tile: its own and the ring
    struct Evenness;
    Evenness evenness(uint32_t set, uint32_t begin, uint32_t end) const;
    float stored_light(uint32_t begin, uint32_t end) const;
    /// Limits the samples of a set at receivers first to end of a tile; its luminance there, summed.
    float limit_set(DirectGroups& groups, const DirectGroups::Group& g, const Tile& tile, uint32_t first,
                    uint32_t end) const;
    void limit_samples(DirectGroups& groups, const Tile& tile, uint32_t first, uint32_t end) const;
    TileAims::Arrival arrival(const Ray& ray, const Hit& hit) const;
    float indirect_light(const Tile& tile) const;
    uint32_t rays_per_door(uint32_t samples) const;
    std::vector<uint32_t> find_doors(const Tile& part, uint32_t seed) const;
    void find_aims();
    uint32_t part_number(size_t tile, const Tile& piece) const;
    const std::vector<uint32_t>& doors_of(size_t tile, const Tile& piece) const;
    TileAims aim_at(const std::vector<uint32_t>& doors, const Tile& part, uint32_t samples) const;
    Estimate estimate(const Tile& tile, const RayPlan& plan, const DirectGroups& groups,
                      const std::vector<uint32_t>& doors, uint32_t seed) const;
    void final_gather(std::vector<TilePlan>& plan);
    /// finish_tile: of a tile; returns how much light it stores.
    void gather_in_rounds(std::vector<TilePlan>& plan, const std::function<size_t(size_t)>& finish_tile);
    std::vector<struct FinalPart> finish_parts(size_t tile, const TilePlan& plan);
    void store_tile(const Tile& tile, const Estimate& estimate, struct FinalPart& out);
    void add_at_start(size_t receiver, const Term& term, const TermLight& light);
    void join(std::vector<struct FinalPart>& parts);
    /// Another answer for the part of tile i that is checked.
    Estimate answer(size_t i, const TilePlan& plan, uint32_t seed) const;
    /// As in the plain bake; null also if memory does not reach.
    std::unique_ptr<TermBaker> other_source();
    void calibrate_error(const std::vector<TilePlan>& plan);
    bool gathers() const;
    /// Seconds that the time limit leaves for the passes if that much light gets stored beside the base.
    double time_left(double lights) const;
    std::vector<uint32_t> sets_of(const Tile& tile) const;
    /// Knows what lights a tile.
    const TermBaker& guide() const { return first_ != nullptr ? *first_ : *this; }
    GatherScene scene_with(const EmitterSet& emitters) const {
        return {s_.scene, s_.tracer, s_.surfaces, emitters, s_.receivers, progress_, s_.spots};
    }
    GatherScene final_scene() const { return scene_with(*final_emitters_); }

    GatherScene s_;
    ajar_settings settings_;
    ThreadPool& pool_;
    Progress& progress_;
    double seconds_to_store_;
    uint32_t gathering_ = 0; ///< receivers that gather coarse light themselves
    bool has_primary_;       ///< some lamp's direct light is not stored
    /// Whose source this second one repeats for all light sets together, without progress of its own, to tell its
    /// noise; null: this is the first.
    const TermBaker* first_ = nullptr;
    uint32_t set_samples_ = kSourceSamples;             ///< of a light set
    uint32_t base_samples_ = source_samples(settings_); ///< of emitters of none
    double source_end_ = 0.0;                           ///< s, when find_source() was done
    std::vector<uint32_t> order_;                       ///< [tiles] most elements of a term there
    std::vector<CutLight> source_cut_;                  ///< [tiles] in the first pass
    BakeResult result_;
    TermTable table_;
    std::vector<uint32_t> all_sets_;
    ReceiverRows direct_, current_, source_; ///< irradiance: of the sources, of the bounce in hand, of all bounces
    TermRows radiance_;                      ///< what the next gather sees
    std::vector<float> threshold_;           ///< per term: least luminance worth keeping where it is not lit directly
    std::unique_ptr<EmitterSet> final_emitters_;
    std::shared_ptr<BoxesInSight> doors_;                   ///< that rays are aimed at; null: none are
    std::vector<std::vector<std::vector<uint32_t>>> aimed_; ///< [bounces][tiles] doors that rays were aimed at
    std::vector<std::vector<uint32_t>> aims_;               ///< [tiles][kAimedParts] those of the final gather
    double pilot_pace_ = 0.0;                               ///< seconds per ray
    std::unique_ptr<TilePace> pace_;                        ///< where time is limited
    Effect bookkeeping_;                                    ///< what keeping terms apart counts as
    RowMaker rows_;
    MemoryBudget budget_; ///< of the pass in hand
};

} // namespace ajar
