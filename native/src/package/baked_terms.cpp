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
std::vector<std::vector<Place>> places_of_terms(const LightmapReceivers& receivers, const TermResult& terms,
                                                const std::vector<uint8_t>& usable) {
    std::vector<std::vector<Place>> places(terms.terms.size());
    for (uint32_t r = 0; r + 1 < terms.first.size(); ++r) {
        if (usable[receivers.texel[r]] == 0) continue;
        for (uint64_t i = terms.first[r]; i < terms.first[r + 1]; ++i)
            places[terms.light[i].term].push_back({receivers.texel[r], i});
    }
    for (auto& p : places)
        std::sort(p.begin(), p.end(), [](const Place& a, const Place& b) { return a.texel < b.texel; });
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

struct TermMaker {
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
        if (solver != nullptr) solver->solve(out.texel, out.irradiance, out.is_signed);
        return out;
    }
};

} // namespace

std::vector<BakedTerm> make_terms(const LightmapReceivers& receivers, const TermResult& terms,
                                  const std::vector<uint8_t>& usable, const SeamSolver* solver, ThreadPool& pool,
                                  Progress& progress) {
    const auto places = places_of_terms(receivers, terms, usable);
    const TermMaker maker{terms, solver};
    std::vector<BakedTerm> out(terms.terms.size());
    pool.for_each(out.size(), progress, [&](size_t i) { out[i] = maker.make(static_cast<uint32_t>(i), places[i]); });
    std::erase_if(out, [](const BakedTerm& t) { return t.texel.empty(); });
    return out;
}

} // namespace ajar
