// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/surface_table.h"

#include "receiver/uv_raster.h"

namespace ajar {

SurfaceTable::SurfaceTable(const Snapshot& scene, const std::vector<Behind>& behind)
    : entries_(scene.triangles.size()), flags_(scene.triangles.size()) {
    for (uint32_t i = 0; i < scene.triangles.size(); ++i) {
        const Triangle& t = scene.triangles[i];
        const Material& material = scene.materials[t.material];
        const Instance& instance = scene.instances[t.instance];
        uint8_t f = material.emits ? kEmits : 0;
        f |= material.transmits ? kTransmits : 0;
        f |= material.one_sided ? kOneSided : 0;
        f |= t.mirrored ? kMirrored : 0;
        f |= behind[t.instance] == Behind::solid ? kSolid : 0;
        f |= instance.lightmapped ? 0 : kUnmapped;
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
