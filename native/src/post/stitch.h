// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>

#include "receiver/seams.h"

namespace ajar {

/// Solves the seams of one lightmap for several lights, such as the terms of a bake.
class SeamSolver {
public:
    /// usable covers all page texels; seam points that touch an unusable texel are skipped.
    SeamSolver(const std::vector<SeamPoint>& seams, const std::vector<uint8_t>& usable);
    ~SeamSolver();
    /// Seam points in use.
    uint64_t points() const;
    /// Moves value (all page texels) as stitch_seams does, not below zero.
    void solve(std::vector<Vec3>& value) const;
    /// The same for values at some texels; all others are 0 and stay so.
    void solve(std::span<const uint32_t> texel, std::span<Vec3> value, bool may_be_negative) const;

private:
    struct System;
    std::unique_ptr<System> system_;
};

/// Moves texels as little as possible so that both sides of each seam show the same value:
/// minimises sum (a.x - b.x)^2 + lambda sum (x - x0)^2 by conjugate gradients, per channel.
/// value and usable cover all page texels; seam points that touch an unusable texel are skipped.
/// Returns the number of seam points used.
uint64_t stitch_seams(const std::vector<SeamPoint>& seams, const std::vector<uint8_t>& usable,
                      std::vector<Vec3>& value);

} // namespace ajar
