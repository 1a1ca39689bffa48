// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "accel/embree_scene.h"

namespace ajar {

/// What lies behind the backs of a mesh.
enum class Behind : uint8_t {
    open,  ///< either side of the mesh leads to the other, or light gets through it
    solid, ///< closed and opaque, no source of light on that side: the inside of a thing, nobody looks at receivers
           ///< there
    room   ///< closed and opaque around a source of light: a room whose normals point out of it
};

/// For each instance. No light gets into a solid, so that its backs are black: gather rays end there, which spares them
/// ways through the dark, and light that a texel holds which a wall cuts does not spread inside. The backs of rooms
/// reflect what falls on them. Sources are lamps, the sky, and emissive surfaces, tried at up to 256 points each.
std::vector<Behind> find_solids(const Snapshot& scene, const Tracer& tracer);

} // namespace ajar
