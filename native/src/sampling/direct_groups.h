// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "sampling/light_choice.h"

namespace ajar {

/// The emitter samples of one tile. Emitters of each light set are chosen among themselves, so that
/// a dim set is not lost beside a bright one; so are those of no set.
class DirectGroups {
public:
    struct Group {
        Group(uint32_t light_set, LightChoice members) : set(light_set), choice(std::move(members)) {}

        uint32_t set; ///< light set or kNoElement
        LightChoice choice;
        uint32_t samples = 0; ///< most per receiver
        /// Samples of each receiver of the packet that begins at local.
        uint32_t samples_at(uint32_t local) const { return of[(base + local) / kLanes]; }

    private:
        friend class DirectGroups;
        std::array<uint32_t, kTileReceivers / kLanes> of{};
        uint32_t base = 0;
    };

    /// sets: the light sets to sample, beside the emitters of none.
    DirectGroups(const EmitterSet& emitters, LightRoles roles, const std::vector<uint32_t>& sets);

    /// Prepares for a tile and gives every group that can light it its samples: light sets as many, up
    /// to samples, as the variance of what their visibility rays met asks for; those that no ray saw
    /// get unseen_samples. Returns the rays traced.
    uint64_t begin(const Tracer& tracer, const LightmapReceivers& receivers, const Tile& tile, uint32_t samples,
                   uint32_t unseen_samples, uint32_t seed);

    /// Other counts of samples for the tile as begin() found it.
    void allot(uint32_t samples, uint32_t unseen_samples);
    /// Another count of samples for the emitters of no light set.
    void allot_base(uint32_t samples);
    /// From now on receivers count from this one of the tile on, the first of a packet.
    void start_at(uint32_t local);

    /// Lets the receivers of a packet have fewer samples of a light set.
    void limit(uint32_t set, uint32_t packet, uint32_t samples);

    const std::vector<Group>& groups() const { return groups_; }
    /// Expected number of samples that a receiver spends on an emitter, for MIS.
    float expected(uint32_t local, uint32_t emitter) const;

private:
    std::vector<Group> groups_;
    std::vector<uint32_t> group_of_; ///< per emitter
};

} // namespace ajar
