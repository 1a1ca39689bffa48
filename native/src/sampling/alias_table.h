// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace ajar {

/// Picks one of many by fixed weights in constant time (Vose 1991).
class AliasTable {
public:
    AliasTable() = default;
    /// weights: finite, not negative, in any scale. Nothing can be picked if all are 0.
    explicit AliasTable(const std::vector<float>& weights) {
        double sum = 0.0;
        for (const float w : weights) sum += w;
        if (!(sum > 0.0)) return;
        const auto n = static_cast<uint32_t>(weights.size());
        std::vector<double> level(n); // share times n: what a bucket of height 1 holds of it
        std::vector<uint32_t> low, high;
        for (uint32_t i = 0; i < n; ++i) {
            level[i] = weights[i] * (n / sum);
            buckets_.push_back({1.0f, i, static_cast<float>(weights[i] / sum)});
            (level[i] < 1.0 ? low : high).push_back(i);
        }
        while (!low.empty() && !high.empty()) {
            const uint32_t l = low.back(), h = high.back();
            low.pop_back();
            buckets_[l].own = static_cast<float>(level[l]), buckets_[l].other = h;
            level[h] -= 1.0 - level[l];
            if (level[h] < 1.0) high.pop_back(), low.push_back(h);
        }
    }

    bool empty() const { return buckets_.empty(); }
    /// Index for u in [0,1).
    uint32_t pick(float u) const {
        const float x = u * static_cast<float>(buckets_.size());
        const auto i = std::min(static_cast<uint32_t>(x), static_cast<uint32_t>(buckets_.size()) - 1u);
        return x - static_cast<float>(i) < buckets_[i].own ? i : buckets_[i].other;
    }
    /// Chance of an index to be picked.
    float chance(uint32_t i) const { return buckets_[i].chance; }

private:
    struct Bucket {
        float own; ///< share of the bucket that is its own index's
        uint32_t other;
        float chance;
    };
    std::vector<Bucket> buckets_;
};

} // namespace ajar
