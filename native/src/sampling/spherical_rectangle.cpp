// SPDX-License-Identifier: GPL-3.0-or-later
#include "sampling/spherical_rectangle.h"

namespace ajar {

namespace {

/// Angle between the planes of two neighbouring edges, inside the rectangle.
double inner_angle(const DVec3& a, const DVec3& b) { return std::acos(std::clamp(-glm::dot(a, b), -1.0, 1.0)); }

/// Solid angle of the part of a plane at distance d between the axes and (x, y).
double quadrant(double x, double y, double d) { return std::atan2(x * y, d * std::sqrt(x * x + y * y + d * d)); }

} // namespace

SphericalRectangle::SphericalRectangle(const DVec3& corner, const DVec3& edge_x, const DVec3& edge_y) {
    const double width = glm::length(edge_x), height = glm::length(edge_y);
    if (!(width > 0.0) || !(height > 0.0)) return;
    x_ = edge_x / width, y_ = edge_y / height, z_ = glm::cross(x_, y_);
    z0_ = glm::dot(corner, z_);
    if (z0_ > 0.0) z_ = -z_, z0_ = -z0_;
    x0_ = glm::dot(corner, x_), y0_ = glm::dot(corner, y_);
    x1_ = x0_ + width, y1_ = y0_ + height;
    if (!(-z0_ > 1e-9 * (width + height))) return;
    const DVec3 v00(x0_, y0_, z0_), v01(x0_, y1_, z0_), v10(x1_, y0_, z0_), v11(x1_, y1_, z0_);
    const DVec3 n0 = glm::normalize(glm::cross(v00, v10)), n2 = glm::normalize(glm::cross(v11, v01)),
                n3 = glm::normalize(glm::cross(v01, v00));
    b0_ = n0.z, b1_ = n2.z;
    k_ = 2.0 * double(kPi) - inner_angle(n2, n3) - inner_angle(n3, n0);
    // The sum of the angles loses digits for small rectangles; this does not.
    solid_angle_ =
        quadrant(x1_, y1_, -z0_) - quadrant(x0_, y1_, -z0_) - quadrant(x1_, y0_, -z0_) + quadrant(x0_, y0_, -z0_);
}

DVec3 SphericalRectangle::sample(const Vec2& u) const {
    const double angle = double(u.x) * solid_angle_ + k_;
    const double f = (std::cos(angle) * b0_ - b1_) / std::sin(angle);
    const double c = std::clamp(std::copysign(1.0, f) / std::sqrt(f * f + b0_ * b0_), -1.0, 1.0);
    const double x = std::clamp(-(c * z0_) / std::sqrt(std::max(1.0 - c * c, 1e-300)), x0_, x1_);
    const double d2 = x * x + z0_ * z0_, d = std::sqrt(d2);
    const double h0 = y0_ / std::sqrt(d2 + y0_ * y0_), h1 = y1_ / std::sqrt(d2 + y1_ * y1_);
    const double h = h0 + double(u.y) * (h1 - h0), h2 = h * h;
    const double y = h2 < 1.0 - 1e-12 ? std::clamp(h * d / std::sqrt(1.0 - h2), y0_, y1_) : y1_;
    return x * x_ + y * y_ + z0_ * z_;
}

} // namespace ajar
