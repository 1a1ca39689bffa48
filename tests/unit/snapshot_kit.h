// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Builds small snapshots for tests of the folders that read them.

#include <memory>
#include <utility>
#include <vector>

#include "scene/snapshot_builder.h"

namespace ajar {

class SnapshotKit {
public:
    uint32_t page(uint32_t width, uint32_t height) { return builder_.add_page(width, height); }

    uint32_t material(const Vec3& albedo, const Vec3& emission = Vec3(0.0f), bool one_sided = false) {
        const ajar_closure closures[2] = {closure(AJAR_CLOSURE_DIFFUSE, albedo),
                                          closure(AJAR_CLOSURE_EMISSION, emission)};
        ajar_material_desc d{};
        d.closure_count = 2;
        d.closures = closures;
        d.one_sided = one_sided;
        return builder_.add_material(d);
    }

    /// Lets light through.
    uint32_t glass(const Vec3& transmittance) {
        const ajar_closure through = closure(AJAR_CLOSURE_TRANSPARENT, transmittance);
        ajar_material_desc d{};
        d.closure_count = 1;
        d.closures = &through;
        return builder_.add_material(d);
    }

    /// Black, emits an image: width * height luminances, bottom row first, over UV layer 0.
    uint32_t glowing_image(uint32_t width, uint32_t height, const std::vector<float>& grey) {
        ajar_closure glow = closure(AJAR_CLOSURE_EMISSION, Vec3(1.0f));
        glow.color.texture = image(width, height, grey);
        ajar_material_desc d{};
        d.closure_count = 1;
        d.closures = &glow;
        return builder_.add_material(d);
    }

    uint32_t toggle() {
        ajar_element_desc d{};
        d.name = "toggle";
        d.kind = AJAR_ELEMENT_TOGGLE;
        d.weight = 1.0f;
        d.combine = 1;
        return builder_.add_element(d);
    }

    /// Three corners per triangle. With UVs (in [0,1], one per corner) it is lightmapped on page. element: a toggle's.
    uint32_t object(const std::vector<Vec3>& corners, uint32_t material, const std::vector<Vec2>& uv = {},
                    uint32_t page = AJAR_NONE, uint32_t element = AJAR_NONE) {
        std::vector<uint32_t> vertex(corners.size());
        for (uint32_t i = 0; i < vertex.size(); ++i) vertex[i] = i;
        ajar_mesh_desc m{};
        m.vertex_count = static_cast<uint32_t>(corners.size());
        m.triangle_count = m.vertex_count / 3;
        m.positions = &corners[0].x;
        m.corner_vertex = vertex.data();
        const float* layers[1] = {uv.empty() ? nullptr : &uv[0].x};
        m.uv_layer_count = uv.empty() ? 0 : 1;
        m.uv_layers = layers;
        ajar_instance_desc d{};
        d.mesh = builder_.add_mesh(m);
        d.transform[0] = d.transform[5] = d.transform[10] = 1.0;
        d.material_count = 1;
        d.materials = &material;
        d.surface = uv.empty() ? AJAR_SURFACE_OCCLUDER : AJAR_SURFACE_LIGHTMAP;
        d.visibility = AJAR_VISIBLE_GATHER | AJAR_VISIBLE_SHADOW;
        d.page = page;
        d.element = element;
        d.light_set = AJAR_NONE;
        d.uv_scale[0] = d.uv_scale[1] = 1.0f;
        return builder_.add_instance(d);
    }

    /// A lamp at p that shines along -z.
    ajar_light_desc lamp(uint32_t type, const Vec3& p, float watts) const {
        ajar_light_desc d{};
        d.type = type;
        d.role = AJAR_ROLE_STATIC;
        d.transform[0] = d.transform[5] = d.transform[10] = 1.0;
        for (int i = 0; i < 3; ++i) d.transform[4 * i + 3] = p[i], d.color[i] = 1.0f;
        d.energy = watts;
        d.size_x = d.size_y = 1.0f;
        d.spread = d.spot_angle = kPi;
        d.casts_shadow = 1;
        d.light_set = AJAR_NONE;
        return d;
    }
    uint32_t light(const ajar_light_desc& d) { return builder_.add_light(d); }

    /// Image sky: width * height luminances, bottom row first, times a colour.
    void sky(uint32_t width, uint32_t height, const std::vector<float>& grey, const Vec3& color = Vec3(1.0f)) {
        ajar_sky_desc d{};
        d.type = AJAR_SKY_EQUIRECT;
        d.texture = image(width, height, grey);
        for (int i = 0; i < 3; ++i) d.color[i] = color[i];
        builder_.set_sky(d);
    }

    /// Freezes the scene, which lives as long as the kit.
    const Snapshot& commit() {
        builder_.commit();
        return *builder_.snapshot();
    }

private:
    uint32_t image(uint32_t width, uint32_t height, const std::vector<float>& grey) {
        std::vector<float> rgba;
        for (const float v : grey) rgba.insert(rgba.end(), {v, v, v, 1.0f});
        ajar_texture_desc t{};
        t.width = width;
        t.height = height;
        t.texel = AJAR_TEXEL_F32;
        t.texels = rgba.data();
        t.texel_bytes = rgba.size() * sizeof(float);
        return builder_.add_texture(t);
    }
    static ajar_input input(const Vec3& value) {
        ajar_input in{};
        for (int i = 0; i < 3; ++i) in.value[i] = value[i];
        in.texture = in.color_layer = AJAR_NONE;
        in.uv_transform[0] = in.uv_transform[4] = 1.0f;
        return in;
    }
    static ajar_closure closure(uint32_t type, const Vec3& color) {
        ajar_closure c{};
        c.type = type;
        c.color = input(color);
        c.weight_a = c.weight_b = c.strength = input(Vec3(1.0f));
        c.metallic = c.roughness = input(Vec3(0.0f));
        return c;
    }

    SnapshotBuilder builder_{"test"};
};

/// The two triangles of a parallelogram, counterclockwise from the side that its normal x cross y
/// points to.
inline std::vector<Vec3> parallelogram(const Vec3& p, const Vec3& x, const Vec3& y) {
    return {p, p + x, p + x + y, p, p + x + y, p + y};
}
inline std::vector<Vec2> parallelogram_uv(const Vec2& p, const Vec2& x, const Vec2& y) {
    return {p, p + x, p + x + y, p, p + x + y, p + y};
}

} // namespace ajar
