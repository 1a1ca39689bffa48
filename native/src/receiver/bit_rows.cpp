// SPDX-License-Identifier: GPL-3.0-or-later
#include "receiver/bit_rows.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace ajar {
namespace {

constexpr double kTouch = 1e-3; ///< overlaps thinner than this do not count

/// A whole number as a cell index in [0, count]; huge values are legal.
int cell_index(double whole, int count) { return int(std::clamp(whole, 0.0, double(count))); }

/// Cells [first, last] that the interval enters by more than kTouch; none if it hugs a cell border.
struct CellRange {
    int first, last;

    CellRange(double low, double high, int count) {
        double begin = std::floor(low + kTouch), end = std::floor(high - kTouch);
        if (end < begin && std::floor(low - kTouch) == std::floor(high + kTouch)) end = begin;
        first = cell_index(begin, count);
        last = cell_index(end + 1.0, count) - 1;
    }
};

/// Sets the bits that segment p-q runs through.
void cover_segment(glm::dvec2 p, glm::dvec2 q, BitRows& bits) {
    if (p.y > q.y) std::swap(p, q);
    const CellRange rows(p.y, q.y, bits.height());
    const double slope = q.y > p.y ? (q.x - p.x) / (q.y - p.y) : 0.0;
    for (int y = rows.first; y <= rows.last; ++y) {
        double x0 = p.x, x1 = q.x;
        if (q.y > p.y) {
            x0 = p.x + slope * (std::clamp(double(y), p.y, q.y) - p.y);
            x1 = p.x + slope * (std::clamp(double(y + 1), p.y, q.y) - p.y);
        }
        const CellRange columns(std::min(x0, x1), std::max(x0, x1), bits.width());
        if (columns.first <= columns.last) bits.set_span(y, columns.first, columns.last + 1);
    }
}

} // namespace

void BitRows::set_span(int y, int begin, int end) {
    begin = std::max(begin, 0);
    end = std::min(end, width_);
    if (begin >= end) return;
    uint64_t* words = row(y);
    const int first = begin >> 6, last = (end - 1) >> 6;
    const uint64_t head = ~uint64_t(0) << (begin & 63);
    const uint64_t tail = ~uint64_t(0) >> (63 - ((end - 1) & 63));
    if (first == last) {
        words[first] |= head & tail;
        return;
    }
    words[first] |= head;
    for (int w = first + 1; w < last; ++w) words[w] = ~uint64_t(0);
    words[last] |= tail;
}

size_t BitRows::count() const {
    size_t sum = 0;
    for (uint64_t word : words_) sum += size_t(std::popcount(word));
    return sum;
}

std::vector<std::pair<int, int>> BitRows::runs(int y) const {
    std::vector<std::pair<int, int>> result;
    int x = 0;
    while (x < width_) {
        while (x < width_ && !get(x, y)) ++x;
        const int begin = x;
        while (x < width_ && get(x, y)) ++x;
        if (x > begin) result.emplace_back(begin, x);
    }
    return result;
}

void polygon_spans(std::span<const glm::dvec2> polygon, int width, int height, std::vector<SampleSpan>& out) {
    out.clear();
    double low = polygon[0].y, high = low;
    for (const glm::dvec2& p : polygon) {
        low = std::min(low, p.y);
        high = std::max(high, p.y);
    }
    const int first = cell_index(std::ceil(low - 0.5), height), last = cell_index(std::ceil(high - 0.5), height);
    std::vector<double> crossings;
    for (int y = first; y < last; ++y) {
        crossings.clear();
        const double line = y + 0.5;
        for (size_t i = 0; i < polygon.size(); ++i) {
            const glm::dvec2 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
            if ((p.y <= line) != (q.y <= line)) crossings.push_back(p.x + (q.x - p.x) * (line - p.y) / (q.y - p.y));
        }
        std::sort(crossings.begin(), crossings.end());
        for (size_t i = 0; i + 1 < crossings.size(); i += 2) {
            const int begin = cell_index(std::ceil(crossings[i] - 0.5), width);
            const int end = cell_index(std::ceil(crossings[i + 1] - 0.5), width);
            if (begin < end) out.push_back({y, begin, end});
        }
    }
}

void cover_polygon(std::span<const glm::dvec2> polygon, BitRows& bits) {
    std::vector<SampleSpan> spans;
    polygon_spans(polygon, bits.width(), bits.height(), spans);
    for (const SampleSpan& s : spans) bits.set_span(s.y, s.begin, s.end);
    for (size_t i = 0; i < polygon.size(); ++i) cover_segment(polygon[i], polygon[(i + 1) % polygon.size()], bits);
}

} // namespace ajar
