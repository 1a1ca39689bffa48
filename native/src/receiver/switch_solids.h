// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "accel/solids.h"

namespace ajar {

/// Where the light of a position comes from while a switchable solid that covers the position is there.
struct MovedPosition {
    Vec3 origin{0.0f};
    Presence presence; ///< of the solid

    /// Whether something covers the position at all.
    bool exists() const { return presence.element != kNoElement; }
};

/// Doors and toggles as solids that stand on lightmapped surfaces. The texels at their foot lie partly inside
/// them: as with fixed solids, such positions are moved before the nearest face, but only while the solid is there.
class SwitchSolids {
public:
    /// behind: of find_solids().
    SwitchSolids(const Snapshot& scene, const Tracer& tracer, const std::vector<Behind>& behind);
    bool empty() const { return boxes_.empty(); }
    /// A ray origin p of a texel with this frame and edge (m). Solids that reach further than a few texels around it
    /// hide it altogether, and it stays.
    MovedPosition move_out(const Vec3& p, const Frame& frame, float texel) const;

private:
    struct Box {
        Vec3 low, high;
    };
    bool is_near(const Vec3& p) const;
    /// Presence of the solid that p is in; element kNoElement: none.
    Presence solid_around(const Vec3& p, const Frame& frame) const;

    const Snapshot& scene_;
    const Tracer& tracer_;
    std::vector<Box> boxes_; ///< of the instances
};

} // namespace ajar
