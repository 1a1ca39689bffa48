// SPDX-License-Identifier: GPL-3.0-or-later
// The doors that the gather rays of a bake with elements are aimed at.
#include "pass/term_bake.h"

namespace ajar {

namespace {

constexpr uint32_t kMostAims = 4;  ///< doors that a tile aims rays at
constexpr float kAimShare = 0.02f; ///< of a tile's indirect light: doors that bring less are left to chance

} // namespace

/// Luminance that comes back along a ray, and each term of it over what a texel keeps of that term, emission and
/// sky over what it keeps of the base. Surfaces without stored light may be bright.
TileAims::Arrival TermBaker::arrival(const Ray& ray, const Hit& hit) const {
    TileAims::Arrival sum;
    const auto add = [&](uint32_t term, float light) {
        sum.light += light, sum.worth += light / std::max(threshold_[term], 1e-30f);
    };
    constexpr float kUnknown = std::numeric_limits<float>::infinity();
    if (hit.triangle == kMiss) {
        add(0, luminance(s_.scene.sky.radiance(ray.direction)));
        return sum;
    }
    const uint8_t flags = s_.surfaces.flags(hit.triangle);
    if ((flags & SurfaceTable::kUnmapped) != 0) return {kUnknown, kUnknown};
    if ((flags & SurfaceTable::kEmits) != 0) add(0, luminance(s_.scene.emission(hit.triangle, hit.u, hit.v)));
    const uint32_t texel = s_.surfaces.texel(hit.triangle, hit.u, hit.v);
    if (!hit.back)
        for (const TermColor* e = radiance_.begin(texel); e != radiance_.end(texel); ++e)
            add(e->term, std::abs(luminance(e->color)));
    return sum;
}

/// Irradiance that surfaces sent to a tile in the bounces, luminance, mean over its receivers.
float TermBaker::indirect_light(const Tile& tile) const {
    double sum = 0.0;
    for (uint32_t r = tile.first; r < tile.first + tile.count; ++r)
        sum += luminance(source_.total(table_, r) - direct_.total(table_, r));
    return static_cast<float>(std::max(sum, 0.0) / tile.count);
}

uint32_t TermBaker::rays_per_door(uint32_t samples) const {
    const auto share = static_cast<uint32_t>(std::lround(settings_.door_rays * static_cast<float>(samples)));
    return (share + 1) & ~1u;
}

/// Doors through which light of some account comes to a part of a tile.
std::vector<uint32_t> TermBaker::find_doors(const Tile& part, uint32_t seed) const {
    std::vector<uint32_t> found;
    if (part.count == 0 || doors_ == nullptr || doors_->boxes().empty()) return found;
    const Working here(Effect::doors);
    const float least = kAimShare * indirect_light(part);
    const uint32_t own_seed = hash_combine(seed, s_.receivers.texel[part.first]);
    const auto look = [&](const Ray& r, const Hit& h) { return arrival(r, h); };
    TileAims aims(s_.receivers, part);
    uint64_t rays = 0;
    for (const uint32_t door : doors_->from(part.first, rays)) {
        if (found.size() == kMostAims) break;
        rays += aims.add(s_.tracer, doors_->boxes()[door], look, 1, least, own_seed);
        if (aims.count() > found.size()) found.push_back(door);
    }
    progress_.add_rays(rays);
    return found;
}

/// Those of every part of the final gather.
void TermBaker::find_aims() {
    const std::vector<Tile>& tiles = s_.receivers.tiles;
    aims_.resize(tiles.size() * kAimedParts);
    if (!gathers()) return;
    pool_.for_each(
        tiles.size(), progress_,
        [&](size_t i) {
            const TileParts parts = split(s_.receivers, tiles[i]);
            const uint32_t seed = hash_combine(settings_.seed, kSaltFinal);
            for (uint32_t k = 0; k < kPilotParts; ++k)
                aims_[i * kAimedParts + k] = find_doors(tile_part(parts.own, k), seed);
            aims_[i * kAimedParts + kPilotParts] = find_doors(parts.ring, seed);
        },
        false);
}

/// The part of tile i that a piece of it lies in; kPilotParts for the ring.
uint32_t TermBaker::part_number(size_t i, const Tile& piece) const {
    const Tile& tile = s_.receivers.tiles[i];
    const uint32_t own = split(s_.receivers, tile).own.count, first = piece.first - tile.first;
    return first < own ? part_of(own, first) : kPilotParts;
}

/// Those of the part that a piece of tile i lies in.
const std::vector<uint32_t>& TermBaker::doors_of(size_t i, const Tile& piece) const {
    return guide().aims_[i * kAimedParts + part_number(i, piece)];
}

/// Rays of a part into doors, beside samples of the hemisphere.
TileAims TermBaker::aim_at(const std::vector<uint32_t>& doors, const Tile& part, uint32_t samples) const {
    TileAims aims(s_.receivers, part);
    const uint32_t rays = rays_per_door(samples);
    for (const uint32_t door : doors)
        if (rays > 0) aims.add(doors_->boxes()[door], rays);
    return aims;
}

} // namespace ajar
