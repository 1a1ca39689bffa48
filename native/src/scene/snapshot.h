// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "scene/element.h"
#include "scene/light.h"
#include "scene/material.h"
#include "scene/sky.h"
#include "scene/texture.h"

namespace ajar {

/// Triangle mesh in local space; corner arrays hold 3 entries per triangle.
struct Mesh {
    std::string name;
    std::vector<Vec3> positions;
    std::vector<uint32_t> corner_vertex;
    std::vector<Vec3> corner_normals;    ///< empty: flat shaded
    std::vector<uint32_t> triangle_slot; ///< empty: slot 0
    std::vector<std::vector<Vec2>> uv_layers;
    std::vector<std::vector<Vec4>> color_layers;

    uint32_t triangle_count() const { return static_cast<uint32_t>(corner_vertex.size() / 3); }
};

struct Instance {
    std::string name;
    uint32_t mesh = 0;
    Affine transform;
    std::vector<uint32_t> materials; ///< never empty after commit
    bool lightmapped = false;
    uint32_t visibility = AJAR_VISIBLE_GATHER | AJAR_VISIBLE_SHADOW;
    uint32_t lightmap_layer = AJAR_NONE;
    uint32_t page = AJAR_NONE;
    Vec2 uv_scale{1.0f}, uv_offset{0.0f};
    uint32_t element = kNoElement;   ///< door or toggle it is a part of
    bool open_pose = false;          ///< door: there while it is open, not while it is closed
    uint32_t light_set = kNoElement; ///< of its emission
    bool bake_back = false;          ///< its lightmap holds the light of the side that its normals point away from
};

/// One world-space triangle of the flattened scene.
struct Triangle {
    uint32_t vertex[3]; ///< into Snapshot::positions
    uint32_t instance;
    uint32_t source; ///< triangle of the instance's mesh
    uint32_t material;
    bool mirrored; ///< the normal is minus the cross product: the instance turns the winding, or the back is baked
};

/// Which rays a triangle stops. Shadow rays treat opaque and transmissive surfaces apart.
enum RayMask : uint32_t {
    kMaskGather = 1,
    kMaskShadowOpaque = 2,
    kMaskShadowTransmissive = 4,
    kMaskShadowSwitch = 8, ///< doors and toggles are groups of their own
    kMaskGatherSwitch = 16,
    kMaskSwitch = kMaskShadowSwitch | kMaskGatherSwitch,
    kMaskGatherAll = kMaskGather | kMaskGatherSwitch,
    kMaskWall = kMaskShadowOpaque | kMaskShadowSwitch ///< what parts the light of neighbouring texels
};

struct Page {
    uint32_t width = 0, height = 0;
    uint64_t first_texel = 0; ///< offset into arrays over all pages' texels
};

/// The scene as the baker sees it. Immutable after commit; everything below relies on its checks.
/// World positions are relative to origin, so that floats resolve detail far from zero.
struct Snapshot {
    std::string name;
    std::vector<Texture> textures;
    std::vector<Material> materials;
    std::vector<Mesh> meshes;
    std::vector<Instance> instances;
    std::vector<Element> elements;
    std::vector<Light> lights;
    std::vector<Page> pages;
    Sky sky;

    DVec3 origin{0.0};
    std::vector<Vec3> positions;
    std::vector<Triangle> triangles;
    Vec3 bounds_min{0.0f}, bounds_max{0.0f};
    std::vector<Warning> warnings;

    uint64_t texel_count() const {
        return pages.empty() ? 0 : pages.back().first_texel + uint64_t{pages.back().width} * pages.back().height;
    }
    float diagonal() const { return glm::length(bounds_max - bounds_min); }

    /// RayMask bits of a triangle. Triangles are stored grouped by it.
    uint32_t ray_mask(const Triangle& t) const;
    const Instance& instance_of(uint32_t triangle) const { return instances[triangles[triangle].instance]; }
    /// Presence of a triangle; element is kNoElement for fixed surfaces.
    Presence presence(uint32_t triangle) const {
        const Instance& i = instance_of(triangle);
        return {i.element, i.element == kNoElement || i.open_pose || elements[i.element].kind == ElementKind::toggle};
    }
    /// Whether rays that gather diffuse light meet a triangle; others neither shine nor reflect.
    bool is_gathered(uint32_t triangle) const { return (instance_of(triangle).visibility & AJAR_VISIBLE_GATHER) != 0; }
    bool has_switches() const;
    MeshPoint mesh_point(uint32_t triangle, float u, float v) const {
        return {instance_of(triangle).mesh, triangles[triangle].source, u, v};
    }
    SurfaceSample surface(uint32_t triangle, float u, float v) const {
        SurfaceSample s = materials[triangles[triangle].material].sample(*this, mesh_point(triangle, u, v));
        if (const Presence p = presence(triangle); !p.state && !elements[p.element].bounces) s.reflectance = Vec3(0.0f);
        return s;
    }
    Vec3 emission(uint32_t triangle, float u, float v) const {
        return materials[triangles[triangle].material].emission(*this, mesh_point(triangle, u, v));
    }
    Vec3 position(uint32_t triangle, float u, float v) const;
    /// Unit geometric normal; (0,0,1) never occurs for a kept triangle by accident: they have area.
    Vec3 geometric_normal(uint32_t triangle) const;
    float area(uint32_t triangle) const;
    /// Whether a triangle is of a mesh without normals of its own: its shading normals are the geometric one.
    bool is_flat(uint32_t triangle) const { return meshes[instance_of(triangle).mesh].corner_normals.empty(); }
    /// Unit shading normal of corner 0..2 in world space.
    Vec3 corner_normal(uint32_t triangle, int corner) const;
    /// Unit shading normal of the front at a point of a triangle, in world space: that of its corners, interpolated.
    Vec3 shading_normal(uint32_t triangle, float u, float v) const;
    /// Lightmap UV of a corner in texels of its page.
    Vec2 lightmap_uv(uint32_t triangle, int corner) const;
};

} // namespace ajar
