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

/// For each instance. It says where receivers make sense and nothing about transport: backs reflect what falls on
/// them, which is nothing in a solid. Sources are lamps, the sky, and emissive surfaces of other instances, tried at
/// a few points each.
std::vector<Behind> find_solids(const Snapshot& scene, const Tracer& tracer);

} // namespace ajar
