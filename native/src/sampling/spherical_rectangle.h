// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/math.h"

namespace ajar {

/// A rectangle as seen from a point: its solid angle, and directions spread evenly over it (Ureña et
/// al. 2013, "An Area-Preserving Parametrization for Spherical Rectangles"). In double: small and far
/// rectangles cancel too many digits otherwise.
class SphericalRectangle {
public:
    /// One that is not seen.
    SphericalRectangle() = default;
    /// corner relative to the point; edges at right angles, of some length; all in metres.
    SphericalRectangle(const DVec3& corner, const DVec3& edge_x, const DVec3& edge_y);

    /// Steradians; 0 for a point in the rectangle's plane.
    double solid_angle() const { return solid_angle_; }
    /// Point of the rectangle, relative to the origin, for u in [0,1)^2; its direction has the constant
    /// density 1 / solid_angle.
    DVec3 sample(const Vec2& u) const;

private:
    DVec3 x_{0.0}, y_{0.0}, z_{0.0}; ///< unit axes
    double z0_ = 0.0, x0_ = 0.0, y0_ = 0.0, x1_ = 0.0, y1_ = 0.0;
    double b0_ = 0.0, b1_ = 0.0, k_ = 0.0, solid_angle_ = 0.0;
};

} // namespace ajar
