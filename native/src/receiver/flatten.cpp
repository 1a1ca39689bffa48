// SPDX-License-Identifier: GPL-3.0-or-later
#include "receiver/flatten.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ajar {
namespace {

constexpr double kAlignedReward = 0.05; ///< area given up for a fully axis-aligned outline

double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

double rectangle_area(const std::vector<glm::dvec2>& hull, const glm::dvec2& axis) {
    const glm::dvec2 across(-axis.y, axis.x);
    glm::dvec2 low(std::numeric_limits<double>::max()), high(-low);
    for (const glm::dvec2& p : hull) {
        const glm::dvec2 q(glm::dot(p, axis), glm::dot(p, across));
        low = glm::min(low, q);
        high = glm::max(high, q);
    }
    return (high.x - low.x) * (high.y - low.y);
}

/// Share of the hull's length that runs along or across axis, within half a degree.
double aligned_share(const std::vector<glm::dvec2>& hull, const glm::dvec2& axis) {
    double aligned = 0.0, total = 0.0;
    for (size_t i = 0; i < hull.size(); ++i) {
        const glm::dvec2 d = hull[(i + 1) % hull.size()] - hull[i];
        const double length = glm::length(d), along = std::abs(glm::dot(d, axis));
        total += length;
        if (along > 0.99996 * length || along < 0.0087 * length) aligned += length;
    }
    return total > 0.0 ? aligned / total : 0.0;
}

} // namespace

std::vector<glm::dvec2> convex_hull(std::vector<glm::dvec2> points) {
    const auto less = [](const glm::dvec2& a, const glm::dvec2& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; };
    std::sort(points.begin(), points.end(), less);
    points.erase(std::unique(points.begin(), points.end()), points.end());
    if (points.size() < 3) return points;
    std::vector<glm::dvec2> hull;
    for (int side = 0; side < 2; ++side) { // Andrew's monotone chain: lower, then upper
        const size_t base = hull.size();
        for (const glm::dvec2& p : points) {
            while (hull.size() >= base + 2 && turn(hull[hull.size() - 2], hull.back(), p) <= 0.0) hull.pop_back();
            hull.push_back(p);
        }
        hull.pop_back();
        std::reverse(points.begin(), points.end());
    }
    return hull;
}

glm::dvec2 best_rectangle_axis(const std::vector<glm::dvec2>& points) {
    const std::vector<glm::dvec2> hull = convex_hull(points);
    glm::dvec2 best(1.0, 0.0);
    double best_score = std::numeric_limits<double>::max();
    for (size_t i = 0; i < hull.size() && hull.size() > 1; ++i) {
        glm::dvec2 axis = hull[(i + 1) % hull.size()] - hull[i];
        const double length = glm::length(axis);
        if (length <= 1e-9) continue;
        axis /= length;
        if (std::abs(axis.x) < std::abs(axis.y)) axis = {axis.y, -axis.x}; // same rectangle, least rotation
        if (axis.x < 0.0) axis = -axis;
        const double score = rectangle_area(hull, axis) * (1.0 - kAlignedReward * aligned_share(hull, axis));
        if (score < best_score * (1.0 - 1e-9)) {
            best_score = score;
            best = axis;
        }
    }
    return best;
}

} // namespace ajar
