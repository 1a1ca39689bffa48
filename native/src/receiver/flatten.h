// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace ajar {

/// Convex hull of points, counter-clockwise, without collinear points.
std::vector<glm::dvec2> convex_hull(std::vector<glm::dvec2> points);

/// Unit vector along x of the smallest rectangle around points; near ties go to the direction that
/// more of the outline follows, so that straight walls get straight texels.
glm::dvec2 best_rectangle_axis(const std::vector<glm::dvec2>& points);

} // namespace ajar
