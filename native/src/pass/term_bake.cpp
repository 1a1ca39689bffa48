// SPDX-License-Identifier: GPL-3.0-or-later
#include "pass/term_bake.h"

#include <optional>

#include "pass/bright_patches.h"
#include "pass/term_estimate.h"

namespace ajar {

namespace {

constexpr uint64_t kRowCopies = 5;     ///< of a pass's rows: per tile, joined, added to the source, parts of that
constexpr uint32_t kUnseenSamples = 1; ///< per receiver that look for a light set no visibility ray met
constexpr uint32_t kAutoOrder = 3, kAllOrder = 4, kMostOrder = kTermSwitches + 1;
/// Of a tile's light: where more is cut because it depends on more elements than a term there may have, terms get more.
constexpr double kCutShare = 0.02;
/// Shares of a term's threshold: light that is dimmer is reflected only by chance, in the bounces, whose noise many
/// rays average later, and in the final gather.
constexpr float kBouncePrune = 16.0f, kFinalPrune = 4.0f;

/// Those shares hold for a preview. Where more rays are asked for they fall as the rays rise, so that rays lower the
/// noise of pruning as they lower their own: rays go as the noise target's inverse square.
float fineness(const ajar_settings& settings) {
    constexpr float kPreviewRays = 256.0f;
    if (settings.noise_target <= 0.0f)
        return std::min(1.0f, kPreviewRays / static_cast<float>(std::max(settings.samples, 1u)));
    const float ratio = std::min(1.0f, settings.noise_target / kPreviewNoise);
    return ratio * ratio;
}

uint32_t order_of(uint32_t combinations) {
    return combinations == AJAR_COMBINATIONS_NONE ? 1 : combinations == AJAR_COMBINATIONS_AUTO ? kAutoOrder : kAllOrder;
}

} // namespace

TermBaker::TermBaker(const GatherScene& scene, const ajar_settings& settings, ThreadPool& pool, Progress& progress,
                     double seconds_to_store)
    : s_(scene),
      settings_(settings),
      pool_(pool),
      progress_(progress),
      seconds_to_store_(seconds_to_store),
      has_primary_(
          std::any_of(scene.scene.lights.begin(), scene.scene.lights.end(), [](const Light& l) { return l.primary; })),
      order_(s_.receivers.tiles.size(), order_of(settings.combinations)),
      source_cut_(s_.receivers.tiles.size()),
      table_(scene.scene.elements),
      bookkeeping_(bookkeeping_effect(scene.scene.elements)),
      rows_(pool, progress, s_.receivers),
      budget_(settings.memory_limit, "light sets, doors and toggles", scene.scene.name) {
    for (uint32_t r = 0; r < s_.receivers.count(); ++r) gathering_ += s_.receivers.coarse_from[r] == r;
    for (uint32_t e = 0; e < s_.scene.elements.size(); ++e)
        if (!s_.scene.elements[e].is_switch()) all_sets_.push_back(e);
}

bool TermBaker::gathers() const {
    return settings_.bounces > 0 || s_.scene.sky.lit() || s_.emitters.emissive_triangles() > 0;
}

/// Number of the tile that a part lies in.
size_t TermBaker::tile_of(const Tile& part) const {
    const std::vector<Tile>& tiles = s_.receivers.tiles;
    const auto after = std::upper_bound(tiles.begin(), tiles.end(), part.first,
                                        [](uint32_t first, const Tile& t) { return first < t.first; });
    return static_cast<size_t>(after - tiles.begin()) - 1;
}

TermLimits TermBaker::limits_at(const Tile& part) const { return {guide().order_[tile_of(part)]}; }

/// Lets terms at a tile have one element more if too much light was cut; whether they may. rays: of gather.
bool TermBaker::raise_order(const Tile& part, const TermSums& gather, uint32_t rays, const TermSums* direct) {
    const uint32_t order = limits_at(part).order;
    CutLight cut;
    const auto add = [&](const TermSums& sums, double scale) {
        cut.add(sums, scale);
        if (direct != nullptr || !sums.cuts().empty()) cut.all += sums.unswitched() * scale;
    };
    add(gather, 1.0 / std::max(rays, 1u));
    if (direct != nullptr) add(*direct, 1.0);
    if (direct != nullptr && first_ == nullptr) {
        CutLight& told = source_cut_[tile_of(part)] = cut;
        told.count_once(gather, 1.0 / std::max(rays, 1u));
        told.count_once(*direct, 1.0);
    }
    if (cut.share() <= kCutShare) return false;
    if (first_ != nullptr || settings_.combinations == AJAR_COMBINATIONS_NONE || order == kMostOrder) return false;
    order_[tile_of(part)] = order + 1;
    return true;
}

TileRows TermBaker::tile_rows(const Tile& tile, const TermSums& gather, const TermSums* direct) {
    const Working here(bookkeeping_);
    TileRows rows;
    rows.terms = direct != nullptr ? union_of_terms({&gather, direct}) : union_of_terms({&gather});
    const TermIndex gathered(gather, rows.terms), sampled(direct != nullptr ? *direct : gather, rows.terms);
    std::vector<uint32_t> terms;
    NumberSet met(rows.terms.size());
    for (uint32_t lane = 0; lane < tile.count; ++lane) {
        const uint32_t r = tile.first + lane;
        std::vector<std::pair<uint32_t, float>> mates; // lane and factor
        terms.clear();
        for (const uint32_t q : block_of(s_.scene, s_.receivers, r)) {
            if (q != r && !may_share(s_.receivers, q, r)) continue;
            mates.emplace_back(q - tile.first, gather_scale(gather, q - tile.first));
            gathered.collect(q - tile.first, met);
        }
        if (direct != nullptr) sampled.collect(lane, met);
        met.take(terms);
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
    budget_.take(kRowCopies * rows.entries.size() * sizeof(TermColor));
    return rows;
}

/// Ends a pass: its rows become the bounce in hand and part of the source of the final gather.
void TermBaker::take(std::vector<TileRows>& tiles) {
    const Working here(bookkeeping_);
    for (size_t i = 0; i < tiles.size(); ++i) tiles[i].count.resize(s_.receivers.tiles[i].count);
    current_ = rows_.merge_tiles(tiles, table_);
    if (first_ != nullptr) current_ = sets_as_one(current_);
    double sum = 0.0;
    for (const TermColor& e : current_.entries) sum += luminance(e.color) * table_.all_on(e.term);
    result_.bounce_means.push_back(sum / std::max(1.0, static_cast<double>(gathering_)));
    result_.growth.add(s_.receivers, [&](uint32_t r) { return luminance(current_.total(table_, r)); });
    source_ = source_.first.size() > 1 ? rows_.add_rows(source_, current_) : current_;
    if (direct_.first.size() == 1) direct_ = current_;
    find_thresholds();
    if (settings_.term_threshold > 0.0f)
        current_ = prune(current_, kBouncePrune * fineness(settings_),
                         hash_combine(settings_.seed, static_cast<uint32_t>(result_.bounce_means.size())));
}

// Doors and toggles stay apart: what a product has no room for, the first leaves out too.
ReceiverRows TermBaker::sets_as_one(const ReceiverRows& rows) {
    const auto combines = [&](uint32_t e) { return s_.scene.elements[e].combines; };
    const auto as_one = [&](const Term& term) {
        if (term.set() == kNoElement) return term;
        return term.of_set(*std::find_if(all_sets_.begin(), all_sets_.end(),
                                         [&](uint32_t e) { return combines(e) == combines(term.set()); }));
    };
    std::vector<Term> terms;
    for (uint32_t t = 0; t < table_.count(); ++t) terms.push_back(as_one(table_[t]));
    table_.add(terms);
    std::vector<uint32_t> number;
    for (const Term& t : terms) number.push_back(table_.find(t));
    return rows_.receiver_rows([&](uint32_t r, std::vector<TermColor>& out) {
        const auto begin = static_cast<uint32_t>(out.size());
        for (const TermColor* e = rows.begin(r); e != rows.end(r); ++e) {
            const auto same = std::find_if(out.begin() + begin, out.end(),
                                           [&](const TermColor& o) { return o.term == number[e->term]; });
            if (same != out.end())
                same->color += e->color;
            else
                out.push_back({number[e->term], e->color});
        }
        std::sort(out.begin() + begin, out.end(),
                  [](const TermColor& a, const TermColor& b) { return a.term < b.term; });
    });
}

/// What is too dim to matter alone once reflected, less than a texel would keep, is left out or made
/// that bright by chance: rows get short, and their sum stays what it is in the mean.
ReceiverRows TermBaker::prune(const ReceiverRows& rows, float share, uint32_t seed) const {
    return rows_.receiver_rows([&](uint32_t r, std::vector<TermColor>& kept) {
        for (const TermColor* e = rows.begin(r); e != rows.end(r); ++e) {
            const float least = share * threshold_[e->term], level = max_component(glm::abs(e->color));
            if (table_[e->term].is_base() || level >= least)
                kept.push_back(*e);
            else if (unit_float(hash_combine(hash_combine(seed, s_.receivers.texel[r]), e->term)) * least < level)
                kept.push_back({e->term, e->color * (least / level)});
        }
    });
}

void TermBaker::direct_source() {
    const bool rays_needed = s_.scene.sky.lit() || s_.emitters.emissive_triangles() > 0;
    std::vector<TileRows> tiles(s_.receivers.tiles.size());
    pool_.for_each(
        tiles.size(), progress_,
        [&](size_t i) {
            const Tile tile = split(s_.receivers, s_.receivers.tiles[i]).coarse;
            if (tile.count == 0) return;
            const uint32_t seed = hash_combine(settings_.seed, kSaltSource);
            DirectGroups groups(s_.emitters, LightRoles::all, first_ != nullptr ? first_->sets_of(tile) : all_sets_);
            uint64_t rays = groups.begin(s_.tracer, s_.receivers, tile, set_samples_, kUnseenSamples,
                                         hash_combine(seed, s_.receivers.texel[tile.first]));
            groups.allot_base(base_samples_);
            const uint32_t gather_rays = rays_needed ? bounce_rays(settings_) : 0;
            for (bool again = true; again;) {
                TermSums direct(table_), gather(table_);
                const TermLimits limits = limits_at(tile);
                rays += sample_direct(s_, groups, tile, {static_cast<float>(gather_rays), 1.0f}, seed, true, nullptr,
                                      limits, direct);
                if (rays_needed)
                    rays += gather_tile(s_, tile, source_options(settings_, groups, seed), nullptr, limits, gather);
                again = raise_order(tile, gather, gather_rays, &direct);
                if (!again) tiles[i] = tile_rows(tile, gather, &direct);
            }
            progress_.add_rays(rays);
        },
        first_ == nullptr);
    take(tiles);
}

void TermBaker::bounce(uint32_t index) {
    radiance_ = rows_.radiance_rows(current_, s_.scene.texel_count());
    const EmitterSet emitters = with_bright_texels(current_, kAimedBounce);
    const GatherScene scene = scene_with(emitters);
    budget_.reset();
    std::vector<TileRows> tiles(s_.receivers.tiles.size());
    aimed_.emplace_back(tiles.size());
    pool_.for_each(
        tiles.size(), progress_,
        [&](size_t i) {
            const Tile tile = split(s_.receivers, s_.receivers.tiles[i]).coarse;
            if (tile.count == 0) return;
            TermSums sums(table_);
            GatherOptions o = bounce_options(settings_, index);
            // The second source repeats what the first chose.
            aimed_[index - 1][i] = first_ != nullptr ? first_->aimed_[index - 1][i] : find_doors(tile, o.seed);
            const TileAims aims = aim_at(aimed_[index - 1][i], tile, o.samples);
            o.aims = aims.empty() ? nullptr : &aims;
            std::optional<TermSums> aimed; // at bright texels
            std::optional<DirectGroups> groups;
            uint64_t rays = 0;
            if (emitters.has_bright_texels()) {
                rays += begin_bounce(scene, tile, o,
                                     groups.emplace(emitters, LightRoles::reflected, std::vector<uint32_t>{}));
                rays += sample_direct(scene, *groups, tile, {static_cast<float>(o.samples), 1.0f, o.aims}, o.seed,
                                      false, &radiance_, limits_at(tile), aimed.emplace(table_));
            }
            rays += gather_tile(scene, tile, o, &radiance_, limits_at(tile), sums);
            progress_.add_rays(rays);
            raise_order(tile, sums, o.samples, nullptr);
            tiles[i] = tile_rows(tile, sums, aimed ? &*aimed : nullptr);
        },
        first_ == nullptr);
    take(tiles);
}

EmitterSet TermBaker::with_bright_texels(const ReceiverRows& light, double least_share) {
    BrightTexels bright;
    if (settings_.bounces > 0) {
        const auto radiance = [&](uint32_t r) { return light.total(table_, r) * s_.receivers.albedo[r] * kInvPi; };
        bright = find_bright_texels(s_.scene, s_.receivers, radiance, least_share);
        for (const uint32_t r : bright.receivers) radiance_.flags[s_.receivers.texel[r]] |= kTexelBright;
    }
    result_.bright_texels = static_cast<uint32_t>(bright.receivers.size());
    return s_.emitters.with_bright_texels(std::move(bright.patches));
}

/// A texel keeps a light set's term if the set lights it directly or is brighter there than a share
/// of its mean indirect light where it lights directly (Seyb et al. 2020, section 3.2). A door, toggle
/// or combination changes the light of its set, or of the base, and is measured against that.
void TermBaker::find_thresholds() {
    std::vector<double> indirect(table_.count(), 0.0), lit(table_.count(), 0.0), all(table_.count(), 0.0),
        met(table_.count(), 0.0);
    for (uint32_t r = 0; r < s_.receivers.count(); ++r) {
        if (s_.receivers.coarse_from[r] != r) continue;
        const TermColor* d = direct_.begin(r);
        for (const TermColor* e = source_.begin(r); e != source_.end(r); ++e) {
            all[e->term] += std::abs(luminance(e->color));
            met[e->term] += 1.0;
            while (d != direct_.end(r) && d->term < e->term) ++d;
            if (d == direct_.end(r) || d->term != e->term || d->color == Vec3(0.0f)) continue;
            indirect[e->term] += std::abs(luminance(e->color - d->color));
            lit[e->term] += 1.0;
        }
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
/// their noise, for their light is mostly a small difference, unless lamps shine or cast a shadow there.
/// Terms that only the final gather met count too: light by way of a surface without a lightmap comes nowhere earlier,
/// and the few rays of the source miss most of 200 doors side by side.
bool TermBaker::keeps(uint32_t receiver, const Term& term, const TermLight& light) const {
    const uint32_t id = table_.find(term), changed = table_.find(Term(term.set()));
    const bool direct = id != TermTable::kUnknown && direct_.of(receiver, id) != Vec3(0.0f);
    if (direct && term.order() == 1 && term.set() != kNoElement) return true;
    const float level = std::abs(luminance(light.irradiance));
    return level > (changed != TermTable::kUnknown ? threshold_[changed] : 0.0f) &&
           (direct || term.order() < 2 || settings_.combinations == AJAR_COMBINATIONS_ALL ||
            level > light.standard_error);
}

void TermBaker::find_source() {
    if (settings_.door_rays > 0.0f && doors_ == nullptr)
        doors_ = std::make_shared<BoxesInSight>(s_.tracer, s_.receivers, door_boxes(s_.scene), settings_.seed);
    if (first_ == nullptr) progress_.begin_stage(AJAR_STAGE_DIRECT, 0.12f);
    direct_source();
    if (first_ == nullptr) progress_.begin_stage(AJAR_STAGE_BOUNCES, 0.25f);
    run_bounces(settings_.bounces, settings_, progress_, result_.trial, [&](uint32_t b) { bounce(b); });
    radiance_ = rows_.radiance_rows(
        settings_.term_threshold > 0.0f ? prune(source_, kFinalPrune * fineness(settings_), settings_.seed) : source_,
        s_.scene.texel_count());
    final_emitters_ = std::make_unique<EmitterSet>(with_bright_texels(source_, 0.0));
    source_end_ = progress_.elapsed();
}

BakeResult TermBaker::run() {
    find_source();
    progress_.begin_stage(AJAR_STAGE_PILOT, 0.30f);
    find_aims();
    std::vector<TilePlan> plan = plan_rays();
    progress_.begin_stage(AJAR_STAGE_GATHER, 0.93f);
    final_gather(plan);
    if (settings_.trial != 0) return std::move(result_);
    calibrate_error(plan);
    result_.source.reserve(s_.receivers.count());
    for (uint32_t r = 0; r < s_.receivers.count(); ++r) result_.source.push_back(source_.total(table_, r));
    return std::move(result_);
}

} // namespace ajar
