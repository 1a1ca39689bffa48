// SPDX-License-Identifier: GPL-3.0-or-later
#include "package/patch_atlas.h"

#include <algorithm>
#include <numeric>

namespace ajar {
namespace {

constexpr uint32_t kChannels = 4;

uint64_t area(const PatchSize& s) { return uint64_t{s.width} * s.height; }

/// One colour channel, filled in shelves from the bottom up.
class ChannelPacker {
public:
    bool insert(const PatchSize& atlas, const PatchSize& patch, PatchPlace& place) {
        auto shelf = std::find_if(shelves_.begin(), shelves_.end(), [&](const Shelf& s) {
            return patch.height <= s.height && patch.width <= atlas.width - s.used;
        });
        if (shelf == shelves_.end()) {
            if (patch.height > atlas.height - top_ || patch.width > atlas.width) return false;
            shelf = shelves_.insert(shelf, {top_, patch.height, 0});
            top_ += patch.height;
        }
        place.x = shelf->used;
        place.y = shelf->y;
        shelf->used += patch.width;
        return true;
    }

private:
    struct Shelf {
        uint32_t y, height, used;
    };
    std::vector<Shelf> shelves_;
    uint32_t top_ = 0;
};

/// Places as many of the patches, in their order, as an atlas of this size takes; returns the others.
std::vector<uint32_t> fill_atlas(const PatchSize& size, uint32_t atlas, std::span<const PatchSize> patches,
                                 const std::vector<uint32_t>& order, std::vector<PatchPlace>& places) {
    ChannelPacker channels[kChannels];
    std::vector<uint32_t> left;
    for (const uint32_t p : order) {
        uint32_t c = 0;
        while (c < kChannels && !channels[c].insert(size, patches[p], places[p])) ++c;
        if (c == kChannels) {
            left.push_back(p);
        } else {
            places[p].atlas = atlas;
            places[p].channel = c;
        }
    }
    return left;
}

PatchSize first_size(std::span<const PatchSize> patches, const std::vector<uint32_t>& order) {
    PatchSize size;
    uint64_t waiting = 0;
    for (const uint32_t p : order) {
        size.width = std::max(size.width, patches[p].width);
        size.height = std::max(size.height, patches[p].height);
        waiting += area(patches[p]);
    }
    while (2 * kChannels * area(size) < waiting && 2 * std::max(size.width, size.height) <= kLargestAtlas)
        size = {2 * size.width, 2 * size.height};
    return size;
}

} // namespace

AtlasPlan plan_atlases(std::span<const PatchSize> patches) {
    AtlasPlan plan;
    plan.places.resize(patches.size());
    std::vector<uint32_t> order(patches.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        const PatchSize &p = patches[a], &q = patches[b];
        return p.height != q.height ? p.height > q.height : p.width > q.width;
    });
    while (!order.empty()) {
        const PatchSize size = first_size(patches, order);
        order = fill_atlas(size, static_cast<uint32_t>(plan.atlases.size()), patches, order, plan.places);
        plan.atlases.push_back(size);
    }
    return plan;
}

} // namespace ajar
