// SPDX-License-Identifier: GPL-3.0-or-later
#include "sampling/emission_cells.h"

#include "base/owen_sobol.h"
#include "sampling/warp.h"

namespace ajar {

namespace {

constexpr float kTexelsPerCell = 2.0f; ///< along an edge
constexpr uint32_t kMostEdge = 64;     ///< the cells of a grid count in 16 bits
/// Of the scene. A level with 4,000 glowing textured triangles: 4e6 and 1e6 give the same noise squared times time
/// (1e6 in a quarter of the memory, 20 MB), 5e5 gives 1.17 times that.
constexpr double kMostCells = 1e6;
constexpr float kEvenShare = 0.05f; ///< of the samples ignore the weights: they may have missed thin details
constexpr uint32_t kPlainSamples = 16;

/// Cell (x, y) of a triangle cut into edge^2 equal ones: the lower triangle at its corner, or the upper one
/// across from it. Rows are ordered by y and get shorter.
struct Cell {
    uint32_t x, y;
    bool upper;

    uint32_t index(uint32_t edge) const { return y * (2 * edge - y) + 2 * x + (upper ? 1 : 0); }
    /// Barycentrics of a point of the cell whose barycentrics inside it are b.
    Vec2 place(uint32_t edge, const Vec2& b) const {
        const Vec2 corner(x, y);
        return (upper ? corner + 1.0f - b : corner + b) / static_cast<float>(edge);
    }
    static Cell at(uint32_t edge, float u, float v) {
        const Vec2 scaled = glm::clamp(Vec2(u, v), Vec2(0.0f), Vec2(1.0f)) * static_cast<float>(edge);
        Cell c{0, std::min(static_cast<uint32_t>(scaled.y), edge - 1), false};
        c.x = std::min(static_cast<uint32_t>(scaled.x), edge - 1 - c.y);
        c.upper = c.x + c.y + 1 < edge && scaled.x - float(c.x) + scaled.y - float(c.y) > 1.0f;
        return c;
    }
    static Cell of(uint32_t edge, uint32_t index) {
        // From row y on there are (edge - y)^2 cells.
        const auto rows = static_cast<uint32_t>(std::ceil(std::sqrt(static_cast<float>(edge * edge - index))));
        const uint32_t y = edge - rows;
        const uint32_t in_row = index - y * (2 * edge - y);
        return {in_row / 2, y, (in_row & 1) != 0};
    }
};

/// Mean luminance of each cell, in order.
std::vector<float> weigh(const Snapshot& scene, uint32_t triangle, uint32_t edge, uint32_t samples) {
    std::vector<float> mean(edge * edge);
    for (uint32_t i = 0; i < mean.size(); ++i) {
        const Cell cell = Cell::of(edge, i);
        for (uint32_t s = 0; s < samples; ++s) {
            const Vec2 p = cell.place(edge, sample_triangle(owen_sobol(s, hash_combine(triangle, i))));
            mean[i] += luminance(scene.emission(triangle, p.x, p.y)) / static_cast<float>(samples);
        }
    }
    return mean;
}

uint32_t edge_of(const Snapshot& scene, uint32_t triangle, size_t triangles) {
    const float texels = scene.materials[scene.triangles[triangle].material].emission_detail(
        scene, scene.mesh_point(triangle, 0.0f, 0.0f));
    const auto most = static_cast<uint32_t>(std::sqrt(kMostCells / static_cast<double>(triangles)));
    return std::clamp(static_cast<uint32_t>(std::min(texels / kTexelsPerCell, 1e6f)), 1u,
                      std::clamp(most, 1u, kMostEdge));
}

} // namespace

EmissionCells::EmissionCells(const Snapshot& scene, const std::vector<uint32_t>& triangles, ThreadPool& pool,
                             Progress& progress)
    : slot_(triangles.empty() ? 0 : scene.triangles.size()), grids_(triangles.size()) {
    constexpr size_t kBlock = 64;
    std::vector<std::vector<float>> cells(triangles.size());
    pool.for_each((triangles.size() + kBlock - 1) / kBlock, progress,
                  [&](size_t block) {
                      for (size_t i = block * kBlock; i < std::min(triangles.size(), (block + 1) * kBlock); ++i) {
                          grids_[i].edge = edge_of(scene, triangles[i], triangles.size());
                          cells[i] =
                              weigh(scene, triangles[i], grids_[i].edge, std::max(kPlainSamples / grids_[i].edge, 4u));
                      }
                  },
                  false);
    for (size_t i = 0; i < triangles.size(); ++i) {
        Grid& grid = grids_[i];
        slot_[triangles[i]] = static_cast<uint32_t>(i);
        double sum = 0.0, running = 0.0;
        for (const float c : cells[i]) sum += c;
        grid.mean = static_cast<float>(sum / static_cast<double>(cells[i].size()));
        if (!(sum > 0.0) || !std::isfinite(sum)) grid.edge = 1;
        if (grid.edge == 1) continue;
        grid.first = static_cast<uint32_t>(running_.size());
        for (const float c : cells[i]) {
            running += (1.0 - kEvenShare) * c / sum + kEvenShare / static_cast<double>(cells[i].size());
            running_.push_back(static_cast<float>(running));
        }
        add_guide(grid);
        cells[i] = {};
    }
}

void EmissionCells::add_guide(const Grid& grid) {
    const uint32_t count = grid.edge * grid.edge;
    uint32_t cell = 0;
    for (uint32_t part = 0; part < count; ++part) {
        const float begin = static_cast<float>(part) / static_cast<float>(count);
        while (cell + 1 < count && running_[grid.first + cell] <= begin) ++cell;
        const float* sums = running_.data() + grid.first;
        guide_.push_back({cell > 0 ? sums[cell - 1] : 0.0f, sums[cell], sums[std::min(cell + 1, count - 1)],
                          static_cast<uint16_t>(cell)});
    }
}

Vec2 EmissionCells::sample(uint32_t triangle, Vec2 u, float& density) const {
    const Grid& grid = grids_[slot_[triangle]];
    density = 1.0f;
    if (grid.edge == 1) return sample_triangle(u);
    const uint32_t count = grid.edge * grid.edge;
    const Part& part = part_of(grid, u.x);
    uint32_t cell = part.cell;
    float begin = part.begin, end = part.middle;
    if (u.x >= end && cell + 1 < count) { // the next cell's end stands in the part too
        ++cell;
        begin = end;
        end = part.end;
    }
    while (u.x >= end && cell + 1 < count) {
        begin = end;
        end = running_[grid.first + ++cell];
    }
    const float share = end - begin;
    u.x = std::clamp((u.x - begin) / share, 0.0f, 0x1.fffffep-1f);
    density = share * static_cast<float>(count);
    return Cell::of(grid.edge, cell).place(grid.edge, sample_triangle(u));
}

float EmissionCells::density(uint32_t triangle, float u, float v) const {
    const Grid& grid = grids_[slot_[triangle]];
    if (grid.edge == 1) return 1.0f;
    return chance(grid, Cell::at(grid.edge, u, v).index(grid.edge)) * static_cast<float>(grid.edge * grid.edge);
}

} // namespace ajar
