// SPDX-License-Identifier: GPL-3.0-or-later
#include "receiver/chart_pack.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace ajar {
namespace {

constexpr int kUnknown = -1;

/// target |= source >> shift, as one long bit string of `words` words.
void or_shifted_down(uint64_t* target, const uint64_t* source, size_t words, int shift) {
    const size_t skip = size_t(shift) >> 6;
    const int bits = shift & 63;
    if (skip >= words) return;
    const size_t count = words - skip;
    if (bits == 0) {
        for (size_t i = 0; i < count; ++i) target[i] |= source[i + skip];
        return;
    }
    for (size_t i = 0; i + 1 < count; ++i)
        target[i] |= (source[i + skip] >> bits) | (source[i + skip + 1] << (64 - bits));
    target[count - 1] |= source[words - 1] >> bits;
}

/// Afterwards bit x is set if any of bits x .. x+length-1 was set.
void spread_down(uint64_t* row, size_t words, int length) {
    int reach = 1;
    while (2 * reach <= length) {
        or_shifted_down(row, row, words, reach); // reads ahead of what it writes, so in place is safe
        reach *= 2;
    }
    if (reach < length) or_shifted_down(row, row, words, length - reach);
}

} // namespace

Footprint::Footprint(BitRows mask) : mask_(std::move(mask)) {
    for (int y = 0; y < mask_.height(); ++y) {
        const bool same = y > 0 && std::equal(mask_.row(y), mask_.row(y) + mask_.stride(), mask_.row(y - 1));
        if (same) {
            ++bands_.back().rows;
            continue;
        }
        bands_.push_back({y, 1, {}});
        for (const auto& [begin, end] : mask_.runs(y)) {
            bands_.back().runs.emplace_back(begin, end - begin);
            bands_.back().longest = std::max(bands_.back().longest, end - begin);
        }
    }
    std::stable_sort(bands_.begin(), bands_.end(), [](const Band& a, const Band& b) { return a.longest > b.longest; });
}

Footprint Footprint::turned() const {
    BitRows result(mask_.height(), mask_.width());
    for (int y = 0; y < mask_.height(); ++y)
        for (const auto& [begin, end] : mask_.runs(y))
            for (int x = begin; x < end; ++x) result.set(mask_.height() - 1 - y, x);
    return Footprint(std::move(result));
}

PagePacker::PagePacker(int width, int height, int padding)
    : blocked_(width, height),
      padding_(padding),
      free_run_(size_t(height), FreeRun{0, width}),
      conflict_(blocked_.stride()),
      rows_(blocked_.stride()) {}

std::optional<Placement> PagePacker::place(const Footprint& upright, const Footprint* turned) {
    const std::optional<Spot> first = find(upright, blocked_.height());
    // The turned footprint wins if it ends lower.
    std::optional<Spot> second;
    if (turned) second = find(*turned, first ? first->y + upright.height() - turned->height() : blocked_.height());
    if (second) {
        block(*turned, *second);
        return Placement{second->x, second->y, true};
    }
    if (!first) return std::nullopt;
    block(upright, *first);
    return Placement{first->x, first->y, false};
}

/// Lowest place whose row is less than `below`.
std::optional<PagePacker::Spot> PagePacker::find(const Footprint& shape, int below) {
    const int last = std::min(blocked_.height() - padding_ - shape.height(), below - 1);
    if (shape.width() > blocked_.width() - 2 * padding_) return std::nullopt;
    int& start = first_row_.try_emplace({shape.width(), shape.height()}, padding_).first->second;
    for (int y = start; y <= last; ++y) {
        if (const int skip = rows_to_skip(shape, y)) {
            y += skip - 1;
            continue;
        }
        const std::optional<int> x = free_column(shape, y);
        if (!x) continue;
        start = y;
        return Spot{*x, y};
    }
    start = std::max(start, last + 1);
    return std::nullopt;
}

/// How far up the shape must at least move because some row has no free run as long as it needs.
int PagePacker::rows_to_skip(const Footprint& shape, int y) {
    int skip = 0;
    for (const Footprint::Band& band : shape.bands_)
        for (int r = band.rows - 1; r >= skip; --r)
            if (longest_free(y + band.y + r) < band.longest) skip = r + 1;
    return skip;
}

int PagePacker::longest_free(int y) {
    FreeRun& longest = free_run_[size_t(y)];
    if (longest.length != kUnknown) return longest.length;
    longest = {0, 0};
    const uint64_t* row = blocked_.row(y);
    int begin = 0; // of the current run
    const auto end_run = [&](int end) {
        if (end - begin > longest.length) longest = {begin, end - begin};
    };
    for (size_t w = 0; w < blocked_.stride(); ++w) {
        const int base = int(64 * w);
        for (int at = 0; at < 64;) {
            const int zeros = std::min(std::countr_zero(row[w] >> at), 64 - at);
            if (zeros > 0) at += zeros;
            if (at >= 64) break;
            end_run(base + at);
            at += std::countr_one(row[w] >> at);
            begin = base + at;
        }
    }
    end_run(blocked_.width());
    return longest.length;
}

std::optional<int> PagePacker::free_column(const Footprint& shape, int y) {
    const size_t words = blocked_.stride();
    const int last = blocked_.width() - padding_ - shape.width(); // largest x allowed
    std::fill(conflict_.begin(), conflict_.end(), 0);
    conflict_[0] |= (uint64_t(1) << std::min(padding_, 63)) - 1;
    for (size_t w = 0; w < words; ++w) {
        const int beyond = last + 1 - int(64 * w); // bits from here on are too far right
        if (beyond <= 0)
            conflict_[w] = ~uint64_t(0);
        else if (beyond < 64)
            conflict_[w] |= ~uint64_t(0) << beyond;
    }
    for (const Footprint::Band& band : shape.bands_) {
        for (const auto& [begin, length] : band.runs) {
            std::memcpy(rows_.data(), blocked_.row(y + band.y), words * sizeof(uint64_t));
            for (int r = 1; r < band.rows; ++r) {
                const uint64_t* row = blocked_.row(y + band.y + r);
                for (size_t w = 0; w < words; ++w) rows_[w] |= row[w];
            }
            spread_down(rows_.data(), words, length);
            or_shifted_down(conflict_.data(), rows_.data(), words, begin);
        }
        if (std::all_of(conflict_.begin(), conflict_.end(), [](uint64_t w) { return w == ~uint64_t(0); }))
            return std::nullopt;
    }
    for (size_t w = 0; w < words; ++w)
        if (~conflict_[w]) return int(64 * w) + std::countr_one(conflict_[w]);
    return std::nullopt;
}

void PagePacker::block(const Footprint& shape, const Spot& spot) {
    for (const Footprint::Band& band : shape.bands_)
        for (const auto& [begin, length] : band.runs) {
            const int low = std::max(spot.y + band.y - padding_, 0);
            const int high = std::min(spot.y + band.y + band.rows + padding_, blocked_.height());
            for (int y = low; y < high; ++y) {
                const int from = spot.x + begin - padding_, to = spot.x + begin + length + padding_;
                blocked_.set_span(y, from, to);
                FreeRun& free = free_run_[size_t(y)];
                if (from < free.begin + free.length && to > free.begin) free.length = kUnknown;
            }
        }
    used_width_ = std::max(used_width_, spot.x + shape.width() + padding_);
    used_height_ = std::max(used_height_, spot.y + shape.height() + padding_);
}

} // namespace ajar
