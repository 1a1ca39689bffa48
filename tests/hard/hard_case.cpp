// SPDX-License-Identifier: GPL-3.0-or-later
#include "hard_case.h"

#include <algorithm>

namespace hard {

double largest(const Layer& e) {
    double most = 0.0;
    for (const float v : e.data) most = std::isfinite(v) && v >= 0.0f ? std::max<double>(most, v) : HUGE_VAL;
    return most;
}

double off(double got, double expected) {
    const double off = std::abs(got / expected - 1.0);
    return std::isfinite(off) ? off : HUGE_VAL;
}

double worst(const Layer& e, const std::function<double(uint32_t, uint32_t)>& expected) {
    double most = 0.0;
    for (uint32_t y = 0; y < e.height; ++y)
        for (uint32_t x = 0; x < e.width; ++x) most = std::max(most, off(e.at(x, y), expected(x, y)));
    return most;
}

double worst(const Layer& e, double expected) {
    return worst(e, [=](uint32_t, uint32_t) { return expected; });
}

double mean(const Layer& e) {
    double sum = 0.0;
    for (const float v : e.data) sum += v;
    return sum / static_cast<double>(e.data.size());
}

double valid_mean(const Layer& e, const Layer& valid, uint32_t channel) {
    double sum = 0.0, count = 0.0;
    for (uint32_t y = 0; y < e.height; ++y)
        for (uint32_t x = 0; x < e.width; ++x)
            if (valid.at(x, y) == 1.0f) sum += e.at(x, y, channel), count += 1.0;
    return sum / count;
}

Float3 texel(uint32_t x, uint32_t y, uint32_t size, float edge) {
    return {(float(x) + 0.5f) / float(size) * edge - 0.5f * edge, (float(y) + 0.5f) / float(size) * edge - 0.5f * edge,
            0.0f};
}

kit::MeshData around(size_t i) {
    const float h = 1.0f + 0.005f * static_cast<float>(i);
    return kit::box({-h, -h, -h}, {h, h, h}, true);
}

double from_point(const Float3& lamp, double watts, const Float3& p) {
    const double dx = lamp[0] - p[0], dy = lamp[1] - p[1], dz = lamp[2], r2 = dx * dx + dy * dy + dz * dz;
    return watts / (4.0 * pi) * dz / (r2 * std::sqrt(r2));
}

double from_rectangle(double x0, double x1, double y0, double y1, double h, const Float3& p) {
    const auto corner = [h, &p](double x, double y) {
        const double a = (x - p[0]) / h, b = (y - p[1]) / h, ra = std::sqrt(1.0 + a * a), rb = std::sqrt(1.0 + b * b);
        return (a / ra * std::atan(b / ra) + b / rb * std::atan(a / rb)) / 2.0;
    };
    return corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0);
}

} // namespace hard
