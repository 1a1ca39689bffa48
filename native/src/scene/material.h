// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "ajar/ajar.h"
#include "scene/texture.h"

namespace ajar {

struct Snapshot;

/// A place on a mesh of the scene: triangle of the mesh and barycentric weights of corners 1 and 2.
struct MeshPoint {
    uint32_t mesh = 0;
    uint32_t triangle = 0;
    float u = 0.0f, v = 0.0f;
};

/// A surface reduced to what diffuse transport needs.
struct SurfaceSample {
    Vec3 reflectance{0.0f};   ///< total hemispherical reflectance, 0..kMaxReflectance
    Vec3 emission{0.0f};      ///< radiance, W/(m^2 sr)
    Vec3 transmittance{0.0f}; ///< straight through
};

/// Reflectance is clamped here: the bounce series of a closed room diverges at 1 (algorithms.md 5.4).
inline constexpr float kMaxReflectance = 0.95f;

struct Material {
    std::string name;
    std::vector<ajar_closure> closures;
    bool one_sided = false;
    bool emits = false;     ///< some closure emits a non-zero radiance
    bool transmits = false; ///< some closure lets light through

    /// Evaluates all closures at a point.
    SurfaceSample sample(const Snapshot& scene, const MeshPoint& at) const;
    /// How finely emission may vary: longest edge of the triangle at, in texels of what its emission reads;
    /// 0 for even emission.
    float emission_detail(const Snapshot& scene, const MeshPoint& at) const;
    /// The emitted radiance alone.
    Vec3 emission(const Snapshot& scene, const MeshPoint& at) const;
};

/// Total hemispherical reflectance of a specular lobe, GGX with Schlick Fresnel, including
/// multiple scattering: f0 * A(r) + B(r), scaled (algorithms.md 11.2).
Vec3 specular_albedo(const Vec3& f0, float roughness);

/// Total hemispherical reflectance of a Principled surface (algorithms.md 11.3).
Vec3 principled_albedo(const Vec3& base, float metallic, float roughness, float specular);

} // namespace ajar
