// SPDX-License-Identifier: GPL-3.0-or-later
#include "package/overlap_picture.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace ajar {
namespace {

const Vec3 kScale[] = {{0.0f, 0.0f, 0.35f}, {0.1f, 0.3f, 1.0f}, {0.0f, 0.85f, 0.95f}, {0.1f, 0.8f, 0.1f},
                       {1.0f, 0.9f, 0.1f},  {0.9f, 0.1f, 0.1f}, {1.0f, 1.0f, 1.0f}};

uint32_t color_of(uint32_t value, uint32_t unit) {
    if (value == 0) return 0xff000000u;
    const float at = std::clamp(0.5f * std::log2(static_cast<float>(value) / static_cast<float>(unit)), 0.0f, 5.999f);
    const auto step = static_cast<size_t>(at);
    const Vec3 c = glm::mix(kScale[step], kScale[step + 1], at - static_cast<float>(step));
    const auto byte = [](float v) { return static_cast<uint32_t>(v * 255.0f + 0.5f); };
    return byte(c.x) | (byte(c.y) << 8) | (byte(c.z) << 16) | 0xff000000u;
}

} // namespace

std::vector<uint32_t> overlap_picture(std::span<const uint32_t> values, uint32_t unit) {
    std::vector<uint32_t> colors;
    for (const uint32_t value : values) colors.push_back(color_of(value, unit));
    return colors;
}

} // namespace ajar
