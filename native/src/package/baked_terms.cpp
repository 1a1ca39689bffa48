// SPDX-License-Identifier: GPL-3.0-or-later
#include "package/baked_terms.h"

#include <algorithm>

namespace ajar {

namespace {

/// A term's light at one texel.
struct Place {
    uint32_t texel;
    uint64_t light; ///< index into TermResult::light
};

/// Where each term is, by texel.
std::vector<std::vector<Place>> places_of_terms(const LightmapReceivers& receivers, const TermResult& terms, const std::vector<uint8_t>& usable) {
    std::vector<std::vector<Place>> places(terms.terms.size());
    for (uint32_t r = 0; r + 1 < terms.first.size(); ++r) {
        if (usable[receivers.texel[r]] == 0) continue;
        for (uint64_t i = terms.first[r]; i < terms.first[r + 1]; ++i) places[terms.light[i].term].push_back({receivers.texel[r], i});
    }
    for (auto& p : places) std::sort(p.begin(), p.end(), [](const Place& a, const Place& b) { return a.texel < b.texel; });
    return places;
}

bool is_negative(const Vec3& v) { return v.x < 0.0f || v.y < 0.0f || v.z < 0.0f; }

/// Ratio and direction of light that may be negative: those of its opposite.
uint32_t fit_direction(const TermLight& light) {
    const float sign = luminance(light.irradiance) < 0.0f ? -1.0f : 1.0f;
    float sh[kShCount];
    for (int c = 0; c < kShCount; ++c) sh[c] = sign * light.sh[c];
    return pack_direction(fit_ahd(sign * light.irradiance, sh));
}

/// Texels that copy another one, by the texel they copy.
std::vector<std::pair<uint32_t, uint32_t>> copies_of(const std::vector<uint32_t>& source) {
    std::vector<std::pair<uint32_t, uint32_t>> copies;
    for (uint32_t t = 0; t < source.size(); ++t)
        if (source[t] != t) copies.emplace_back(source[t], t);
    std::sort(copies.begin(), copies.end());
    return copies;
}

void add_copies(const std::vector<std::pair<uint32_t, uint32_t>>& copies, BakedTerm& term) {
    struct Texel {
        uint32_t texel, from;
    };
    std::vector<Texel> all;
    for (uint32_t i = 0; i < term.texel.size(); ++i) {
        all.push_back({term.texel[i], i});
        for (auto c = std::lower_bound(copies.begin(), copies.end(), std::pair{term.texel[i], 0u}); c != copies.end() && c->first == term.texel[i]; ++c) all.push_back({c->second, i});
    }
    std::sort(all.begin(), all.end(), [](const Texel& a, const Texel& b) { return a.texel < b.texel; });
    const BakedTerm before = std::move(term);
    term = {before.elements, before.is_signed, before.relative_error, before.discarded, {}, {}, {}};
    for (const Texel& t : all) {
        term.texel.push_back(t.texel);
        term.irradiance.push_back(before.irradiance[t.from]);
        term.packed_direction.push_back(before.packed_direction[t.from]);
    }
}

struct TermMaker {
    const Snapshot& scene;
    const TermResult& terms;
    const SeamSolver* solver;

    BakedTerm make(uint32_t index, const std::vector<Place>& places) const {
        BakedTerm out;
        const Term& term = terms.terms[index];
        if (term.set() != kNoElement) out.elements.push_back(term.set());
        for (uint32_t i = 0; i < term.switch_count(); ++i) out.elements.push_back(term.element(i));
        std::sort(out.elements.begin(), out.elements.end());
        out.discarded = terms.discarded[index];
        double squares = 0.0, sum = 0.0;
        for (const Place& p : places) {
            const TermLight& l = terms.light[p.light];
            out.texel.push_back(p.texel);
            out.irradiance.push_back(l.irradiance);
            out.packed_direction.push_back(fit_direction(l));
            out.is_signed |= is_negative(l.irradiance);
            squares += double(l.standard_error) * l.standard_error;
            sum += std::abs(luminance(l.irradiance));
        }
        const double n = std::max<double>(1.0, static_cast<double>(places.size()));
        out.relative_error = sum > 0.0 ? static_cast<float>(std::sqrt(squares / n) / (sum / n)) : 0.0f;
        if (solver != nullptr && solver->points() != 0) stitch(out);
        return out;
    }

    void stitch(BakedTerm& term) const {
        std::vector<Vec3> value(scene.texel_count(), Vec3(0.0f));
        for (size_t i = 0; i < term.texel.size(); ++i) value[term.texel[i]] = term.irradiance[i];
        solver->solve(value, term.is_signed);
        for (size_t i = 0; i < term.texel.size(); ++i) term.irradiance[i] = value[term.texel[i]];
    }
};

} // namespace

std::vector<BakedTerm> make_terms(const Snapshot& scene, const LightmapReceivers& receivers, const TermResult& terms, const std::vector<uint8_t>& usable,
                                  const std::vector<uint32_t>& source, const SeamSolver* solver, ThreadPool& pool, Progress& progress) {
    const auto places = places_of_terms(receivers, terms, usable);
    const auto copies = copies_of(source);
    const TermMaker maker{scene, terms, solver};
    std::vector<BakedTerm> out(terms.terms.size());
    pool.for_each(out.size(), progress, [&](size_t i) {
        out[i] = maker.make(static_cast<uint32_t>(i), places[i]);
        add_copies(copies, out[i]);
    });
    std::erase_if(out, [](const BakedTerm& t) { return t.texel.empty(); });
    return out;
}

} // namespace ajar
