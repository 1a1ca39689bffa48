// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/surface_table.h"

#include <bit>
#include <unordered_map>

#include "base/hash.h"
#include "receiver/uv_raster.h"

namespace ajar {

namespace {

struct PositionHash {
    size_t operator()(const Vec3& p) const {
        return hash_combine(hash_combine(std::bit_cast<uint32_t>(p.x + 0.0f), std::bit_cast<uint32_t>(p.y + 0.0f)),
                            std::bit_cast<uint32_t>(p.z + 0.0f));
    }
};

} // namespace

bool is_closed(const Mesh& mesh) {
    std::unordered_map<Vec3, uint32_t, PositionHash> weld;
    std::vector<uint32_t> id(mesh.positions.size());
    for (size_t i = 0; i < id.size(); ++i)
        id[i] = weld.try_emplace(mesh.positions[i], static_cast<uint32_t>(i)).first->second;
    std::unordered_map<uint64_t, int> edges; // +1 along, -1 against: 0 and used twice in a closed, oriented mesh
    std::unordered_map<uint64_t, int> uses;
    for (size_t c = 0; c < mesh.corner_vertex.size(); ++c) {
        const uint32_t a = id[mesh.corner_vertex[c]], b = id[mesh.corner_vertex[c - c % 3 + (c + 1) % 3]];
        if (a == b) continue;
        const uint64_t key = (uint64_t{std::min(a, b)} << 32) | std::max(a, b);
        edges[key] += a < b ? 1 : -1;
        ++uses[key];
    }
    if (uses.empty()) return false;
    for (const auto& [key, count] : uses)
        if (count != 2 || edges[key] != 0) return false;
    return true;
}

SurfaceTable::SurfaceTable(const Snapshot& scene) : entries_(scene.triangles.size()), flags_(scene.triangles.size()) {
    std::vector<uint8_t> closed(scene.meshes.size());
    for (size_t m = 0; m < closed.size(); ++m) closed[m] = is_closed(scene.meshes[m]);
    for (uint32_t i = 0; i < scene.triangles.size(); ++i) {
        const Triangle& t = scene.triangles[i];
        const Material& material = scene.materials[t.material];
        const Instance& instance = scene.instances[t.instance];
        uint8_t f = material.emits ? kEmits : 0;
        f |= material.transmits ? kTransmits : 0;
        f |= material.one_sided ? kOneSided : 0;
        f |= t.mirrored ? kMirrored : 0;
        f |= closed[instance.mesh] && !material.transmits ? kSolid : 0;
        f |= instance.lightmapped ? 0 : kUnmapped;
        f |= instance.element != kNoElement ? kSwitch : 0;
        if (instance.lightmapped) {
            const auto uv = texel_triangle(scene, i);
            const Page& page = scene.pages[instance.page];
            entries_[i] = {uv[0],
                           uv[1] - uv[0],
                           uv[2] - uv[0],
                           static_cast<uint32_t>(page.first_texel),
                           static_cast<uint16_t>(page.width),
                           static_cast<uint16_t>(page.height)};
        }
        flags_[i] = f;
    }
}

} // namespace ajar
