// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pass/term_bake.h"

namespace ajar {

/// Factor from gather sums to irradiance; a ratio estimator as in the plain bake.
inline float gather_scale(const TermSums& s, uint32_t lane) {
    return s.cosine_sum(lane) > 0.0f ? kPi / s.cosine_sum(lane) : 0.0f;
}

/// One tile's answer before it is stored.
struct TermBaker::Estimate {
    TermSums gather, direct;
    const TermTable& table;
    RayPlan plan;
    std::vector<Term> terms;
    std::vector<float> all_on;                   ///< per term: TermTable::all_on
    std::vector<TermIndex> index;                ///< of gather and direct
    std::vector<std::vector<uint32_t>> terms_at; ///< per lane, those that bring it light, ascending

    explicit Estimate(const TermTable& t) : gather(t), direct(t), table(t) {}
    void finish(uint32_t lanes) {
        terms = union_of_terms({&gather, &direct});
        index = {TermIndex(gather, terms), TermIndex(direct, terms)};
        for (const Term& t : terms) all_on.push_back(table.all_on(t));
        terms_at.resize(lanes);
        NumberSet met(terms.size());
        for (uint32_t lane = 0; lane < lanes; ++lane) {
            for (const TermIndex& i : index) i.collect(lane, met);
            met.take(terms_at[lane]);
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
    Vec3 gathered_total(uint32_t lane) const {
        Vec3 e(0.0f);
        for (const uint32_t t : terms_at[lane])
            if (const auto* b = gathered(t, lane)) e += b->color() * all_on[t];
        return e * gather_scale(gather, lane);
    }
    Vec3 sampled_total(uint32_t lane) const {
        Vec3 e(0.0f);
        for (const uint32_t t : terms_at[lane])
            if (const auto* b = sampled(t, lane)) e += b->color() * all_on[t];
        return e;
    }
    /// Of all terms while everything is open, present and lit.
    Vec3 total(uint32_t lane) const { return gathered_total(lane) + sampled_total(lane); }
    double total_variance(uint32_t lane) const {
        return gather_variance(gather.total_squares(lane)) + direct.total_squares(lane);
    }
};

} // namespace ajar
