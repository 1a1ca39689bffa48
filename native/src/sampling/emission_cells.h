// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/parallel.h"
#include "scene/snapshot.h"

namespace ajar {

/// How the emission of each emissive triangle is spread over it: a grid of small triangles, each weighed
/// by what it sends. Where a texture glows in few places, points there are worth aiming at.
class EmissionCells {
public:
    /// Weighs the cells of the triangles that emit; triangles: indices into the scene's.
    EmissionCells(const Snapshot& scene, const std::vector<uint32_t>& triangles, ThreadPool& pool, Progress& progress);

    /// Mean luminance of a triangle's emission, W/(m^2 sr); triangle: one of those given.
    float mean(uint32_t triangle) const { return grids_[slot_[triangle]].mean; }
    /// Barycentric (u, v) of a point by emission; density: of the choice, over that of a uniform one.
    Vec2 sample(uint32_t triangle, Vec2 u, float& density) const;
    /// Asks for the memory that sample(triangle, u) will read.
    [[gnu::always_inline]] void prefetch(uint32_t triangle, const Vec2& u) const {
        const Grid& grid = grids_[slot_[triangle]];
        if (grid.edge > 1) __builtin_prefetch(&part_of(grid, u.x));
    }
    /// Density with which sample() picks a place, over that of a uniform choice; triangle: one of those given.
    float density(uint32_t triangle, float u, float v) const;

private:
    struct Grid {
        uint32_t edge = 1;  ///< cells along an edge; edge^2 cells
        uint32_t first = 0; ///< into running_ and guide_
        float mean = 0.0f;
    };
    /// What a part of [0, 1) reads: a grid has as many equal parts as cells. The running sums before and behind the
    /// cell at its begin and behind the next stand beside each other, since most samples need no more: the tables
    /// of a textured level do not fit into a core's cache.
    struct Part {
        float begin, middle, end;
        uint16_t cell;
    };
    /// Chance of a cell of a grid.
    float chance(const Grid& grid, uint32_t cell) const {
        return running_[grid.first + cell] - (cell > 0 ? running_[grid.first + cell - 1] : 0.0f);
    }

    const Part& part_of(const Grid& grid, float u) const {
        const uint32_t count = grid.edge * grid.edge;
        return guide_[grid.first + std::min(static_cast<uint32_t>(u * static_cast<float>(count)), count - 1)];
    }
    void add_guide(const Grid& grid);

    std::vector<uint32_t> slot_; ///< per triangle of the scene
    std::vector<Grid> grids_;
    std::vector<float> running_; ///< running sums of the chances of the cells of grids with more than one
    std::vector<Part> guide_;
};

} // namespace ajar
