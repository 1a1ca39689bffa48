// SPDX-License-Identifier: GPL-3.0-or-later
// The final pass of a bake with elements, and what it stores.
#include <atomic>
#include <numeric>

#include "pass/missed_light.h"
#include "pass/term_estimate.h"
#include "pass/twin_check.h"

namespace ajar {

constexpr uint64_t kLightCopies = 3; ///< of what is stored: per tile, joined, in pages

/// Rows of a part of a tile from the final gather.
struct FinalPart {
    std::vector<Term> terms;
    std::vector<uint32_t> count;
    std::vector<TermLight> light;      ///< term = index into terms
    std::vector<double> kept, dropped; ///< luminance per term
    CutLight cut;
};

/// Light that a receiver does not keep for an element is left out of states away from the start only: what it is
/// there becomes part of the base.
void TermBaker::add_at_start(size_t receiver, const Term& term, const TermLight& light) {
    if (term.switch_count() != 0) return;
    const float weight = s_.scene.elements[term.set()].weight;
    result_.irradiance[receiver] += weight * light.irradiance;
    for (int c = 0; c < kShCount; ++c) result_.sh[receiver * kShCount + static_cast<size_t>(c)] += weight * light.sh[c];
}

void TermBaker::store_tile(const Tile& tile, const Estimate& t, FinalPart& out) {
    const Working here(bookkeeping_);
    out.terms = t.terms;
    out.kept.assign(t.terms.size(), 0.0);
    out.dropped.assign(t.terms.size(), 0.0);
    const float per_ray = 1.0f / static_cast<float>(std::max(t.plan.gather, 1u));
    out.cut.add(t.gather, per_ray);
    out.cut.add(t.direct, 1.0);
    out.cut.count_once(t.gather, per_ray);
    out.cut.count_once(t.direct, 1.0);
    out.cut.most_elements = limits_at(tile).order;
    std::vector<uint8_t> unswitched;
    for (const Term& term : t.terms) unswitched.push_back(term.switch_count() == 0);
    for (uint32_t lane = 0; lane < tile.count; ++lane) {
        const size_t r = tile.first + lane;
        const size_t before = out.light.size();
        result_.samples[r] = static_cast<float>(t.plan.gather);
        result_.inside[r] = t.gather.inside(lane) * per_ray;
        result_.total[r] = luminance(t.total(lane));
        result_.total_error[r] = static_cast<float>(std::sqrt(t.total_variance(lane)));
        for (const uint32_t term : t.terms_at[lane]) {
            TermLight light{term, t.irradiance(term, lane), {}, static_cast<float>(std::sqrt(t.variance(term, lane)))};
            if (unswitched[term] != 0) out.cut.all += std::abs(luminance(light.irradiance));
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
            if (kept)
                out.light.push_back(light);
            else
                add_at_start(r, t.terms[term], light);
        }
        out.count.push_back(static_cast<uint32_t>(out.light.size() - before));
    }
}

void TermBaker::join(std::vector<FinalPart>& parts) {
    const Working here(bookkeeping_);
    TermResult& out = result_.terms;
    for (const FinalPart& t : parts) out.terms.insert(out.terms.end(), t.terms.begin(), t.terms.end());
    std::sort(out.terms.begin(), out.terms.end());
    out.terms.erase(std::unique(out.terms.begin(), out.terms.end()), out.terms.end());
    std::erase_if(out.terms, [](const Term& t) { return t.is_base(); });
    std::vector<double> kept(out.terms.size(), 0.0), dropped(out.terms.size(), 0.0);
    out.first.push_back(0);
    size_t lights = 0;
    for (const FinalPart& t : parts) lights += t.light.size();
    out.light.reserve(lights); // growing would hold them twice more for a moment
    for (FinalPart& t : parts) {
        std::vector<uint32_t> number;
        for (size_t i = 0; i < t.terms.size(); ++i) {
            number.push_back(static_cast<uint32_t>(std::lower_bound(out.terms.begin(), out.terms.end(), t.terms[i]) -
                                                   out.terms.begin()));
            if (t.terms[i].is_base()) continue;
            kept[number[i]] += t.kept[i];
            dropped[number[i]] += t.dropped[i];
        }
        out.cut.add(t.cut);
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
    const auto share = [](double lost, double left) { return lost / std::max(left + lost, 1e-30); };
    for (size_t i = 0; i < kept.size(); ++i) out.discarded.push_back(static_cast<float>(share(dropped[i], kept[i])));
    out.all_discarded = share(std::reduce(dropped.begin(), dropped.end()), std::reduce(kept.begin(), kept.end()));
}

double TermBaker::time_left(double lights) const {
    return seconds_left(settings_, progress_, s_.receivers.tiles.size(), source_end_) -
           seconds_to_store_ * (lights + s_.receivers.count());
}

/// Against the clock: before each round the plan of the rest is cut to what time allows at the pace so far.
void TermBaker::gather_in_rounds(std::vector<TilePlan>& plan, const std::function<size_t(size_t)>& finish_tile) {
    const std::vector<Tile>& tiles = s_.receivers.tiles;
    const Rounds rounds{tiles.size()};
    const std::vector<double> weights = ray_weights(s_.receivers);
    double rays = 0.0, taken = 0.0, receivers = 0.0;
    std::atomic<size_t> stored{0};
    for (size_t round = 0; round < rounds.count(); ++round) {
        const double start = progress_.elapsed();
        const double lights =
            round > 0 ? static_cast<double>(stored) / receivers * s_.receivers.count()
                      : static_cast<double>(source_.entries.size()) / std::max(gathering_, 1u) * s_.receivers.count();
        const double pace = rays > 0.0 ? taken / rays : pilot_pace_;
        if (pace_->fit(round, kPlannedPart * time_left(lights) / pace, plan)) result_.time_limited = true;
        pool_.for_each(
            rounds.size(round), progress_, [&](size_t k) { stored += finish_tile(rounds.tile(round, k)); }, false);
        for (size_t k = 0; k < rounds.size(round); ++k) {
            const size_t i = rounds.tile(round, k);
            rays += mean_rays(plan[i]) * weights[i];
            receivers += tiles[i].count;
        }
        taken += progress_.elapsed() - start;
        progress_.update(static_cast<float>(round + 1) / static_cast<float>(rounds.count()));
    }
}

/// Every part of a tile with its own rays, then the ring.
std::vector<FinalPart> TermBaker::finish_parts(size_t i, const TilePlan& plan) {
    const Tile& tile = s_.receivers.tiles[i];
    const uint32_t seed = hash_combine(settings_.seed, kSaltFinal);
    const TileParts parts = split(s_.receivers, tile);
    DirectGroups groups = look_around(tile, seed);
    std::vector<FinalPart> out;
    const auto finish = [&](const Tile& part, const RayPlan& rays) {
        if (part.count == 0) return;
        share_samples(groups, tile, part, rays.direct);
        store_tile(part, estimate(part, rays, groups, doors_of(i, part), seed), out.emplace_back());
    };
    for (uint32_t k = 0; k < kPilotParts; ++k) finish(tile_part(parts.own, k), plan[k]);
    finish(parts.ring, spares_rays(settings_) ? ring_rays(plan) : plan[0]);
    return out;
}

void TermBaker::final_gather(std::vector<TilePlan>& plan) {
    const uint32_t n = s_.receivers.count();
    result_.irradiance.assign(n, Vec3(0.0f));
    result_.sh.assign(size_t{n} * kShCount, 0.0f);
    for (auto* v : {&result_.standard_error, &result_.total, &result_.total_error}) v->assign(n, 0.0f);
    result_.samples.assign(n, 0.0f);
    result_.inside.assign(n, 0.0f);
    std::vector<std::vector<FinalPart>> tiles(s_.receivers.tiles.size());
    const auto finish_tile = [&](size_t i) {
        tiles[i] = finish_parts(i, plan[i]);
        size_t lights = 0;
        for (const FinalPart& part : tiles[i]) lights += part.light.size();
        budget_.take(kLightCopies * lights * sizeof(TermLight));
        return lights;
    };
    budget_.reset();
    if (settings_.trial != 0) return gather_some(s_.receivers, pool_, progress_, finish_tile, result_.trial);
    if (settings_.time_limit > 0.0f)
        gather_in_rounds(plan, finish_tile);
    else
        pool_.for_each(tiles.size(), progress_, finish_tile);
    std::vector<FinalPart> parts;
    for (auto& tile : tiles) std::move(tile.begin(), tile.end(), std::back_inserter(parts));
    join(parts);
    // A set all of whose light on a tile is cut has no samples there in the final gather.
    CutLight source;
    for (const CutLight& c : source_cut_) source.add(c);
    source.most_elements = result_.terms.cut.most_elements;
    if (source.share() > result_.terms.cut.share()) result_.terms.cut = std::move(source);
}

TermBaker::Estimate TermBaker::answer(size_t i, const TilePlan& plan, uint32_t seed) const {
    const Tile &tile = s_.receivers.tiles[i], part = TwinCheck::part(s_.receivers, i);
    const RayPlan& rays = plan[part_number(i, part)];
    DirectGroups groups = look_around(tile, seed);
    share_samples(groups, tile, part, rays.direct);
    return estimate(part, rays, groups, doors_of(i, part), seed);
}

std::unique_ptr<TermBaker> TermBaker::other_source() {
    if (settings_.bounces == 0) return nullptr;
    auto other = std::make_unique<TermBaker>(s_, other_source_settings(settings_), pool_, progress_);
    other->first_ = this;
    other->set_samples_ = other_source_samples(settings_, set_samples_);
    other->base_samples_ = other_source_samples(settings_, base_samples_);
    other->doors_ = doors_;
    try {
        other->find_source();
    } catch (const Error& e) {
        if (e.code() != AJAR_ERROR_MEMORY) throw;
        return nullptr;
    }
    return other;
}

void TermBaker::calibrate_error(const std::vector<TilePlan>& plan) {
    TwinCheck check(s_.receivers, result_);
    const std::unique_ptr<TermBaker> other = other_source();
    pool_.for_each(
        check.count(), progress_,
        [&](size_t k) {
            const size_t i = k * check.step();
            const Tile part = TwinCheck::part(s_.receivers, i);
            if (part.count == 0) return;
            const uint32_t seed = hash_combine(settings_.seed, kSaltTwin);
            const Estimate second = answer(i, plan[i], seed);
            std::unique_ptr<const Estimate> third;
            if (other != nullptr) third.reset(new Estimate(other->answer(i, plan[i], hash_combine(seed, 1))));
            for (uint32_t lane = 0; lane < part.count; ++lane) {
                const uint32_t r = part.first + lane;
                const double own = double{result_.total_error[r]} * result_.total_error[r];
                const float twin = luminance(second.total(lane));
                check.compare(k, r,
                              {result_.total[r], twin, third ? luminance(third->total(lane)) : twin,
                               0.5 * (own + second.total_variance(lane))});
            }
        },
        false);
    result_.calibration = check.finish(source_rays_ratio(settings_));
    for (auto* v : {&result_.standard_error, &result_.total_error})
        for (float& e : *v) e *= result_.calibration.factor;
    for (TermLight& l : result_.terms.light) l.standard_error *= result_.calibration.factor;
    state_missed_light(s_.receivers, result_);
}

} // namespace ajar
