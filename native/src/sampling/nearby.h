// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "base/math.h"
#include "sampling/alias_table.h"

namespace ajar {

/// Chances of emitters by what they would bring to each cell of a grid over the scene if nothing stood between.
class NearbyEmitters {
public:
    NearbyEmitters() = default;
    /// low, high: bounds of the scene. light(e, p): what emitter e brings to p.
    NearbyEmitters(const Vec3& low, const Vec3& high, uint32_t emitters,
                   const std::function<float(uint32_t, const Vec3&)>& light);

    /// Of the cell that holds p; null where none counts.
    const AliasTable* at(const Vec3& p) const;

private:
    Vec3 low_{0.0f}, per_cell_{0.0f}; ///< cells per metre
    uint32_t count_[3] = {0, 0, 0};
    std::vector<AliasTable> cells_;
};

} // namespace ajar
