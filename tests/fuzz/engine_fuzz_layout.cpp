// SPDX-License-Identifier: GPL-3.0-or-later
// Lightmap UVs.
#include "engine_fuzz.h"
#include "scene_kit.h"

void EngineFuzz::create_layout() {
    ajar_layout_settings s;
    ajar_layout_settings_init(&s);
    s.struct_size = size_of(sizeof(s));
    s.texels_per_meter = chance(0.7) ? 4.0f : scalar();
    s.atlas_size = cheap(128 - pick(120));
    s.padding = mostly(pick(4));
    s.chart_angle = chance(0.7) ? 0.5f : scalar();
    ajar_layout created = nullptr;
    const ajar_result result = ajar_layout_create(maybe(&s), maybe(&created));
    keep(layouts_, created, result);
}

void EngineFuzz::add_layout_soup(ajar_layout layout, ajar_layout_mesh_desc& d) {
    std::vector<uint32_t> start(20), size(20);
    for (uint32_t i = 0; i < 20; ++i) start[i] = 3 * i, size[i] = 3;
    for (uint32_t i = pick(4); i != 0; --i) {
        start[pick(20)] = mostly(pick(60), 0.9);
        size[pick(20)] = mostly(pick(8), 0.9);
    }
    d.vertex_count = 8 + pick(32);
    d.corner_count = 60 - pick(60);
    d.polygon_count = pick(20);
    d.positions = maybe(numbers(120));
    d.corner_vertex = maybe(indices(60));
    d.polygon_start = maybe(start.data());
    d.polygon_size = maybe(size.data());
    if (chance(0.3)) d.corner_uv = unit_numbers(120);
    uint32_t id;
    note(ajar_layout_add_mesh(layout, maybe(&d), maybe(&id)));
}

void EngineFuzz::add_layout_shape(ajar_layout layout, ajar_layout_mesh_desc& d) {
    kit::MeshData m = pick(2) == 0 ? kit::box({-1, -1, -1}, {1, 2, 3}, false) : kit::sphere_inside(2.0f, 1);
    for (uint32_t i = chance(0.6) ? 0 : 1 + pick(4); i != 0; --i) {
        m.positions[pick(256) % m.positions.size()][pick(3)] = scalar();
        m.uv[pick(256) % m.uv.size()][pick(2)] = scalar();
    }
    std::vector<uint32_t> start(m.corners.size() / 3), size(m.corners.size() / 3, 3);
    for (uint32_t i = 0; i < start.size(); ++i) start[i] = 3 * i;
    d.vertex_count = static_cast<uint32_t>(m.positions.size());
    d.corner_count = static_cast<uint32_t>(m.corners.size());
    d.polygon_count = static_cast<uint32_t>(start.size());
    d.positions = m.positions[0].data();
    d.corner_vertex = m.corners.data();
    d.polygon_start = start.data();
    d.polygon_size = size.data();
    if (chance(0.4)) d.corner_uv = m.uv[0].data();
    uint32_t id;
    note(ajar_layout_add_mesh(layout, &d, maybe(&id)));
}

void EngineFuzz::add_layout_mesh(ajar_layout layout) {
    std::vector<uint8_t> sharp(96);
    for (uint32_t i = pick(8); i != 0; --i) sharp[pick(96)] = 1;
    double transforms[36];
    for (int i = 0; i < 3; ++i) transform(transforms + 12 * i);
    ajar_layout_mesh_desc d;
    ajar_layout_mesh_desc_init(&d);
    d.struct_size = size_of(sizeof(d));
    d.name = name();
    if (chance(0.3)) d.corner_edge_sharp = sharp.data();
    d.user_count = (1 + pick(4)) % 4;
    d.user_transforms = maybe(transforms);
    if (chance(0.3)) d.user_texel_scale = unit_numbers(3);
    if (chance(0.6))
        add_layout_shape(layout, d);
    else
        add_layout_soup(layout, d);
}

void EngineFuzz::read_layout(ajar_layout layout) {
    uint32_t count = 0, width, height, page;
    float scale[2], offset[2], density;
    char text[16], culprit[16];
    const uint32_t mesh = mostly(pick(3));
    std::vector<float> uv(chance(0.9) ? 192 : pick(192));
    note(ajar_layout_page_count(layout, maybe(&count)));
    note(ajar_layout_page_size(layout, mostly(pick(2)), maybe(&width), maybe(&height)));
    note(ajar_layout_mesh_uv(layout, mesh, maybe(uv.data()), uv.size()));
    note(ajar_layout_user(layout, mesh, mostly(pick(3)), maybe(&page), maybe(scale), maybe(offset), maybe(&density)));
    note(ajar_layout_warning_count(layout, maybe(&count)));
    note(ajar_layout_warning(layout, mostly(pick(3)), maybe(text), pick(17), maybe(culprit), pick(17)));
}

/// A whole layout: single calls seldom come in this order.
void EngineFuzz::atlas() {
    create_layout();
    const ajar_layout layout = layouts_.empty() ? nullptr : layouts_.back();
    for (uint32_t i = 1 + pick(3); i != 0; --i) add_layout_mesh(layout);
    note(ajar_layout_run(layout));
    read_layout(layout);
}

void EngineFuzz::layout_call() {
    const ajar_layout layout = some(layouts_);
    switch (pick(6)) {
        case 0:
            return create_layout();
        case 1:
            if (chance(0.3)) release(layouts_, ajar_layout_release);
            return;
        case 2:
            note(ajar_layout_run(layout));
            return;
        case 3:
            return read_layout(layout);
        default:
            return add_layout_mesh(layout);
    }
}
