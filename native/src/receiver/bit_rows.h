// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <utility>
#include <vector>

namespace ajar {

/// A bitmap whose rows start on 64-bit words; bit x of a row is bit x%64 of word x/64.
class BitRows {
public:
    BitRows() = default;
    BitRows(int width, int height)
        : width_(width), height_(height), stride_((size_t(width) + 63) / 64), words_(stride_ * size_t(height), 0) {}

    int width() const { return width_; }
    int height() const { return height_; }
    size_t stride() const { return stride_; }
    uint64_t* row(int y) { return words_.data() + size_t(y) * stride_; }
    const uint64_t* row(int y) const { return words_.data() + size_t(y) * stride_; }
    bool get(int x, int y) const { return (row(y)[x >> 6] >> (x & 63)) & 1u; }
    void set(int x, int y) { row(y)[x >> 6] |= uint64_t(1) << (x & 63); }
    /// Sets [begin, end) of a row; clipped to the bitmap.
    void set_span(int y, int begin, int end);
    size_t count() const;
    /// Runs [begin, end) of set bits of a row.
    std::vector<std::pair<int, int>> runs(int y) const;

private:
    int width_ = 0, height_ = 0;
    size_t stride_ = 0;
    std::vector<uint64_t> words_;
};

/// Sample spans of a polygon (even-odd rule): rows y and columns [begin, end) whose centres
/// (x + 0.5, y + 0.5) lie inside. Coordinates are in bitmap units.
struct SampleSpan {
    int y, begin, end;
};
void polygon_spans(std::span<const glm::dvec2> polygon, int width, int height, std::vector<SampleSpan>& out);

/// Sets every bit whose square the polygon touches by more than a thousandth of its size.
void cover_polygon(std::span<const glm::dvec2> polygon, BitRows& bits);

} // namespace ajar
