// SPDX-License-Identifier: GPL-3.0-or-later
#include "post/dilate.h"

namespace ajar {

namespace {

/// Offsets within radius, nearest first.
std::vector<std::pair<int, int>> spiral(int radius) {
    std::vector<std::pair<int, int>> offsets;
    for (int y = -radius; y <= radius; ++y)
        for (int x = -radius; x <= radius; ++x)
            if ((x != 0 || y != 0) && x * x + y * y <= radius * radius) offsets.emplace_back(x, y);
    std::stable_sort(offsets.begin(), offsets.end(), [](const auto& a, const auto& b) {
        return a.first * a.first + a.second * a.second < b.first * b.first + b.second * b.second;
    });
    return offsets;
}

} // namespace

std::vector<uint32_t> nearest_known(const std::vector<Page>& pages, const std::vector<uint8_t>& known,
                                    uint32_t radius) {
    std::vector<uint32_t> source(known.size());
    const auto offsets = spiral(static_cast<int>(radius));
    for (const Page& page : pages) {
        const int w = static_cast<int>(page.width), h = static_cast<int>(page.height);
        for (int y = 0; y < h; ++y)
            for (int x = 0; x < w; ++x) {
                const size_t i = page.first_texel + size_t(y) * w + x;
                source[i] = static_cast<uint32_t>(i);
                if (known[i] != 0) continue;
                for (const auto& [dx, dy] : offsets) {
                    const int sx = x + dx, sy = y + dy;
                    if (sx < 0 || sy < 0 || sx >= w || sy >= h) continue;
                    const size_t j = page.first_texel + size_t(sy) * w + sx;
                    if (known[j] == 0) continue;
                    source[i] = static_cast<uint32_t>(j);
                    break;
                }
            }
    }
    return source;
}

} // namespace ajar
