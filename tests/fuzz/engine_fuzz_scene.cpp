// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes with all that is in them.
#include "engine_fuzz.h"

void EngineFuzz::create_scene() {
    ajar_scene created = nullptr;
    const ajar_result result = ajar_scene_create(name(), maybe(&created));
    keep(scenes_, created, result);
}

void EngineFuzz::add_element(ajar_scene scene, uint32_t kind) {
    ajar_element_desc d;
    ajar_element_desc_init(&d);
    d.struct_size = size_of(sizeof(d));
    d.name = name();
    d.kind = mostly(kind, 0.97);
    d.weight = chance(0.7) ? 1.0f - static_cast<float>(pick(5)) / 4.0f : scalar();
    d.combine = 1 - pick(2);
    d.bounce = 1 - pick(2);
    uint32_t id;
    note(ajar_scene_add_element(scene, maybe(&d), maybe(&id)));
}

void EngineFuzz::add_instance(ajar_scene scene) {
    ajar_instance_desc d;
    ajar_instance_desc_init(&d);
    d.struct_size = size_of(sizeof(d));
    d.name = name();
    d.mesh = mostly(pick(3), 0.97);
    transform(d.transform);
    const uint32_t materials[3] = {pick(2), pick(2), mostly(0, 0.97)};
    d.material_count = (1 + pick(4)) % 4;
    d.materials = maybe(materials);
    d.surface = mostly(pick(2), 0.97);
    if (chance(0.2)) d.visibility = integer();
    d.lightmap_layer = mostly(chance(0.9) ? 0 : 1, 0.97);
    d.page = mostly(chance(0.9) ? 0 : 1, 0.97);
    if (chance(0.2)) d.uv_scale[pick(2)] = scalar();
    if (chance(0.2)) d.uv_offset[pick(2)] = scalar();
    // The elements of room(): a light set, a door, a toggle.
    if (chance(0.4)) d.element = mostly(1 + pick(2), 0.9);
    d.open_pose = chance(0.2);
    if (chance(0.3)) d.light_set = mostly(0, 0.9);
    if (chance(0.3)) d.bake_side = mostly(1, 0.9);
    uint32_t id;
    note(ajar_scene_add_instance(scene, maybe(&d), maybe(&id)));
}

void EngineFuzz::add_light(ajar_scene scene) {
    ajar_light_desc d;
    ajar_light_desc_init(&d);
    d.struct_size = size_of(sizeof(d));
    d.name = name();
    d.type = mostly(pick(5), 0.97);
    d.role = mostly(1 - pick(2), 0.97);
    transform(d.transform);
    for (float* v : {&d.color[0], &d.energy, &d.radius, &d.spot_angle, &d.spot_blend, &d.sun_angle, &d.size_x,
                     &d.size_y, &d.spread})
        if (chance(0.2)) *v = scalar();
    d.casts_shadow = 1 - pick(2);
    if (chance(0.4)) d.light_set = mostly(0, 0.9);
    uint32_t id;
    note(ajar_scene_add_light(scene, maybe(&d), maybe(&id)));
}

void EngineFuzz::add_page(ajar_scene scene) {
    const bool tiles = chance(0.1); // more than one
    const uint32_t width = cheap(tiles ? 17 + pick(4) : 10 - pick(10)), height = cheap(10 - pick(10));
    uint32_t id;
    note(ajar_scene_add_page(scene, width, height, maybe(&id)));
}

void EngineFuzz::set_sky(ajar_scene scene) {
    ajar_sky_desc d;
    ajar_sky_desc_init(&d);
    d.struct_size = size_of(sizeof(d));
    d.type = mostly(pick(3), 0.97);
    for (float& c : d.color) c = chance(0.8) ? static_cast<float>(pick(256)) / 64.0f : scalar();
    d.texture = mostly(0, 0.9);
    note(ajar_scene_set_sky(scene, maybe(&d)));
}

void EngineFuzz::read_scene(ajar_scene scene) {
    uint32_t count = 0;
    char text[16], culprit[16];
    note(ajar_scene_warning_count(scene, maybe(&count)));
    const uint32_t index = count != 0 ? mostly(pick(256) % count) : integer();
    note(ajar_scene_warning(scene, index, maybe(text), pick(17), maybe(culprit), pick(17)));
}

void EngineFuzz::add_part(ajar_scene scene) {
    switch (pick(8)) {
        case 0:
            return add_instance(scene);
        case 1:
            return add_mesh(scene);
        case 2:
            return add_light(scene);
        case 3:
            return add_material(scene);
        case 4:
            return add_texture(scene);
        case 5:
            return add_element(scene, pick(3));
        case 6:
            return add_page(scene);
        default:
            return set_sky(scene);
    }
}

/// A scene that can mostly be baked, which a row of single calls hardly ever makes; and then its bake.
void EngineFuzz::room() {
    create_scene();
    const ajar_scene scene = scenes_.empty() ? nullptr : scenes_.back();
    add_page(scene);
    if (chance(0.4)) add_texture(scene);
    if (chance(0.6))
        for (const uint32_t kind : {0u, 1u, 2u}) // AJAR_ELEMENT_*
            add_element(scene, kind);
    for (uint32_t i = 0; i < 2; ++i) add_material(scene);
    for (uint32_t i = 1 + pick(3); i != 0; --i) add_mesh(scene);
    for (uint32_t i = 1 + pick(4); i != 0; --i) add_instance(scene);
    for (uint32_t i = (1 + pick(3)) % 3; i != 0; --i) add_light(scene);
    if (chance(0.4)) set_sky(scene);
    if (chance(0.9)) note(ajar_scene_commit(scene));
    if (chance(0.8)) start_job(scene);
    if (chance(0.3)) start_reference(scene);
}

void EngineFuzz::scene_call() {
    const ajar_scene scene = some(scenes_);
    switch (pick(8)) {
        case 0:
            return create_scene();
        case 1:
            if (chance(0.5)) release(scenes_, ajar_scene_release);
            return;
        case 2:
            note(ajar_scene_commit(scene));
            return;
        case 3:
            return read_scene(scene);
        default:
            return add_part(scene);
    }
}
