// SPDX-License-Identifier: GPL-3.0-or-later
// Series expansion (algorithms.md 5): the direct light of every source, then one coarse gather
// per bounce, then one fine gather of everything into the directional basis. Each pass reads only
// what the pass before it finished, so no result depends on the order of tiles.
#include "pass/bake.h"

#include <memory>

#include "pass/bright_patches.h"
#include "pass/tile_estimate.h"

namespace ajar {

Baker::Baker(const GatherScene& scene, const ajar_settings& settings, ThreadPool& pool, Progress& progress,
             double seconds_to_store)
    : s_(scene), settings_(settings), pool_(pool), progress_(progress), seconds_to_store_(seconds_to_store) {
    current_.resize(s_.receivers.count());
    radiance_.resize(s_.scene.texel_count());
}

/// Something can arrive along a gather ray: emission or the sky, or light off other surfaces.
bool Baker::gathers() const {
    return settings_.bounces > 0 || s_.scene.sky.lit() || s_.emitters.emissive_triangles() > 0;
}

void Baker::set_radiance(const std::vector<Vec3>& irradiance) {
    for (uint32_t r = 0; r < s_.receivers.count(); ++r)
        radiance_[s_.receivers.texel[r]] =
            Vec4(irradiance[r] * s_.receivers.albedo[r] * kInvPi, s_.receivers.cut[r] != 0 ? float{kTexelCut} : 0.0f);
}

/// Ends a pass that made irradiance.
void Baker::keep_bounce(std::vector<Vec3>& irradiance) {
    for (uint32_t r = 0; r < s_.receivers.count(); ++r) irradiance[r] = irradiance[s_.receivers.coarse_from[r]];
    double sum = 0.0;
    for (const Vec3& e : irradiance) sum += luminance(e);
    result_.bounce_means.push_back(irradiance.empty() ? 0.0 : sum / static_cast<double>(irradiance.size()));
    result_.growth.add(s_.receivers, [&](uint32_t r) { return luminance(irradiance[r]); });
    if (settings_.keep_bounces != 0) result_.bounces.push_back(irradiance);
    if (result_.source.empty()) result_.source.resize(irradiance.size(), Vec3(0.0f));
    for (size_t i = 0; i < irradiance.size(); ++i) result_.source[i] += irradiance[i];
}

void Baker::direct_source() {
    const bool rays_needed = s_.scene.sky.lit() || s_.emitters.emissive_triangles() > 0;
    pool_.for_each(
        s_.receivers.tiles.size(), progress_,
        [&](size_t i) {
            const Tile tile = split(s_.receivers, s_.receivers.tiles[i]).coarse;
            if (tile.count == 0) return;
            const uint32_t seed = hash_combine(settings_.seed, kSaltSource);
            DirectGroups groups(s_.emitters, LightRoles::all, {});
            uint64_t rays = groups.begin(s_.tracer, s_.receivers, tile, source_samples_, source_samples_,
                                         hash_combine(seed, s_.receivers.texel[tile.first]));
            auto direct = make_sums(false), gather = make_sums(false);
            const uint32_t gather_rays = rays_needed ? bounce_rays(settings_) : 0;
            rays +=
                sample_direct(s_, groups.groups()[0], tile, {static_cast<float>(gather_rays), 1.0f}, seed, {}, *direct);
            if (rays_needed) rays += gather_tile(s_, tile, source_options(settings_, groups, seed), nullptr, *gather);
            share_quads(tile, *gather, current_);
            for (uint32_t lane = 0; lane < tile.count; ++lane)
                current_[tile.first + lane] += sum_of(*direct, lane) / static_cast<float>(source_samples_);
            progress_.add_rays(rays);
        },
        !in_background_);
    keep_bounce(current_);
}

/// Mean irradiance of the receivers of each 2x2 block with like normals. Enough for light that will
/// be gathered once more, with a quarter of the rays.
void Baker::share_quads(const Tile& tile, const TileSums& sums, std::vector<Vec3>& out) const {
    for (uint32_t lane = 0; lane < tile.count; ++lane) {
        const uint32_t r = tile.first + lane;
        Vec3 total(0.0f);
        float count = 0.0f;
        for (const uint32_t q : block_of(s_.scene, s_.receivers, r)) {
            if (q != r && !may_share(s_.receivers, q, r)) continue;
            total += gathered(sums, q - tile.first);
            count += 1.0f;
        }
        out[r] = total / count;
    }
}

/// A tile's part of a bounce that aims at bright texels.
void Baker::aimed_bounce(const GatherScene& scene, const Tile& tile, GatherOptions o) {
    auto sums = make_sums(false), aimed = make_sums(false);
    DirectGroups groups(scene.emitters, LightRoles::reflected, {});
    uint64_t rays = begin_bounce(scene, tile, o, groups);
    const DirectGroups::Group& bright = groups.groups()[0];
    rays += sample_direct(scene, bright, tile, {static_cast<float>(o.samples), 1.0f}, o.seed, {}, *aimed);
    rays += gather_tile(scene, tile, o, radiance_.data(), *sums);
    share_quads(tile, *sums, current_);
    for (uint32_t lane = 0; bright.samples != 0 && lane < tile.count; ++lane)
        current_[tile.first + lane] += sum_of(*aimed, lane) / static_cast<float>(bright.samples);
    progress_.add_rays(rays);
}

/// One bounce: irradiance from radiance_ into current_.
void Baker::bounce(uint32_t index) {
    const EmitterSet emitters = with_bright_texels(kAimedBounce);
    const GatherScene scene = scene_with(emitters);
    pool_.for_each(
        s_.receivers.tiles.size(), progress_,
        [&](size_t i) {
            const Tile tile = split(s_.receivers, s_.receivers.tiles[i]).coarse;
            if (tile.count == 0) return;
            const GatherOptions o = bounce_options(settings_, index);
            if (emitters.has_bright_texels()) return aimed_bounce(scene, tile, o);
            auto sums = make_sums(false);
            progress_.add_rays(gather_tile(scene, tile, o, radiance_.data(), *sums));
            share_quads(tile, *sums, current_);
        },
        !in_background_);
    keep_bounce(current_);
}

EmitterSet Baker::with_bright_texels(double least_share) {
    BrightTexels bright;
    if (settings_.bounces > 0) {
        const auto radiance = [&](uint32_t r) { return Vec3(radiance_[s_.receivers.texel[r]]); };
        bright = find_bright_texels(s_.scene, s_.receivers, radiance, least_share);
        for (const uint32_t r : bright.receivers) radiance_[s_.receivers.texel[r]].w += float{kTexelBright};
    }
    result_.bright_texels = static_cast<uint32_t>(bright.receivers.size());
    return s_.emitters.with_bright_texels(std::move(bright.patches));
}

void Baker::find_source() {
    if (!in_background_) progress_.begin_stage(AJAR_STAGE_DIRECT, 0.12f);
    if (settings_.bounces > 0 || settings_.keep_bounces != 0) direct_source();
    if (!in_background_) progress_.begin_stage(AJAR_STAGE_BOUNCES, 0.25f);
    run_bounces(settings_.bounces + (settings_.keep_bounces != 0 ? 1 : 0), settings_, progress_, result_.trial,
                [&](uint32_t b) {
                    set_radiance(current_);
                    bounce(b);
                });
    if (settings_.bounces > 0) {
        // With every bounce kept apart the last one was made for show; the gather adds it itself.
        if (settings_.keep_bounces != 0)
            for (size_t i = 0; i < current_.size(); ++i)
                result_.source[i] -=
                    result_.bounces.back()[i] * (result_.bounces.size() > settings_.bounces ? 1.0f : 0.0f);
        set_radiance(result_.source);
    }
    final_emitters_ = std::make_unique<EmitterSet>(with_bright_texels(0.0));
    source_end_ = progress_.elapsed();
}

BakeResult Baker::run() {
    find_source();
    progress_.begin_stage(AJAR_STAGE_PILOT, 0.30f);
    plan_rays();
    progress_.begin_stage(AJAR_STAGE_GATHER, 0.93f);
    final_gather();
    if (settings_.trial == 0) calibrate_error();
    return std::move(result_);
}

} // namespace ajar
