// SPDX-License-Identifier: GPL-3.0-or-later
// Choice of an emitter for points about which nothing is known in advance.
#include "base/owen_sobol.h"
#include "sampling/emitters.h"

namespace ajar {

namespace {

constexpr uint32_t kTries = 4;

} // namespace

void EmitterSet::weigh_for_anywhere() {
    std::vector<float> weights;
    for (const Emitter& e : emitters_) {
        // A sun or sky lights everything, a lamp its surroundings: strength alone ranks them badly,
        // its square root keeps all of them in play until importance decides.
        const float strength = e.kind == Kind::lamp ? luminance(scene_.lights[e.index].intensity) *
                                                          std::max(scene_.lights[e.index].area, 1.0f)
                               : e.kind == Kind::sky ? sky_->total()
                                                     : clusters_[e.index].power;
        weights.push_back(std::sqrt(strength));
    }
    anywhere_ = AliasTable(weights);
}

// Resampled importance sampling (Talbot et al. 2005): few candidates by a global weight, one of
// them by its importance here. Constant cost, unlike a loop over all emitters.
uint32_t EmitterSet::pick_anywhere(const Vec3& p, const Vec3& n, uint32_t seed, float& chance) const {
    if (anywhere_.empty()) return kNone;
    uint32_t chosen = kNone;
    float total = 0.0f, target = 0.0f;
    for (uint32_t i = 0; i < kTries; ++i) {
        const uint32_t e = anywhere_.pick(owen_sobol(i, seed).x);
        const float here = importance(e, p, n), weight = here / anywhere_.chance(e);
        total += weight;
        // Strata must not tie one decision to the next, or some candidates win too often.
        if (weight > 0.0f && unit_float(hash_combine(seed, i)) * total < weight) chosen = e, target = here;
    }
    chance = chosen != kNone ? target * static_cast<float>(kTries) / total : 0.0f;
    return chosen;
}

} // namespace ajar
