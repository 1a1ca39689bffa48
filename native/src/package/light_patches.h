// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The layout of semi-dynamic light maps: for engines that blend plain textures instead of running
// the dispatches of terms.bin. A map holds what one light adds with every door open and every toggle
// away, or what one object in its place takes from one light; a map is cut into patches around what
// is not black, and patches share the channels of atlases. Objects take light independently of one
// another here: where the shadows of two overlap it is taken twice. terms.bin knows such pairs.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "package/manifest.h"
#include "package/patch_atlas.h"

namespace ajar {

/// A rectangle of a page and of one channel of an atlas. Rows count from the bottom.
struct LightPatch {
    PatchPlace place;
    PatchSize size;
    uint32_t page = 0, x = 0, y = 0; ///< of its corner on the page
    uint32_t plane = 0;              ///< red, green, blue; 0 in a map of one plane
};

/// What a light adds (object is kNone) or what an object takes from it; light kNone is the light
/// that no set holds. Stored values times scale are W/m^2; in a map of one plane times color.
struct LightMap {
    uint32_t light = 0, object = 0; ///< indices of elements, or kNone
    float scale = 1.0f;             ///< a power of two
    std::array<float, 3> color{1.0f, 1.0f, 1.0f};
    uint32_t planes = 3;
    std::vector<LightPatch> patches;
};

struct LightPatches {
    static constexpr uint32_t kNone = 0xffffffffu;

    std::vector<LightMap> maps;
    std::vector<PatchSize> atlases;
    std::vector<std::vector<uint32_t>> texels; ///< of each atlas, RGBA half floats, two words a texel, bottom row first
    uint64_t dropped_terms = 0;                ///< terms of two or more objects: the layout treats objects one by one
};

/// File name of an atlas, e.g. "patches_0.dds".
std::string atlas_file(size_t atlas);

/// Builds maps, patches and atlases (semi-dynamic light maps, algorithms 1 to 4 and section 3.2.6).
/// Light sets get maps of one plane and a colour each, as there, or of three planes. Pages are cut
/// into blocks first, so that the patches of a map never overlap.
LightPatches make_light_patches(const PackageContent& content, LightPatchPlanes planes);

/// patches.json (schemas/patches.schema.json).
std::string light_patches_json(const PackageContent& content, const LightPatches& patches);

} // namespace ajar
