// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "scene/snapshot.h"

namespace ajar {

/// A box that gather rays are aimed at: the way that a door leaves open.
struct AimBox {
    uint32_t element = kNoElement;
    DVec3 center{0.0};
    std::array<DVec3, 3> axis{DVec3(1, 0, 0), DVec3(0, 1, 0), DVec3(0, 0, 1)}; ///< unit, at right angles
    DVec3 half{0.0};                                                           ///< m, along the axes

    /// Solid angles of the faces that p sees, by axis: at most one per axis, which do not overlap.
    /// All 0 from inside.
    std::array<float, 3> faces_from(const Vec3& p) const;
    /// Unit direction from p to one of those faces, in proportion to their solid angles: density 1 over
    /// their sum. u in [0,1)^2.
    Vec3 sample(const Vec3& p, const std::array<float, 3>& faces, Vec2 u) const;
    /// Distance at which a ray from p enters the box, m; infinite if it misses.
    float distance(const Vec3& p, const Vec3& direction) const;
};

/// The box of each door of the scene that has a leaf while it is closed.
std::vector<AimBox> door_boxes(const Snapshot& scene);

} // namespace ajar
