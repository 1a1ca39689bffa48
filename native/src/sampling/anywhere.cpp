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
    // All candidates first: they come from all over memory.
    uint32_t candidate[kTries];
    for (uint32_t i = 0; i < kTries; ++i)
        candidate[i] = anywhere_.pick((static_cast<float>(i) + unit_float(hash_combine(seed, i))) / kTries);
    float here[kTries], running[kTries], total = 0.0f;
    for (uint32_t i = 0; i < kTries; ++i) {
        here[i] = importance(candidate[i], p, n);
        running[i] = total += here[i] / anywhere_.chance(candidate[i]);
    }
    if (!(total > 0.0f)) return kNone;
    const float target = unit_float(hash_combine(seed, kTries)) * total;
    uint32_t i = 0;
    while (i + 1 < kTries && running[i] <= target) ++i;
    chance = here[i] * static_cast<float>(kTries) / total;
    return here[i] > 0.0f ? candidate[i] : kNone;
}

} // namespace ajar
