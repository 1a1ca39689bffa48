// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "accel/solids.h"

namespace ajar {

/// Where positions of a texel go that lie inside a thing which stands on its surface, where nobody looks.
class PushOut {
public:
    /// behind: of find_solids(); it must outlive this.
    PushOut(const Snapshot& scene, const Tracer& tracer, const std::vector<Behind>& behind)
        : scene_(scene), tracer_(tracer), behind_(behind) {}

    /// Where a position goes: before the nearest back within a texel's diagonal, if it lies in the dark behind it.
    /// Behind a wall without thickness, where light falls, it stays: that is a place like any other. texel: edge, m.
    Vec3 out_of_the_dark(Vec3 p, const Frame& frame, float texel, uint64_t& moves) const;

private:
    bool is_in_solid(const Hit& hit) const;
    bool is_dark(const Vec3& p, const Frame& frame) const;
    bool is_lit_by_lamp(const Vec3& p, const Vec3& n) const;

    const Snapshot& scene_;
    const Tracer& tracer_;
    const std::vector<Behind>& behind_;
};

} // namespace ajar
