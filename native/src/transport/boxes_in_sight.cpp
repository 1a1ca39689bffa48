// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/boxes_in_sight.h"

#include "base/hash.h"
#include "base/owen_sobol.h"

namespace ajar {

namespace {

constexpr uint32_t kLooks = 48; ///< rays of a tile that look for a box; a multiple of kLanes

/// Puts a ray from a random receiver of the tile to a random point of the box into a lane; false if the receiver
/// faces away.
bool aim_look(const LightmapReceivers& receivers, const Tile& tile, const AimBox& box, uint32_t number, uint32_t seed,
              RayPacket& rays, uint32_t lane) {
    const uint32_t h = hash_combine(hash_combine(seed, receivers.texel[tile.first]), box.element ^ (number << 16));
    const uint32_t r = tile.first + hash32(h) % tile.count;
    const Vec3& p = receivers.origins(r)[number % receivers.positions_per_texel];
    const AimBox::View view = box.view_from(p);
    if (!(view.solid_angle > 0.0f)) return false;
    const Vec3 w = view.sample(owen_sobol(number, h));
    rays.set(lane, p, w, box.distance(p, w) * 0.999f);
    return glm::dot(w, receivers.frame[r].z) > 0.0f && rays.tfar[lane] > 0.0f;
}

} // namespace

BoxesInSight::BoxesInSight(const Tracer& tracer, const LightmapReceivers& receivers, std::vector<AimBox> boxes,
                           uint32_t seed)
    : tracer_(tracer), receivers_(receivers), boxes_(std::move(boxes)), seed_(seed), seen_(receivers.tiles.size()) {}

bool BoxesInSight::sees(const Tile& tile, const AimBox& box, uint64_t& traced) const {
    RayPacket rays;
    alignas(32) int32_t valid[kLanes];
    for (uint32_t begin = 0; begin < kLooks; begin += kLanes) {
        rays.prepare(kMaskGather);
        for (uint32_t lane = 0; lane < kLanes; ++lane) {
            valid[lane] = aim_look(receivers_, tile, box, begin + lane, seed_, rays, lane) ? -1 : 0;
            if (valid[lane] == 0) rays.set(lane, Vec3(0.0f), Vec3(0, 0, 1), 0.0f);
            traced += valid[lane] != 0;
        }
        tracer_.occluded(valid, rays);
        for (uint32_t lane = 0; lane < kLanes; ++lane)
            if (valid[lane] != 0 && rays.tfar[lane] >= 0.0f) return true;
    }
    return false;
}

const std::vector<uint32_t>& BoxesInSight::from(uint32_t receiver, uint64_t& rays) {
    const auto next = std::upper_bound(receivers_.tiles.begin(), receivers_.tiles.end(), receiver,
                                       [](uint32_t r, const Tile& t) { return r < t.first; });
    const Tile& tile = *(next - 1);
    Seen& seen = seen_[static_cast<size_t>(next - receivers_.tiles.begin()) - 1];
    std::call_once(seen.found, [&] {
        for (uint32_t b = 0; b < boxes_.size(); ++b)
            if (sees(tile, boxes_[b], rays)) seen.boxes.push_back(b);
    });
    return seen.boxes;
}

} // namespace ajar
