// SPDX-License-Identifier: GPL-3.0-or-later
#include "pass/term_bake.h"

namespace ajar {

namespace {

constexpr uint32_t kUnseenSamples = 1; ///< per receiver that look for a light set no visibility ray met
constexpr uint32_t kDarkSamples = 2;   ///< per receiver and set, where the source pass found the set dark
constexpr float kEvenLight = 0.8f;     ///< least over most light of neighbours that lie in no shadow's edge
constexpr uint32_t kMostAims = 4;      ///< doors that a tile aims rays at
constexpr uint32_t kAutoOrder = 3, kAllOrder = 4;
constexpr float kPruneShare = 4.0f; ///< of a term's threshold: light that is dimmer is reflected only by chance
constexpr float kPlanShare = 0.1f;  ///< terms below this share of a tile's light do not drive its ray counts

uint32_t order_of(uint32_t combinations) {
    return combinations == AJAR_COMBINATIONS_NONE ? 1 : combinations == AJAR_COMBINATIONS_AUTO ? kAutoOrder : kAllOrder;
}

/// Factor from gather sums to irradiance; a ratio estimator as in the plain bake.
float gather_scale(const TermSums& s, uint32_t lane) {
    return s.cosine_sum(lane) > 0.0f ? kPi / s.cosine_sum(lane) : 0.0f;
}

} // namespace

/// One tile's answer before it is stored.
struct TermBaker::Estimate {
    TermSums gather, direct;
    RayPlan plan;
    std::vector<Term> terms;
    std::vector<TermIndex> index;                ///< of gather and direct
    std::vector<std::vector<uint32_t>> terms_at; ///< per lane, those that bring it light, ascending

    explicit Estimate(const TermTable& table) : gather(table), direct(table) {}
    void finish(uint32_t lanes) {
        terms = union_of_terms({&gather, &direct});
        index = {TermIndex(gather, terms), TermIndex(direct, terms)};
        terms_at.resize(lanes);
        for (uint32_t lane = 0; lane < lanes; ++lane) {
            for (const TermIndex& i : index) i.collect(lane, terms_at[lane]);
            sort_unique(terms_at[lane]);
        }
    }
    const TermSums::Block* gathered(size_t term, uint32_t lane) const { return index[0].block(term, lane); }
    const TermSums::Block* sampled(size_t term, uint32_t lane) const { return index[1].block(term, lane); }
    Vec3 irradiance(size_t term, uint32_t lane) const {
        Vec3 e(0.0f);
        if (const auto* b = gathered(term, lane)) e += b->color() * gather_scale(gather, lane);
        if (const auto* b = sampled(term, lane)) e += b->color();
        return e;
    }
    double gather_variance(double squares) const {
        const double n = std::max(plan.gather, 1u);
        return std::max(squares, 0.0) / (n * n);
    }
    double variance(size_t term, uint32_t lane) const {
        const auto *g = gathered(term, lane), *d = sampled(term, lane);
        return (g != nullptr ? gather_variance(g->squares) : 0.0) + (d != nullptr ? std::max(d->squares, 0.0) : 0.0);
    }
    Vec3 total(uint32_t lane) const {
        Vec3 e(0.0f);
        for (const uint32_t t : terms_at[lane]) e += irradiance(t, lane);
        return e;
    }
    double total_variance(uint32_t lane) const {
        return gather_variance(gather.total_squares(lane)) + direct.total_squares(lane);
    }
};

TermBaker::TermBaker(const GatherScene& scene, const ajar_settings& settings, ThreadPool& pool, Progress& progress)
    : s_(scene), settings_(settings), pool_(pool), progress_(progress), limits_{order_of(settings.combinations)} {
    for (uint32_t e = 0; e < s_.scene.elements.size(); ++e)
        if (!s_.scene.elements[e].is_switch()) all_sets_.push_back(e);
}

bool TermBaker::gathers() const {
    return settings_.bounces > 0 || s_.scene.sky.lit() || s_.emitters.emissive_triangles() > 0;
}

TileRows TermBaker::tile_rows(const Tile& tile, const TermSums& gather, const TermSums* direct) const {
    TileRows rows;
    rows.terms = direct != nullptr ? union_of_terms({&gather, direct}) : union_of_terms({&gather});
    const TermIndex gathered(gather, rows.terms), sampled(direct != nullptr ? *direct : gather, rows.terms);
    std::vector<uint32_t> terms;
    for (uint32_t lane = 0; lane < tile.count; ++lane) {
        const uint32_t r = tile.first + lane;
        const auto [begin, end] = block_of(s_.scene, s_.receivers, tile, r);
        std::vector<std::pair<uint32_t, float>> mates; // lane and factor
        terms.clear();
        for (uint32_t q = begin; q < end; ++q) {
            if (q != r && !may_share(s_.receivers, q, r)) continue;
            mates.emplace_back(q - tile.first, gather_scale(gather, q - tile.first));
            gathered.collect(q - tile.first, terms);
        }
        if (direct != nullptr) sampled.collect(lane, terms);
        sort_unique(terms);
        const size_t before = rows.entries.size();
        for (const uint32_t t : terms) {
            Vec3 e(0.0f);
            for (const auto& [q, factor] : mates)
                if (const auto* b = gathered.block(t, q)) e += b->color() * (factor / static_cast<float>(mates.size()));
            if (const auto* b = direct != nullptr ? sampled.block(t, lane) : nullptr) e += b->color();
            if (e != Vec3(0.0f)) rows.entries.push_back({t, e});
        }
        rows.count.push_back(static_cast<uint32_t>(rows.entries.size() - before));
    }
    return rows;
}

/// Ends a pass: its rows become the bounce in hand and part of the source of the final gather.
void TermBaker::take(std::vector<TileRows>& tiles) {
    current_ = merge_tiles(tiles, table_);
    double sum = 0.0;
    for (const TermColor& e : current_.entries) sum += luminance(e.color);
    result_.bounce_means.push_back(sum / std::max(1.0, static_cast<double>(s_.receivers.count())));
    source_ = source_.first.size() > 1 ? add_rows(source_, current_) : current_;
    if (direct_.first.size() == 1) direct_ = current_;
    find_thresholds();
    if (settings_.term_threshold > 0.0f)
        current_ = prune(current_, hash_combine(settings_.seed, static_cast<uint32_t>(result_.bounce_means.size())));
}

/// What is too dim to matter alone once reflected, less than a texel would keep, is left out or made
/// that bright by chance: rows get short, and their sum stays what it is in the mean.
ReceiverRows TermBaker::prune(const ReceiverRows& rows, uint32_t seed) const {
    ReceiverRows kept;
    kept.first.reserve(rows.first.size());
    for (uint32_t r = 0; r + 1 < rows.first.size(); ++r) {
        for (const TermColor* e = rows.begin(r); e != rows.end(r); ++e) {
            const float least = kPruneShare * threshold_[e->term], level = max_component(glm::abs(e->color));
            if (table_[e->term].is_base() || level >= least)
                kept.entries.push_back(*e);
            else if (unit_float(hash_combine(hash_combine(seed, s_.receivers.texel[r]), e->term)) * least < level)
                kept.entries.push_back({e->term, e->color * (least / level)});
        }
        kept.first.push_back(kept.entries.size());
    }
    return kept;
}

void TermBaker::direct_source() {
    const bool rays_needed = s_.scene.sky.lit() || s_.emitters.emissive_triangles() > 0;
    std::vector<TileRows> tiles(s_.receivers.tiles.size());
    pool_.for_each(tiles.size(), progress_, [&](size_t i) {
        const Tile& tile = s_.receivers.tiles[i];
        const uint32_t seed = hash_combine(settings_.seed, kSaltSource);
        DirectGroups groups(s_.emitters, LightRoles::all, all_sets_);
        uint64_t rays = groups.begin(s_.tracer, s_.receivers, tile, kSourceSamples, kUnseenSamples,
                                     hash_combine(seed, s_.receivers.texel[tile.first]));
        TermSums direct(table_), gather(table_);
        const uint32_t gather_rays = rays_needed ? std::max(settings_.bounce_samples / 4, 4u) : 0;
        rays += sample_direct(s_, groups, tile, {static_cast<float>(gather_rays), 1.0f}, seed, true, nullptr, table_,
                              limits_, direct);
        if (rays_needed) {
            GatherOptions o;
            o.samples = gather_rays;
            o.emission = true;
            o.direct = &groups;
            o.seed = seed;
            rays += gather_tile(s_, tile, o, nullptr, table_, limits_, gather);
        }
        tiles[i] = tile_rows(tile, gather, &direct);
        progress_.add_rays(rays);
    });
    take(tiles);
}

void TermBaker::bounce(uint32_t index) {
    radiance_ = radiance_rows(current_, s_.receivers, s_.scene.texel_count());
    std::vector<TileRows> tiles(s_.receivers.tiles.size());
    pool_.for_each(tiles.size(), progress_, [&](size_t i) {
        const Tile& tile = s_.receivers.tiles[i];
        TermSums sums(table_);
        GatherOptions o;
        o.samples = std::max(settings_.bounce_samples / 4, 4u);
        o.unmapped_direct = index == 1;
        o.seed = hash_combine(hash_combine(settings_.seed, kSaltBounce), index);
        TileAims aims(s_.receivers, tile);
        const uint64_t rays = aim_at_doors(aims, o.samples, hash_combine(o.seed, s_.receivers.texel[tile.first]));
        o.aims = aims.empty() ? nullptr : &aims;
        progress_.add_rays(rays + gather_tile(s_, tile, o, &radiance_, table_, limits_, sums));
        tiles[i] = tile_rows(tile, sums, nullptr);
    });
    take(tiles);
}

EmitterSet TermBaker::find_bright_texels() {
    std::vector<BrightTexel> bright;
    if (settings_.bounces > 0) {
        std::vector<float> level(s_.receivers.count());
        for (uint32_t r = 0; r < s_.receivers.count(); ++r)
            level[r] = luminance(source_.total(r) * s_.receivers.albedo[r]) * kInvPi;
        for (const uint32_t r : bright_receivers(s_.receivers, level)) {
            bright.push_back(bright_texel(s_.scene, s_.receivers, r));
            bright.back().radiance = source_.total(r) * s_.receivers.albedo[r] * kInvPi;
            radiance_.flags[s_.receivers.texel[r]] |= kTexelBright;
        }
    }
    result_.bright_texels = static_cast<uint32_t>(bright.size());
    return s_.emitters.with_bright_texels(std::move(bright));
}

/// A texel keeps a light set's term if the set lights it directly or is brighter there than a share
/// of its mean indirect light where it lights directly (Seyb et al. 2020, section 3.2). A door, toggle
/// or combination changes the light of its set, or of the base, and is measured against that.
void TermBaker::find_thresholds() {
    std::vector<double> indirect(table_.count(), 0.0), lit(table_.count(), 0.0), all(table_.count(), 0.0),
        met(table_.count(), 0.0);
    for (uint32_t r = 0; r + 1 < source_.first.size(); ++r)
        for (const TermColor* e = source_.begin(r); e != source_.end(r); ++e) {
            const Vec3 direct = direct_.of(r, e->term);
            all[e->term] += std::abs(luminance(e->color));
            met[e->term] += 1.0;
            if (direct == Vec3(0.0f)) continue;
            indirect[e->term] += std::abs(luminance(e->color - direct));
            lit[e->term] += 1.0;
        }
    threshold_.assign(table_.count(), 0.0f);
    for (uint32_t t = 0; t < table_.count(); ++t) {
        const uint32_t changed = table_.find(Term(table_[t].set()));
        if (changed == TermTable::kUnknown) continue;
        const double mean = indirect[changed] > 0.0 ? indirect[changed] / lit[changed]
                            : met[changed] > 0.0    ? all[changed] / met[changed]
                                                    : 0.0;
        threshold_[t] = settings_.term_threshold * static_cast<float>(mean);
    }
}

/// Whether a receiver keeps a term's light. Products of several elements must also stand out of
/// their noise: their light is mostly a small difference.
bool TermBaker::keeps(uint32_t receiver, const Term& term, const TermLight& light) const {
    const uint32_t id = table_.find(term);
    if (id == TermTable::kUnknown) return false;
    const bool is_set = term.order() == 1 && term.set() != kNoElement;
    if (is_set && direct_.of(receiver, id) != Vec3(0.0f)) return true;
    const float level = std::abs(luminance(light.irradiance));
    return level > threshold_[id] &&
           (term.order() < 2 || settings_.combinations == AJAR_COMBINATIONS_ALL || level > light.standard_error);
}

/// Light sets that shine on the tile directly, as the source pass saw it.
std::vector<uint32_t> TermBaker::sets_of(const Tile& tile) const {
    std::vector<uint32_t> sets;
    for (uint32_t r = tile.first; r < tile.first + tile.count; ++r)
        for (const TermColor* e = direct_.begin(r); e != direct_.end(r); ++e)
            if (table_[e->term].set() != kNoElement) sets.push_back(table_[e->term].set());
    std::sort(sets.begin(), sets.end());
    sets.erase(std::unique(sets.begin(), sets.end()), sets.end());
    return sets;
}

/// Where the source pass met no light of a set, or much the same everywhere, few samples of the set do.
void TermBaker::limit_samples(DirectGroups& groups, const Tile& tile) const {
    for (const DirectGroups::Group& g : groups.groups()) {
        const uint32_t id = g.set == kNoElement ? TermTable::kUnknown : table_.find(Term(g.set));
        if (id == TermTable::kUnknown) continue;
        for (uint32_t first = 0; first < tile.count; first += kLanes) {
            float least = std::numeric_limits<float>::infinity(), most = 0.0f;
            for (uint32_t lane = first; lane < std::min(first + kLanes, tile.count); ++lane) {
                const float light = luminance(direct_.of(tile.first + lane, id));
                least = std::min(least, light), most = std::max(most, light);
            }
            if (most == 0.0f)
                groups.limit(g.set, first / kLanes, kDarkSamples);
            else if (least > kEvenLight * most)
                groups.limit(g.set, first / kLanes, std::max(g.samples / 4, kDarkSamples));
        }
    }
}

/// Luminance that comes back along a ray, each term over what a texel keeps of it, and emission and sky over
/// what it keeps of the base. Surfaces without stored light may be bright.
float TermBaker::worth_at(const Ray& ray, const Hit& hit) const {
    const auto worth = [&](uint32_t term, float light) { return light / std::max(threshold_[term], 1e-30f); };
    if (hit.triangle == kMiss) return worth(0, luminance(s_.scene.sky.radiance(ray.direction)));
    const uint8_t flags = s_.surfaces.flags(hit.triangle);
    if ((flags & SurfaceTable::kUnmapped) != 0) return std::numeric_limits<float>::infinity();
    float sum = 0.0f;
    if ((flags & SurfaceTable::kEmits) != 0) sum += worth(0, luminance(s_.scene.emission(hit.triangle, hit.u, hit.v)));
    const uint32_t texel = s_.surfaces.texel(hit.triangle, hit.u, hit.v);
    if (!hit.back)
        for (const TermColor* e = radiance_.begin(texel); e != radiance_.end(texel); ++e)
            sum += worth(e->term, std::abs(luminance(e->color)));
    return sum;
}

/// Rays into the doors through which light of some account comes to the tile.
uint64_t TermBaker::aim_at_doors(TileAims& aims, uint32_t samples, uint32_t seed) const {
    const auto share = static_cast<uint32_t>(std::lround(settings_.door_rays * static_cast<float>(samples)));
    const uint32_t even = (share + 1) & ~1u;
    uint64_t rays = 0;
    for (const AimBox& door : doors_) {
        if (aims.count() == kMostAims) break;
        rays += aims.add(
            s_.tracer, door, [&](const Ray& r, const Hit& h) { return worth_at(r, h); }, even, seed);
    }
    return rays;
}

TermBaker::Estimate TermBaker::estimate(const Tile& tile, const RayPlan& plan, uint32_t seed) const {
    Estimate t(table_);
    t.plan = plan;
    const GatherScene scene = final_scene();
    DirectGroups groups(scene.emitters, LightRoles::stored, sets_of(tile));
    uint64_t rays = groups.begin(s_.tracer, s_.receivers, tile, plan.direct, plan.direct,
                                 hash_combine(seed, s_.receivers.texel[tile.first]));
    limit_samples(groups, tile);
    const TermRows* rows = settings_.bounces > 0 ? &radiance_ : nullptr;
    TileAims aims(s_.receivers, tile);
    if (plan.gather != 0) rays += aim_at_doors(aims, plan.gather, hash_combine(seed, s_.receivers.texel[tile.first]));
    const TileAims* aimed = aims.empty() ? nullptr : &aims;
    rays += sample_direct(scene, groups, tile, {static_cast<float>(plan.gather), kFinalShare, aimed}, seed, false, rows,
                          table_, limits_, t.direct);
    if (plan.gather != 0) {
        GatherOptions o;
        o.samples = plan.gather;
        o.share = kFinalShare;
        o.emission = true;
        o.unmapped_direct = settings_.bounces > 0;
        o.direct = &groups;
        o.aims = aimed;
        o.seed = seed;
        rays += gather_tile(scene, tile, o, rows, table_, limits_, t.gather);
    }
    progress_.add_rays(rays);
    t.finish(tile.count);
    return t;
}

/// What drives a tile's ray counts: all light together, and each term that is a fair part of it.
PilotResult TermBaker::pilot_tile(const Tile& tile, const RayPlan& rays) const {
    const Estimate t = estimate(tile, rays, hash_combine(settings_.seed, kSaltPilot));
    const float share = 1.0f / static_cast<float>(tile.count);
    PilotResult p;
    for (uint32_t lane = 0; lane < tile.count; ++lane) {
        p.level += std::max(0.0f, luminance(t.total(lane))) * share;
        p.gather_variance += static_cast<float>(t.gather_variance(t.gather.total_squares(lane))) * share;
        p.direct_variance += static_cast<float>(t.direct.total_squares(lane)) * share;
    }
    for (size_t term = 0; term < t.terms.size(); ++term) {
        float level = 0.0f;
        double gather = 0.0, direct = 0.0;
        for (uint32_t lane = 0; lane < tile.count; ++lane) {
            level += std::abs(luminance(t.irradiance(term, lane))) * share;
            if (const auto* b = t.gathered(term, lane)) gather += t.gather_variance(b->squares) * share;
            if (const auto* b = t.sampled(term, lane)) direct += std::max(b->squares, 0.0) * share;
        }
        if (level < kPlanShare * p.level || !(level > 0.0f)) continue;
        const double scale = double(p.level / level) * (p.level / level);
        p.gather_variance = std::max(p.gather_variance, static_cast<float>(gather * scale));
        p.direct_variance = std::max(p.direct_variance, static_cast<float>(direct * scale));
    }
    return p;
}

std::vector<RayPlan> TermBaker::plan_rays() {
    const size_t count = s_.receivers.tiles.size();
    std::vector<RayPlan> plan(count, {gathers() ? settings_.samples : 0, settings_.direct_samples});
    const bool timed = settings_.time_limit > 0.0f;
    if (!(settings_.noise_target > 0.0f) && !timed) return plan;
    std::vector<PilotResult> pilot(count * kPilotParts);
    const uint64_t rays_before = progress_.rays();
    const double start = progress_.elapsed();
    const RayPlan small{gathers() ? kPilotRays : 0, std::min(settings_.direct_samples, kPilotRays)};
    pool_.for_each(pilot.size(), progress_, [&](size_t i) {
        pilot[i] = pilot_tile(pilot_part(s_.receivers.tiles[i / kPilotParts], i % kPilotParts), small);
    });
    const double seconds_per_ray =
        (progress_.elapsed() - start) / std::max<double>(1.0, static_cast<double>(progress_.rays() - rays_before));
    if (settings_.noise_target > 0.0f) plan = plan_for_noise(pilot, small, settings_, gathers());
    if (timed)
        result_.time_limited =
            limit_time(plan, s_.receivers.tiles, seconds_per_ray, 0.92 * (settings_.time_limit - progress_.elapsed()));
    return plan;
}

/// Rows of one tile of the final gather.
struct FinalTile {
    std::vector<Term> terms;
    std::vector<uint32_t> count;
    std::vector<TermLight> light;      ///< term = index into terms
    std::vector<double> kept, dropped; ///< luminance per term
};

void TermBaker::store_tile(const Tile& tile, const RayPlan& plan, const Estimate& t, FinalTile& out) {
    out.terms = t.terms;
    out.kept.assign(t.terms.size(), 0.0);
    out.dropped.assign(t.terms.size(), 0.0);
    const float per_ray = 1.0f / static_cast<float>(std::max(plan.gather, 1u));
    for (uint32_t lane = 0; lane < tile.count; ++lane) {
        const size_t r = tile.first + lane;
        const size_t before = out.light.size();
        result_.samples[r] = static_cast<float>(plan.gather);
        result_.inside[r] = t.gather.inside(lane) * per_ray;
        for (const uint32_t term : t.terms_at[lane]) {
            TermLight light{term, t.irradiance(term, lane), {}, static_cast<float>(std::sqrt(t.variance(term, lane)))};
            const auto *g = t.gathered(term, lane), *d = t.sampled(term, lane);
            for (int c = 0; c < kShCount; ++c)
                light.sh[c] = (g != nullptr ? g->sh[c] * per_ray : 0.0f) + (d != nullptr ? d->sh[c] : 0.0f);
            if (t.terms[term].is_base()) {
                result_.irradiance[r] = light.irradiance;
                std::copy(light.sh, light.sh + kShCount, &result_.sh[r * kShCount]);
                result_.standard_error[r] = light.standard_error;
                continue;
            }
            if (light.irradiance == Vec3(0.0f)) continue;
            const bool kept = keeps(static_cast<uint32_t>(r), t.terms[term], light);
            (kept ? out.kept : out.dropped)[term] += std::abs(luminance(light.irradiance));
            if (kept) out.light.push_back(light);
        }
        out.count.push_back(static_cast<uint32_t>(out.light.size() - before));
    }
}

void TermBaker::join(std::vector<FinalTile>& tiles) {
    TermResult& out = result_.terms;
    for (const FinalTile& t : tiles) out.terms.insert(out.terms.end(), t.terms.begin(), t.terms.end());
    std::sort(out.terms.begin(), out.terms.end());
    out.terms.erase(std::unique(out.terms.begin(), out.terms.end()), out.terms.end());
    std::erase_if(out.terms, [](const Term& t) { return t.is_base(); });
    std::vector<double> kept(out.terms.size(), 0.0), dropped(out.terms.size(), 0.0);
    out.first.push_back(0);
    for (FinalTile& t : tiles) {
        std::vector<uint32_t> number;
        for (size_t i = 0; i < t.terms.size(); ++i) {
            number.push_back(static_cast<uint32_t>(std::lower_bound(out.terms.begin(), out.terms.end(), t.terms[i]) -
                                                   out.terms.begin()));
            if (t.terms[i].is_base()) continue;
            kept[number[i]] += t.kept[i];
            dropped[number[i]] += t.dropped[i];
        }
        size_t next = 0;
        for (const uint32_t count : t.count) {
            for (uint32_t k = 0; k < count; ++k, ++next) {
                t.light[next].term = number[t.light[next].term];
                out.light.push_back(t.light[next]);
            }
            out.first.push_back(out.light.size());
        }
        t = {};
    }
    for (size_t i = 0; i < kept.size(); ++i)
        out.discarded.push_back(static_cast<float>(dropped[i] / std::max(kept[i] + dropped[i], 1e-30)));
}

void TermBaker::final_gather(const std::vector<RayPlan>& plan) {
    const uint32_t n = s_.receivers.count();
    result_.irradiance.assign(n, Vec3(0.0f));
    result_.sh.assign(size_t{n} * kShCount, 0.0f);
    result_.standard_error.assign(n, 0.0f);
    result_.samples.assign(n, 0.0f);
    result_.inside.assign(n, 0.0f);
    std::vector<FinalTile> tiles(s_.receivers.tiles.size());
    pool_.for_each(tiles.size(), progress_, [&](size_t i) {
        const Tile& tile = s_.receivers.tiles[i];
        store_tile(tile, plan[i], estimate(tile, plan[i], hash_combine(settings_.seed, kSaltFinal)), tiles[i]);
    });
    join(tiles);
}

/// As in the plain bake: a second answer for a few receivers corrects the strata estimate of all.
void TermBaker::calibrate_error(const std::vector<RayPlan>& plan) {
    const size_t count = s_.receivers.tiles.size() / kCalibrationStep;
    std::vector<Vec2> parts(count, Vec2(0.0f));
    pool_.for_each(
        count, progress_,
        [&](size_t k) {
            const size_t i = k * kCalibrationStep;
            const Tile tile{s_.receivers.tiles[i].first, std::min(kPilotReceivers, s_.receivers.tiles[i].count)};
            const Estimate a = estimate(tile, plan[i], hash_combine(settings_.seed, kSaltTwin)),
                           b = estimate(tile, plan[i], hash_combine(settings_.seed, kSaltTwin + 1));
            for (uint32_t lane = 0; lane < tile.count; ++lane) {
                const float la = luminance(a.total(lane)), lb = luminance(b.total(lane)), level = 0.5f * (la + lb);
                if (!(level > 0.0f)) continue;
                const double se = std::sqrt(a.total_variance(lane)) / level;
                if (se < 1e-5) continue;
                const float d = (la - lb) / level;
                parts[k] += Vec2(0.5f * d * d, static_cast<float>(se * se));
            }
        },
        false);
    double twin = 0.0, strata = 0.0;
    for (const Vec2& p : parts) twin += p.x, strata += p.y;
    if (count < 8 || !(strata > 0.0)) return;
    result_.error_calibration = static_cast<float>(std::clamp(std::sqrt(twin / strata), 0.25, 4.0));
    for (float& e : result_.standard_error) e *= result_.error_calibration;
    for (TermLight& l : result_.terms.light) l.standard_error *= result_.error_calibration;
}

BakeResult TermBaker::run() {
    if (settings_.door_rays > 0.0f) doors_ = door_boxes(s_.scene);
    progress_.begin_stage(AJAR_STAGE_DIRECT, 0.12f);
    direct_source();
    progress_.begin_stage(AJAR_STAGE_BOUNCES, 0.25f);
    for (uint32_t b = 1; b < settings_.bounces; ++b) bounce(b);
    radiance_ = radiance_rows(settings_.term_threshold > 0.0f ? prune(source_, settings_.seed) : source_, s_.receivers,
                              s_.scene.texel_count());
    final_emitters_ = std::make_unique<EmitterSet>(find_bright_texels());
    progress_.begin_stage(AJAR_STAGE_PILOT, 0.30f);
    const std::vector<RayPlan> plan = plan_rays();
    progress_.begin_stage(AJAR_STAGE_GATHER, 0.93f);
    final_gather(plan);
    calibrate_error(plan);
    for (uint32_t r = 0; r < s_.receivers.count(); ++r) result_.source.push_back(source_.total(r));
    return std::move(result_);
}

} // namespace ajar
