// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "sampling/spherical_rectangle.h"
#include "scene/snapshot.h"

namespace ajar {

/// A box that gather rays are aimed at: the way that a door leaves open.
struct AimBox {
    uint32_t element = kNoElement;
    DVec3 center{0.0};
    std::array<DVec3, 3> axis{DVec3(1, 0, 0), DVec3(0, 1, 0), DVec3(0, 0, 1)}; ///< unit, at right angles
    DVec3 half{0.0};                                                           ///< m, along the axes

    /// The box as a point sees it: at most one face per axis, which do not overlap; none from inside.
    struct View {
        std::array<SphericalRectangle, 3> face;
        float solid_angle = 0.0f; ///< sr, of all faces

        /// Unit direction to one of the faces, in proportion to their solid angles: density 1 / solid_angle,
        /// which must not be 0. u in [0,1)^2.
        Vec3 sample(Vec2 u) const;
    };
    View view_from(const Vec3& p) const;
    /// Distance at which a ray from p enters the box, m; infinite if it misses.
    float distance(const Vec3& p, const Vec3& direction) const;
};

/// The box of each door of the scene that has a leaf while it is closed.
std::vector<AimBox> door_boxes(const Snapshot& scene);

} // namespace ajar
