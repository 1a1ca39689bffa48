// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/lamp_table.h"

#include <algorithm>
#include <cmath>

namespace ajar {

namespace {

constexpr float kPlain = 0.1f;         ///< share of choices that go to all alike: none is ever missed
constexpr float kLeastSquare = 1e-30f; ///< m^2: p may lie in a lamp without size

} // namespace

void LampTable::add(uint32_t number, const Light& l, float weight) {
    const bool area = l.type == Light::Type::rectangle || l.type == Light::Type::ellipse,
               sun = l.type == Light::Type::sun;
    choices_.push_back({number, weight, 1.0f});
    strength_.push_back(weight * luminance(l.intensity) * (area ? l.area : 1.0f));
    extent_.push_back(sun ? l.radius : l.extent);
    const Vec3 at = sun ? -l.axis : l.position;
    x_.push_back(at.x), y_.push_back(at.y), z_.push_back(at.z);
    is_sun_.push_back(sun ? 1.0f : 0.0f);
}

LampTable::Choice LampTable::choose(const Vec3& p, const Vec3& n, Pcg& random) const {
    thread_local std::vector<float> strength;
    const size_t count = choices_.size();
    strength.resize(count);
    float* out = strength.data();
    const float* s = strength_.data();
    const float* extent = extent_.data();
    const float *x = x_.data(), *y = y_.data(), *z = z_.data(), *sun = is_sun_.data();
    for (size_t i = 0; i < count; ++i) {
        const float near = 1.0f - sun[i]; // suns stand in a direction, other lamps at a place
        const float dx = x[i] - near * p.x, dy = y[i] - near * p.y, dz = z[i] - near * p.z;
        const float size = dx * dx + dy * dy + dz * dz + extent[i] * extent[i];
        const float square = sun[i] + near * std::max(size, kLeastSquare);
        const float facing = dx * n.x + dy * n.y + dz * n.z + extent[i];
        out[i] = s[i] * std::max(0.0f, facing / std::sqrt(square)) / square;
    }
    float total = 0.0f;
    for (size_t i = 0; i < count; ++i) total += out[i];
    size_t k = 0;
    if (total > 0.0f && random.uniform() >= kPlain) {
        for (float left = random.uniform() * total; k + 1 < count && left >= out[k];) left -= out[k++];
    } else {
        k = std::min(static_cast<size_t>(random.uniform() * static_cast<float>(count)), count - 1);
    }
    Choice choice = choices_[k];
    const float alike = 1.0f / static_cast<float>(count);
    choice.chance = total > 0.0f ? (1.0f - kPlain) * out[k] / total + kPlain * alike : alike;
    return choice;
}

} // namespace ajar
