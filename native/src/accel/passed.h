// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <vector>

#include "accel/ray.h"
#include "base/hash.h"

namespace ajar {

/// A place where a ray met a triangle.
struct Crossing {
    uint32_t triangle;
    float u, v;

    bool on_border() const { return std::min({u, v, 1.0f - u - v}) <= kBorder; }
    /// Whether two of them are one: the ray met the common edge of two triangles, and with it both. Rounding decides
    /// whether it does, but texels and diagonals of quads lie on the same lines.
    bool is_same(const Crossing& other, const Snapshot& scene) const {
        if (triangle == other.triangle) return true;
        if (!on_border() || !other.on_border()) return false;
        int common = 0;
        for (const uint32_t a : scene.triangles[triangle].vertex)
            for (const uint32_t b : scene.triangles[other.triangle].vertex)
                common += scene.positions[a] == scene.positions[b];
        return common >= 2;
    }

private:
    static constexpr float kBorder = 1e-5f; ///< of the height over an edge; the tracer is right to some 1e-7
};

/// Surfaces that a ray went through, so that it goes on behind them. Where to go on from cannot be told by distance
/// alone: of two surfaces in one plane, or closer to each other than floats resolve, either may come first, and a
/// start behind the first one is behind both. So the ray goes on from a little before what it met and leaves out, by
/// name, what it has met there.
class Passed {
public:
    bool empty() const { return near_.empty(); }
    /// Where to look for the next surface from.
    float start() const { return start_; }
    bool has(const Crossing& place, const Snapshot& scene) const {
        return std::any_of(near_.begin(), near_.end(), [&](const Met& m) { return place.is_same(m.place, scene); });
    }
    /// margin: how far from each other, along the ray, surfaces may come in the wrong order.
    void add(const Hit& hit, float margin) {
        start_ = std::max(start_, hit.t - margin);
        std::erase_if(near_, [&](const Met& m) { return m.t < start_ - margin; });
        near_.push_back({{hit.triangle, hit.u, hit.v}, hit.t});
    }

private:
    struct Met {
        Crossing place;
        float t;
    };
    float start_ = 0.0f;
    std::vector<Met> near_; ///< those that lie behind start, or by rounding might
};

/// Light that goes through any number of layers. After many of them, or where little is left, it goes on by chance
/// and is then worth more (Russian roulette): the mean is right, and the expected work is bounded. Layers that dim
/// nothing never end it.
class LayerChance {
public:
    static constexpr uint32_t kSure = 16;   ///< layers that dim before chance decides
    static constexpr float kLittle = 1e-4f; ///< of the light: what is left seldom goes on

    /// Dims color by a layer. u: in [0,1), of this layer and ray alone. False if no light goes on.
    bool pass(Vec3& color, const Vec3& transmittance, float u) {
        const float before = max_component(color);
        color *= transmittance;
        const float after = max_component(color);
        if (!(after > 0.0f)) return false;
        if (after >= before) return true;
        float survives = ++dimmed_ > kSure ? after / before : 1.0f;
        if (const float left = after / survives; left < kLittle) survives *= left / kLittle;
        color /= survives;
        return u < survives;
    }

private:
    uint32_t dimmed_ = 0; ///< layers that took some light
};

} // namespace ajar
