// SPDX-License-Identifier: GPL-3.0-or-later
#include "sampling/nearby.h"

#include <cmath>

namespace ajar {

namespace {

constexpr uint32_t kMostEntries = 1u << 18; ///< cells times emitters: 3 MB, 0.1 s
constexpr uint32_t kMostCells = 1u << 12;
constexpr uint32_t kLeastEmitters = 5; ///< fewer are all looked at anyway

} // namespace

NearbyEmitters::NearbyEmitters(const Vec3& low, const Vec3& high, uint32_t emitters,
                               const std::function<float(uint32_t, const Vec3&)>& light)
    : low_(low) {
    const Vec3 size = high - low;
    const float longest = max_component(size);
    const uint32_t most = std::min(kMostCells, kMostEntries / std::max(emitters, 1u));
    if (emitters < kLeastEmitters || most < 2 || !(longest > 0.0f) || !is_finite(size)) return;
    // Cubes, as many as allowed: their edge is found by halving steps.
    float edge = longest;
    const auto cells = [&](float e) {
        uint64_t all = 1;
        for (int k = 0; k < 3; ++k) all *= static_cast<uint64_t>(std::floor(size[k] / e)) + 1;
        return all;
    };
    while (cells(edge / 1.1f) <= most) edge /= 1.1f;
    for (int k = 0; k < 3; ++k) {
        count_[k] = static_cast<uint32_t>(std::floor(size[k] / edge)) + 1;
        per_cell_[k] = 1.0f / edge;
    }
    std::vector<float> weights(emitters);
    for (uint32_t z = 0; z < count_[2]; ++z)
        for (uint32_t y = 0; y < count_[1]; ++y)
            for (uint32_t x = 0; x < count_[0]; ++x) {
                const Vec3 corner = low + Vec3(x, y, z) * edge;
                std::fill(weights.begin(), weights.end(), 0.0f);
                for (uint32_t i = 0; i < 8; ++i) { // middles of eighths
                    const Vec3 p = corner + (Vec3(i & 1, i >> 1 & 1, i >> 2) * 0.5f + 0.25f) * edge;
                    for (uint32_t e = 0; e < emitters; ++e) weights[e] += light(e, p);
                }
                cells_.emplace_back(weights);
            }
}

const AliasTable* NearbyEmitters::at(const Vec3& p) const {
    if (cells_.empty()) return nullptr;
    uint32_t index = 0;
    for (int k = 2; k >= 0; --k) {
        const float cell = std::floor((p[k] - low_[k]) * per_cell_[k]);
        index = index * count_[k] + static_cast<uint32_t>(std::clamp(cell, 0.0f, static_cast<float>(count_[k] - 1)));
    }
    return cells_[index].empty() ? nullptr : &cells_[index];
}

} // namespace ajar
