// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace ajar {

/// Hashed uniform grid of points, for welding and for finding points near a segment.
class PointGrid {
public:
    PointGrid(double cell, size_t expected) : cell_(cell) {
        size_t buckets = 16;
        while (buckets < 2 * expected) buckets *= 2;
        head_.assign(buckets, kEnd);
    }

    void insert(const glm::dvec3& point, uint32_t id) {
        const size_t bucket = hash(cell_of(point));
        entries_.push_back({point, id, head_[bucket]});
        head_[bucket] = uint32_t(entries_.size() - 1);
    }

    /// Calls visit(id, point) for every point within radius (at most half a cell) of centre.
    /// Ids may repeat when two of the eight cells share a bucket.
    template <typename Visit>
    void near(const glm::dvec3& centre, double radius, Visit&& visit) const {
        const glm::i64vec3 low = cell_of(centre - radius), high = cell_of(centre + radius);
        for (int64_t z = low.z; z <= high.z; ++z)
            for (int64_t y = low.y; y <= high.y; ++y)
                for (int64_t x = low.x; x <= high.x; ++x)
                    for (uint32_t e = head_[hash({x, y, z})]; e != kEnd; e = entries_[e].next) {
                        const glm::dvec3 d = entries_[e].point - centre;
                        if (glm::dot(d, d) <= radius * radius) visit(entries_[e].id, entries_[e].point);
                    }
    }

private:
    struct Entry {
        glm::dvec3 point;
        uint32_t id, next;
    };
    static constexpr uint32_t kEnd = 0xffffffffu;

    glm::i64vec3 cell_of(const glm::dvec3& p) const {
        const glm::dvec3 c = glm::clamp(glm::floor(p / cell_), -1e15, 1e15);
        return {int64_t(c.x), int64_t(c.y), int64_t(c.z)};
    }
    size_t hash(const glm::i64vec3& c) const {
        uint64_t h = uint64_t(c.x) * 0x9e3779b97f4a7c15ull ^ uint64_t(c.y) * 0xc2b2ae3d27d4eb4full ^
                     uint64_t(c.z) * 0x165667b19e3779f9ull;
        h ^= h >> 32;
        return size_t(h) & (head_.size() - 1);
    }

    double cell_;
    std::vector<uint32_t> head_;
    std::vector<Entry> entries_;
};

} // namespace ajar
