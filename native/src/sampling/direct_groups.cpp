// SPDX-License-Identifier: GPL-3.0-or-later
#include "sampling/direct_groups.h"

#include "base/hash.h"

namespace ajar {

namespace {

constexpr uint32_t kLeastSamples = 4;

/// Samples of a light set: an open view of its lamps needs fewer than half shadow does.
uint32_t samples_of(const LightChoice& choice, uint32_t most) {
    uint32_t count = std::min(most, kLeastSamples);
    while (count < most && static_cast<float>(count) < choice.relative_variance() * static_cast<float>(most))
        count *= 2;
    return std::min(count, most);
}

} // namespace

DirectGroups::DirectGroups(const EmitterSet& emitters, LightRoles roles, const std::vector<uint32_t>& sets)
    : group_of_(emitters.count(), EmitterSet::kNone) {
    const auto add = [&](uint32_t set) {
        std::vector<uint32_t> members = emitters.of_set(set);
        for (const uint32_t e : members) group_of_[e] = static_cast<uint32_t>(groups_.size());
        groups_.emplace_back(set, LightChoice(emitters, roles, std::move(members)));
    };
    add(kNoElement);
    for (const uint32_t set : sets) add(set);
}

uint64_t DirectGroups::begin(const Tracer& tracer, const LightmapReceivers& receivers, const Tile& tile,
                             uint32_t samples, uint32_t unseen_samples, uint32_t seed) {
    uint64_t rays = 0;
    for (Group& g : groups_)
        rays += g.choice.begin(tracer, receivers, tile, g.set == kNoElement ? seed : hash_combine(seed, g.set));
    start_at(0);
    allot(samples, unseen_samples);
    return rays;
}

void DirectGroups::start_at(uint32_t local) {
    for (Group& g : groups_) {
        g.base = local;
        g.choice.start_at(local);
    }
}

void DirectGroups::allot(uint32_t samples, uint32_t unseen_samples) {
    for (Group& g : groups_) {
        // Emitters of no set are many and cheap to ask; only whole sets are worth leaving out.
        g.samples = g.choice.empty()      ? 0
                    : g.set == kNoElement ? samples
                    : g.choice.seen()     ? samples_of(g.choice, samples)
                                          : unseen_samples;
        g.of.fill(g.samples);
    }
}

void DirectGroups::allot_base(uint32_t samples) {
    Group& base = groups_.front();
    if (base.samples == 0) return;
    base.samples = samples;
    base.of.fill(samples);
}

float DirectGroups::expected(uint32_t local, uint32_t emitter) const {
    if (group_of_[emitter] == EmitterSet::kNone) return 0.0f;
    const Group& g = groups_[group_of_[emitter]];
    const uint32_t samples = g.samples_at(local);
    return samples == 0 ? 0.0f : static_cast<float>(samples) * g.choice.chance(local, emitter);
}

void DirectGroups::limit(uint32_t set, uint32_t packet, uint32_t samples) {
    for (Group& g : groups_)
        if (g.set == set) g.of[packet] = std::min(g.of[packet], samples);
}

} // namespace ajar
