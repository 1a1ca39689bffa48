// SPDX-License-Identifier: GPL-3.0-or-later
// Initialisers of the public structs; the defaults are part of the ABI.
#include <numbers>

#include "api/guard.h"
#include "pass/noise_plan.h"

using namespace ajar;

namespace {

void identity(double* m) { m[0] = m[5] = m[10] = 1.0; }

} // namespace

extern "C" {

AJAR_API void ajar_texture_desc_init(ajar_texture_desc* d) { init_struct(d); }

AJAR_API void ajar_input_init(ajar_input* in) {
    if (in == nullptr) return;
    std::memset(in, 0, sizeof(*in));
    in->value[0] = in->value[1] = in->value[2] = 1.0f;
    in->texture = in->color_layer = AJAR_NONE;
    in->uv_transform[0] = in->uv_transform[4] = 1.0f;
}

AJAR_API void ajar_closure_init(ajar_closure* c) {
    if (c == nullptr) return;
    std::memset(c, 0, sizeof(*c));
    for (ajar_input* in : {&c->weight_a, &c->weight_b, &c->color, &c->strength, &c->metallic, &c->roughness})
        ajar_input_init(in);
    c->metallic.value[0] = c->metallic.value[1] = c->metallic.value[2] = 0.0f;
    c->roughness.value[0] = c->roughness.value[1] = c->roughness.value[2] = 0.5f;
    c->specular = 0.5f;
}

AJAR_API void ajar_material_desc_init(ajar_material_desc* d) { init_struct(d); }
AJAR_API void ajar_mesh_desc_init(ajar_mesh_desc* d) { init_struct(d); }

AJAR_API void ajar_element_desc_init(ajar_element_desc* d) {
    if (d == nullptr) return;
    init_struct(d);
    d->weight = 1.0f;
    d->combine = d->bounce = 1;
}

AJAR_API void ajar_instance_desc_init(ajar_instance_desc* d) {
    if (d == nullptr) return;
    init_struct(d);
    identity(d->transform);
    d->surface = AJAR_SURFACE_OCCLUDER;
    d->visibility = AJAR_VISIBLE_GATHER | AJAR_VISIBLE_SHADOW;
    d->lightmap_layer = d->page = AJAR_NONE;
    d->uv_scale[0] = d->uv_scale[1] = 1.0f;
    d->element = d->light_set = AJAR_NONE;
}

AJAR_API void ajar_light_desc_init(ajar_light_desc* d) {
    if (d == nullptr) return;
    init_struct(d);
    identity(d->transform);
    d->color[0] = d->color[1] = d->color[2] = 1.0f;
    d->energy = d->size_x = d->size_y = 1.0f;
    d->spot_angle = d->spread = std::numbers::pi_v<float>;
    d->casts_shadow = 1;
    d->light_set = AJAR_NONE;
}

AJAR_API void ajar_sky_desc_init(ajar_sky_desc* d) {
    if (d == nullptr) return;
    init_struct(d);
    d->texture = AJAR_NONE;
}

AJAR_API void ajar_settings_init(ajar_settings* s) {
    if (s == nullptr) return;
    init_struct(s);
    s->bounces = 6;
    s->noise_target = kPreviewNoise;
    s->samples = 1024;
    s->bounce_samples = 64;
    s->direct_samples = 64;
    s->positions_per_texel = 4;
    s->stitch_seams = 1;
    s->combinations = AJAR_COMBINATIONS_AUTO;
    s->term_threshold = 0.01f;
    s->door_rays = 0.25f;
}

AJAR_API void ajar_reference_settings_init(ajar_reference_settings* s) {
    if (s == nullptr) return;
    init_struct(s);
    s->points = 1000;
    s->bounces = 6;
    s->batches = 64;
    s->normal[2] = 1.0f;
    s->door_bounces = AJAR_NONE;
}

AJAR_API void ajar_term_info_init(ajar_term_info* t) { init_struct(t); }
AJAR_API void ajar_progress_init(ajar_progress* p) { init_struct(p); }

AJAR_API void ajar_layout_settings_init(ajar_layout_settings* s) {
    if (s == nullptr) return;
    init_struct(s);
    s->texels_per_meter = 8.0f;
    s->atlas_size = 2048;
    s->padding = 2;
    s->chart_angle = std::numbers::pi_v<float> / 6.0f;
}

AJAR_API void ajar_layout_mesh_desc_init(ajar_layout_mesh_desc* d) { init_struct(d); }

} // extern "C"
