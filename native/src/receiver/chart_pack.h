// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "receiver/bit_rows.h"

namespace ajar {

/// Texels a chart covers, prepared for fast collision tests.
class Footprint {
public:
    Footprint() = default;
    explicit Footprint(BitRows mask);

    const BitRows& mask() const { return mask_; }
    int width() const { return mask_.width(); }
    int height() const { return mask_.height(); }
    /// The footprint turned by 90 degrees counter-clockwise: (x, y) becomes (height - 1 - y, x).
    Footprint turned() const;

private:
    friend class PagePacker;
    /// Consecutive equal rows.
    struct Band {
        int y, rows;
        std::vector<std::pair<int, int>> runs; ///< begin, length
        int longest = 0;
    };
    BitRows mask_;
    std::vector<Band> bands_; ///< longest runs first: those collide soonest
};

struct Placement {
    int x = 0, y = 0;
    bool turned = false;
};

/// One page: footprints are put at the lowest free place, at least `padding` texels apart and from
/// the border. Later footprints fill the gaps that earlier ones leave.
class PagePacker {
public:
    PagePacker(int width, int height, int padding);

    /// Finds a place and takes it; nothing if the page has none. turned may be null.
    std::optional<Placement> place(const Footprint& upright, const Footprint* turned);
    int used_width() const { return used_width_; }   ///< padding included
    int used_height() const { return used_height_; } ///< padding included

private:
    struct Spot {
        int x, y;
    };
    std::optional<Spot> find(const Footprint& shape, int below);
    std::optional<int> free_column(const Footprint& shape, int y);
    int rows_to_skip(const Footprint& shape, int y);
    int longest_free(int y);
    void block(const Footprint& shape, const Spot& spot);

    BitRows blocked_; ///< footprints widened by the padding
    int padding_, used_width_ = 0, used_height_ = 0;
    std::map<std::pair<int, int>, int> first_row_; ///< per size: rows below are known to be full
    struct FreeRun {
        int begin, length; ///< length kUnknown after a change
    };
    std::vector<FreeRun> free_run_; ///< longest run of free texels per row
    std::vector<uint64_t> conflict_, rows_;
};

} // namespace ajar
