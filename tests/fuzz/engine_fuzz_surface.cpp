// SPDX-License-Identifier: GPL-3.0-or-later
// Textures, materials and meshes.
#include "engine_fuzz.h"
#include "scene_kit.h"

namespace {

kit::MeshData shape(uint32_t kind) {
    switch (kind) {
        case 0:
            return kit::box({-2, -2, -1}, {2, 2, 2}, true);
        case 1:
            return kit::box({-0.5f, -0.5f, -1.0f}, {0.5f, 0.5f, -0.5f}, false);
        case 2:
            return kit::plane(2.0f, 0.5f, false);
        default:
            return kit::sphere_inside(2.5f, 1);
    }
}

} // namespace

void EngineFuzz::add_texture(ajar_scene scene) {
    ajar_texture_desc d;
    ajar_texture_desc_init(&d);
    d.struct_size = size_of(sizeof(d));
    d.name = name();
    d.width = mostly(1 + pick(8));
    d.height = mostly(1 + pick(8));
    d.texel = mostly(pick(2));
    d.color = mostly(pick(2));
    d.extend = mostly(pick(3));
    d.nearest = pick(2);
    d.texels = maybe(numbers(256));
    d.texel_bytes = uint64_t{4} * d.width * d.height * (d.texel == AJAR_TEXEL_F32 ? 4 : 1);
    if (d.width > 8 || d.height > 8 || chance(0.03)) d.texel_bytes = pick(256);
    uint32_t id;
    note(ajar_scene_add_texture(scene, maybe(&d), maybe(&id)));
}

ajar_input EngineFuzz::input() {
    ajar_input in;
    ajar_input_init(&in);
    for (float& v : in.value) v = chance(0.8) ? static_cast<float>(pick(256)) / 255.0f : scalar();
    if (chance(0.4)) in.texture = pick(3);
    if (chance(0.2)) in.color_layer = pick(3);
    in.channel = mostly(pick(5), 0.97);
    in.uv_layer = mostly(0, 0.9);
    in.invert = pick(2);
    if (chance(0.2))
        for (float& v : in.uv_transform) v = scalar();
    return in;
}

void EngineFuzz::add_material(ajar_scene scene) {
    ajar_closure closures[AJAR_MAX_CLOSURES];
    ajar_material_desc d;
    ajar_material_desc_init(&d);
    d.struct_size = size_of(sizeof(d));
    d.name = name();
    const uint32_t used = 1 + pick(4);
    for (ajar_closure& c : closures) ajar_closure_init(&c);
    for (uint32_t i = 0; i < used; ++i) {
        ajar_closure& c = closures[i];
        c.type = mostly(pick(4), 0.97);
        for (ajar_input* in : {&c.weight_a, &c.weight_b, &c.color, &c.strength, &c.metallic, &c.roughness})
            if (chance(0.3)) *in = input();
        if (chance(0.3)) c.specular = scalar();
    }
    d.closure_count = chance(0.95) ? used : chance(0.5) ? AJAR_MAX_CLOSURES : 9 + integer() % 0x7fffffffu;
    d.closures = maybe(closures);
    d.one_sided = pick(2);
    uint32_t id;
    note(ajar_scene_add_material(scene, maybe(&d), maybe(&id)));
}

void EngineFuzz::add_mesh(ajar_scene scene) {
    ajar_mesh_desc d;
    ajar_mesh_desc_init(&d);
    d.struct_size = size_of(sizeof(d));
    d.name = name();
    if (chance(0.7))
        add_shape(scene, d);
    else
        add_soup(scene, d);
}

void EngineFuzz::add_soup(ajar_scene scene, ajar_mesh_desc& d) {
    const float* uv_layers[2] = {maybe(unit_numbers(120)), maybe(numbers(120))};
    const float* color_layers[1] = {maybe(unit_numbers(240))};
    d.vertex_count = 8 + pick(32);
    d.triangle_count = pick(20);
    d.positions = maybe(numbers(120));
    d.corner_vertex = maybe(indices(60));
    if (chance(0.3)) d.corner_normals = numbers(180);
    if (chance(0.3)) d.triangle_slot = indices(20);
    d.uv_layer_count = pick(3);
    d.uv_layers = maybe(uv_layers);
    d.color_layer_count = pick(2);
    d.color_layers = maybe(color_layers);
    uint32_t id;
    note(ajar_scene_add_mesh(scene, maybe(&d), maybe(&id)));
}

void EngineFuzz::add_shape(ajar_scene scene, ajar_mesh_desc& d) {
    kit::MeshData m = shape(pick(4));
    for (uint32_t i = chance(0.7) ? 0 : 1 + pick(4); i != 0; --i) {
        m.positions[pick(256) % m.positions.size()][pick(3)] = scalar();
        m.uv[pick(256) % m.uv.size()][pick(2)] = scalar();
    }
    const float* layers[2] = {m.uv[0].data(), unit_numbers(2 * m.uv.size())};
    const float* colors[1] = {unit_numbers(4 * m.corners.size())};
    d.vertex_count = static_cast<uint32_t>(m.positions.size());
    d.triangle_count = static_cast<uint32_t>(m.corners.size() / 3);
    d.positions = m.positions[0].data();
    d.corner_vertex = m.corners.data();
    if (chance(0.2)) d.corner_normals = numbers(3 * m.corners.size());
    if (chance(0.2)) d.triangle_slot = indices(d.triangle_count);
    d.uv_layer_count = 1 + pick(2);
    d.uv_layers = layers;
    d.color_layer_count = pick(2);
    d.color_layers = colors;
    uint32_t id;
    note(ajar_scene_add_mesh(scene, &d, maybe(&id)));
}
