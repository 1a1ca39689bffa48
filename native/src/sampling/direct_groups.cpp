// SPDX-License-Identifier: GPL-3.0-or-later
#include "sampling/direct_groups.h"

#include "base/hash.h"

namespace ajar {

DirectGroups::DirectGroups(const EmitterSet& emitters, LightRoles roles, const std::vector<uint32_t>& sets)
    : emitters_(emitters), group_of_(emitters.count(), EmitterSet::kNone) {
    const auto add = [&](uint32_t set) {
        std::vector<uint32_t> members = emitters.of_set(set);
        for (const uint32_t e : members) group_of_[e] = static_cast<uint32_t>(groups_.size());
        groups_.push_back({set, LightChoice(emitters, roles, std::move(members)), 0});
    };
    add(kNoElement);
    for (const uint32_t set : sets) add(set);
}

uint64_t DirectGroups::begin(const Tracer& tracer, const LightmapReceivers& receivers, const Tile& tile,
                             uint32_t samples, uint32_t unseen_samples, uint32_t seed) {
    uint64_t rays = 0;
    for (Group& g : groups_) {
        rays += g.choice.begin(tracer, receivers, tile, g.set == kNoElement ? seed : hash_combine(seed, g.set));
        // Emitters of no set are many and cheap to ask; only whole sets are worth leaving out.
        g.samples = g.choice.empty() ? 0 : g.set == kNoElement || g.choice.seen() ? samples : unseen_samples;
    }
    return rays;
}

float DirectGroups::expected(uint32_t local, uint32_t emitter) const {
    if (group_of_[emitter] == EmitterSet::kNone) return 0.0f;
    const Group& g = groups_[group_of_[emitter]];
    return g.samples == 0 ? 0.0f : static_cast<float>(g.samples) * g.choice.chance(local, emitter);
}

} // namespace ajar
