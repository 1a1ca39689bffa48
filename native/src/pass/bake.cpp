// SPDX-License-Identifier: GPL-3.0-or-later
// Series expansion (algorithms.md 5): the direct light of every source, then one coarse gather
// per bounce, then one fine gather of everything into the directional basis. Each pass reads only
// what the pass before it finished, so no result depends on the order of tiles.
#include "pass/bake.h"

#include <memory>

#include "pass/bake_parts.h"

namespace ajar {

namespace {

std::unique_ptr<TileSums> make_sums(bool keep_sh) {
    auto sums = std::make_unique<TileSums>();
    sums->clear(keep_sh);
    return sums;
}

Vec3 sum_of(const TileSums& s, uint32_t lane) {
    return {s.irradiance[0][lane], s.irradiance[1][lane], s.irradiance[2][lane]};
}

/// Gather sums to irradiance. Dividing by the sum of cosine weights instead of its expectation
/// is a ratio estimator: it cancels the noise of the weights, so a uniform room stays uniform.
Vec3 gathered(const TileSums& s, uint32_t lane) {
    return s.cosine_sum[lane] > 0.0f ? sum_of(s, lane) * (kPi / s.cosine_sum[lane]) : Vec3(0.0f);
}

} // namespace

/// One tile's answer before it is stored.
struct Baker::TileEstimate {
    std::unique_ptr<TileSums> direct, gather;
    RayPlan plan;

    Vec3 irradiance(uint32_t lane) const {
        Vec3 e = gathered(*gather, lane);
        if (plan.direct != 0) e += sum_of(*direct, lane) / static_cast<float>(plan.direct);
        return e;
    }
    double gather_variance(uint32_t lane) const {
        const auto n = static_cast<double>(std::max(plan.gather, 1u));
        return gather->pairs[lane] / (n * n);
    }
    double direct_variance(uint32_t lane) const {
        const auto n = static_cast<double>(std::max(plan.direct, 1u));
        return direct->pairs[lane] / (n * n);
    }
};

Baker::Baker(const GatherScene& scene, const ajar_settings& settings, ThreadPool& pool, Progress& progress)
    : s_(scene), settings_(settings), pool_(pool), progress_(progress) {
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

void Baker::keep_bounce(const std::vector<Vec3>& irradiance) {
    double sum = 0.0;
    for (const Vec3& e : irradiance) sum += luminance(e);
    result_.bounce_means.push_back(irradiance.empty() ? 0.0 : sum / static_cast<double>(irradiance.size()));
    if (settings_.keep_bounces != 0) result_.bounces.push_back(irradiance);
    if (result_.source.empty()) result_.source.resize(irradiance.size(), Vec3(0.0f));
    for (size_t i = 0; i < irradiance.size(); ++i) result_.source[i] += irradiance[i];
}

void Baker::direct_source() {
    const bool rays_needed = s_.scene.sky.lit() || s_.emitters.emissive_triangles() > 0;
    pool_.for_each(s_.receivers.tiles.size(), progress_, [&](size_t i) {
        const Tile& tile = s_.receivers.tiles[i];
        const uint32_t seed = hash_combine(settings_.seed, kSaltSource);
        DirectGroups groups(s_.emitters, LightRoles::all, {});
        uint64_t rays = groups.begin(s_.tracer, s_.receivers, tile, kSourceSamples, kSourceSamples,
                                     hash_combine(seed, s_.receivers.texel[tile.first]));
        auto direct = make_sums(false), gather = make_sums(false);
        const uint32_t gather_rays = rays_needed ? std::max(settings_.bounce_samples / 4, 4u) : 0;
        rays += sample_direct(s_, groups.groups()[0], tile, {static_cast<float>(gather_rays), 1.0f}, seed, *direct);
        if (rays_needed) {
            GatherOptions o;
            o.samples = gather_rays;
            o.emission = true;
            o.direct = &groups;
            o.seed = seed;
            rays += gather_tile(s_, tile, o, nullptr, *gather);
        }
        share_quads(tile, *gather, current_);
        for (uint32_t lane = 0; lane < tile.count; ++lane)
            current_[tile.first + lane] += sum_of(*direct, lane) / static_cast<float>(kSourceSamples);
        progress_.add_rays(rays);
    });
    keep_bounce(current_);
}

/// Mean irradiance of the receivers of each 2x2 block with like normals. Enough for light that will
/// be gathered once more, with a quarter of the rays.
void Baker::share_quads(const Tile& tile, const TileSums& sums, std::vector<Vec3>& out) const {
    for (uint32_t lane = 0; lane < tile.count; ++lane) {
        const uint32_t r = tile.first + lane;
        Vec3 total(0.0f);
        float count = 0.0f;
        for (auto [q, end] = block_of(s_.scene, s_.receivers, tile, r); q < end; ++q) {
            if (q != r && !may_share(s_.receivers, q, r)) continue;
            total += gathered(sums, q - tile.first);
            count += 1.0f;
        }
        out[r] = total / count;
    }
}

/// One bounce: irradiance from radiance_ into current_.
void Baker::bounce(uint32_t index) {
    pool_.for_each(s_.receivers.tiles.size(), progress_, [&](size_t i) {
        const Tile& tile = s_.receivers.tiles[i];
        auto sums = make_sums(false);
        GatherOptions o;
        o.samples = std::max(settings_.bounce_samples / 4, 4u);
        o.unmapped_direct = index == 1;
        o.seed = hash_combine(hash_combine(settings_.seed, kSaltBounce), index);
        progress_.add_rays(gather_tile(s_, tile, o, radiance_.data(), *sums));
        share_quads(tile, *sums, current_);
    });
    keep_bounce(current_);
}

Baker::TileEstimate Baker::estimate(const Tile& tile, const RayPlan& plan, uint32_t seed, bool keep_sh) {
    TileEstimate t{make_sums(keep_sh), make_sums(keep_sh), plan};
    const GatherScene scene = final_scene();
    DirectGroups groups(scene.emitters, LightRoles::stored, {});
    uint64_t rays = groups.begin(s_.tracer, s_.receivers, tile, plan.direct, plan.direct,
                                 hash_combine(seed, s_.receivers.texel[tile.first]));
    t.plan.direct = groups.groups()[0].samples;
    rays +=
        sample_direct(scene, groups.groups()[0], tile, {static_cast<float>(plan.gather), kFinalShare}, seed, *t.direct);
    if (plan.gather != 0) {
        GatherOptions o;
        o.samples = plan.gather;
        o.share = kFinalShare;
        o.emission = true;
        o.unmapped_direct = settings_.bounces > 0;
        o.direct = &groups;
        o.seed = seed;
        rays += gather_tile(scene, tile, o, settings_.bounces > 0 ? radiance_.data() : nullptr, *t.gather);
    }
    progress_.add_rays(rays);
    return t;
}

EmitterSet Baker::find_bright_texels() {
    std::vector<BrightTexel> bright;
    if (settings_.bounces > 0) {
        std::vector<float> level(s_.receivers.count());
        for (uint32_t r = 0; r < s_.receivers.count(); ++r)
            level[r] = luminance(Vec3(radiance_[s_.receivers.texel[r]]));
        for (const uint32_t r : bright_receivers(s_.receivers, level)) {
            Vec4& radiance = radiance_[s_.receivers.texel[r]];
            bright.push_back(bright_texel(s_.scene, s_.receivers, r));
            bright.back().radiance = Vec3(radiance);
            radiance.w += float{kTexelBright};
        }
    }
    result_.bright_texels = static_cast<uint32_t>(bright.size());
    return s_.emitters.with_bright_texels(std::move(bright));
}

/// Pilot: few receivers of every tile with few rays, discarded afterwards; their pooled variance
/// decides each tile's ray counts once (algorithms.md 10.3, 10.4).
std::vector<RayPlan> Baker::plan_rays() {
    const size_t count = s_.receivers.tiles.size();
    std::vector<RayPlan> plan(count, {gathers() ? settings_.samples : 0, settings_.direct_samples});
    const bool timed = settings_.time_limit > 0.0f;
    if (!(settings_.noise_target > 0.0f) && !timed) return plan;

    std::vector<PilotResult> pilot(count * kPilotParts);
    const uint64_t rays_before = progress_.rays();
    const double start = progress_.elapsed();
    const RayPlan small{gathers() ? kPilotRays : 0, std::min(settings_.direct_samples, kPilotRays)};
    pool_.for_each(pilot.size(), progress_, [&](size_t i) {
        const Tile tile = pilot_part(s_.receivers.tiles[i / kPilotParts], i % kPilotParts);
        const TileEstimate t = estimate(tile, small, hash_combine(settings_.seed, kSaltPilot), false);
        const float share = 1.0f / static_cast<float>(tile.count);
        for (uint32_t lane = 0; lane < tile.count; ++lane) {
            pilot[i].level += luminance(t.irradiance(lane)) * share;
            pilot[i].gather_variance += static_cast<float>(t.gather_variance(lane)) * share;
            pilot[i].direct_variance += static_cast<float>(t.direct_variance(lane)) * share;
        }
    });
    const double seconds_per_ray =
        (progress_.elapsed() - start) / std::max<double>(1.0, static_cast<double>(progress_.rays() - rays_before));
    if (settings_.noise_target > 0.0f) plan = plan_for_noise(pilot, small, settings_, gathers());
    if (timed)
        result_.time_limited =
            limit_time(plan, s_.receivers.tiles, seconds_per_ray, 0.92 * (settings_.time_limit - progress_.elapsed()));
    return plan;
}

void Baker::final_gather(const std::vector<RayPlan>& plan) {
    const uint32_t n = s_.receivers.count();
    const bool keep_sh = settings_.keep_sh != 0;
    result_.irradiance.resize(n);
    result_.sh.resize(size_t{n} * kShCount);
    result_.sh_rgb.resize(keep_sh ? size_t{n} * 3 * kShCount : 0);
    result_.standard_error.resize(n);
    result_.samples.resize(n);
    result_.inside.resize(n);
    pool_.for_each(s_.receivers.tiles.size(), progress_, [&](size_t i) {
        const Tile& tile = s_.receivers.tiles[i];
        const TileEstimate t = estimate(tile, plan[i], hash_combine(settings_.seed, kSaltFinal), keep_sh);
        const float gn = 1.0f / static_cast<float>(std::max(t.plan.gather, 1u)),
                    dn = 1.0f / static_cast<float>(std::max(t.plan.direct, 1u));
        for (uint32_t lane = 0; lane < tile.count; ++lane) {
            const size_t r = tile.first + lane;
            result_.irradiance[r] = t.irradiance(lane);
            result_.standard_error[r] =
                static_cast<float>(std::sqrt(t.gather_variance(lane) + t.direct_variance(lane)));
            result_.samples[r] = static_cast<float>(t.plan.gather);
            result_.inside[r] = t.gather->inside[lane] * gn;
            for (int c = 0; c < kShCount; ++c)
                result_.sh[r * kShCount + c] = t.gather->sh[c][lane] * gn + t.direct->sh[c][lane] * dn;
            for (int c = 0; c < (keep_sh ? 3 * kShCount : 0); ++c) {
                const size_t j = size_t(c) * kTileReceivers + lane;
                result_.sh_rgb[r * 3 * kShCount + c] = t.gather->sh_rgb[j] * gn + t.direct->sh_rgb[j] * dn;
            }
        }
    });
}

/// The strata estimate is biased up where strata differ in mean. A second, independent answer
/// for a few receivers measures by how much.
void Baker::calibrate_error(const std::vector<RayPlan>& plan) {
    const size_t count = s_.receivers.tiles.size() / kCalibrationStep;
    std::vector<Vec2> parts(count, Vec2(0.0f));
    pool_.for_each(
        count, progress_,
        [&](size_t k) {
            const size_t i = k * kCalibrationStep;
            const Tile& whole = s_.receivers.tiles[i];
            const Tile tile{whole.first, std::min(kPilotReceivers, whole.count)};
            const TileEstimate t = estimate(tile, plan[i], hash_combine(settings_.seed, kSaltTwin), false);
            for (uint32_t lane = 0; lane < tile.count; ++lane) {
                const size_t r = tile.first + lane;
                const float a = luminance(result_.irradiance[r]), b = luminance(t.irradiance(lane));
                const float level = 0.5f * (a + b);
                if (!(level > 0.0f)) continue;
                const float se = result_.standard_error[r] / level, d = (a - b) / level;
                if (se < 1e-5f) continue;
                parts[k] += Vec2(0.5f * d * d, se * se);
            }
        },
        false);
    double twin = 0.0, strata = 0.0;
    for (const Vec2& p : parts) twin += p.x, strata += p.y;
    if (count < 8 || !(strata > 0.0)) return;
    result_.error_calibration = static_cast<float>(std::clamp(std::sqrt(twin / strata), 0.25, 4.0));
    for (float& e : result_.standard_error) e *= result_.error_calibration;
}

BakeResult Baker::run() {
    progress_.begin_stage(AJAR_STAGE_DIRECT, 0.12f);
    if (settings_.bounces > 0 || settings_.keep_bounces != 0) direct_source();
    progress_.begin_stage(AJAR_STAGE_BOUNCES, 0.25f);
    const uint32_t passes = settings_.bounces + (settings_.keep_bounces != 0 ? 1 : 0);
    for (uint32_t b = 1; b < passes; ++b) {
        set_radiance(current_);
        bounce(b);
    }
    if (settings_.bounces > 0) {
        // With every bounce kept apart the last one was made for show; the gather adds it itself.
        if (settings_.keep_bounces != 0)
            for (size_t i = 0; i < current_.size(); ++i)
                result_.source[i] -=
                    result_.bounces.back()[i] * (result_.bounces.size() > settings_.bounces ? 1.0f : 0.0f);
        set_radiance(result_.source);
    }
    final_emitters_ = std::make_unique<EmitterSet>(find_bright_texels());
    progress_.begin_stage(AJAR_STAGE_PILOT, 0.30f);
    const std::vector<RayPlan> plan = plan_rays();
    progress_.begin_stage(AJAR_STAGE_GATHER, 0.93f);
    final_gather(plan);
    calibrate_error(plan);
    return std::move(result_);
}

} // namespace ajar
