// SPDX-License-Identifier: GPL-3.0-or-later
#include "stage.h"

#include <cmath>
#include <utility>

namespace kit {

uint32_t Stage::object(MeshData mesh, uint32_t material, uint32_t page_size, const char* name,
                       const std::array<double, 9>& turned) {
    for (Float3& p : mesh.positions)
        for (float& c : p) c *= variant_.scale;
    const uint32_t page = page_size == 0 ? AJAR_NONE : scene.page(page_size, page_size);
    scene.instance(scene.mesh(mesh), material, page, name, at({0, 0, 0}, turned).data());
    return page;
}

uint32_t Stage::object(MeshData mesh, uint32_t material, uint32_t page_size, const char* name) {
    return object(std::move(mesh), material, page_size, name, kUpright);
}

uint32_t Stage::emitter(Float3 radiance, float albedo) {
    for (float& c : radiance) c = static_cast<float>(c * variant_.light);
    return scene.emitter(radiance, {albedo, albedo, albedo});
}

uint32_t Stage::pane(Float3 transmittance, float albedo, double radiance) {
    std::vector<ajar_closure> closures;
    const auto add = [&](uint32_t type, Float3 color) {
        ajar_closure& c = closures.emplace_back();
        ajar_closure_init(&c);
        c.type = type;
        for (int i = 0; i < 3; ++i) c.color.value[i] = color[i];
    };
    const auto glow = static_cast<float>(radiance * variant_.light);
    add(AJAR_CLOSURE_TRANSPARENT, transmittance);
    if (albedo > 0.0f) add(AJAR_CLOSURE_DIFFUSE, {albedo, albedo, albedo});
    if (glow > 0.0f) add(AJAR_CLOSURE_EMISSION, {glow, glow, glow});
    return scene.material(closures);
}

uint32_t Stage::toggle(const std::string& name, float presence) {
    return scene.current_switch = scene.element(AJAR_ELEMENT_TOGGLE, name, true, presence);
}

uint32_t Stage::door(const std::string& name, float openness) {
    return scene.current_switch = scene.element(AJAR_ELEMENT_DOOR, name, true, openness);
}

uint32_t Stage::set(const std::string& name) { return scene.current_set = scene.element(AJAR_ELEMENT_LIGHT_SET, name); }

ajar_light_desc Stage::lamp(uint32_t type, double energy, uint32_t role) {
    ajar_light_desc d;
    ajar_light_desc_init(&d);
    d.name = "lamp";
    d.type = type;
    d.role = role;
    d.energy = static_cast<float>(energy);
    return d;
}

std::array<double, 12> Stage::at(Float3 p, const std::array<double, 9>& a) const {
    const auto moved = [&](float c) { return double(c) * variant_.scale + variant_.away; };
    return {a[0], a[1], a[2], moved(p[0]), a[3], a[4], a[5], moved(p[1]), a[6], a[7], a[8], moved(p[2])};
}

void Stage::light(ajar_light_desc d, Float3 position, const std::array<double, 9>& axes) {
    const double area = d.type == AJAR_LIGHT_SUN ? 1.0 : double(variant_.scale) * variant_.scale;
    d.energy = static_cast<float>(d.energy * variant_.light * area);
    for (float* size : {&d.radius, &d.size_x, &d.size_y}) *size *= variant_.scale;
    scene.light(d, at(position, axes).data());
}

void Stage::point(Float3 position, double watts, float radius) {
    ajar_light_desc d = lamp(AJAR_LIGHT_POINT, watts);
    d.radius = radius;
    light(d, position);
}

void Stage::spot(Float3 position, double watts, float angle) {
    ajar_light_desc d = lamp(AJAR_LIGHT_SPOT, watts);
    d.spot_angle = angle;
    d.spot_blend = 0.0f;
    light(d, position);
}

void Stage::sun(double elevation, double strength) {
    // A lamp shines along -z of its matrix.
    const double s = std::sin(elevation), c = std::cos(elevation);
    light(lamp(AJAR_LIGHT_SUN, strength), {0, 0, 9}, {s, 0, c, 0, 1, 0, -c, 0, s});
}

void Stage::sky(double radiance) {
    const auto r = static_cast<float>(radiance * variant_.light);
    scene.sky({r, r, r});
}

Layer Stage::divided(Layer layer) const {
    for (float& v : layer.data) v = static_cast<float>(v / variant_.light);
    return layer;
}

Layer Stage::irradiance(const Bake& bake, uint32_t page) const {
    return divided(bake.layer(AJAR_LAYER_IRRADIANCE, page));
}

Layer Stage::state(const Bake& bake, const std::vector<float>& weights, uint32_t size, uint32_t page) const {
    Layer sum = bake.term(0, size, size, page);
    const std::vector<ajar_term_info> terms = bake.terms();
    for (uint32_t t = 1; t < terms.size(); ++t) {
        float factor = 1.0f;
        for (uint32_t i = 0; i < terms[t].element_count; ++i) factor *= weights[terms[t].elements[i]];
        if (factor == 0.0f) continue;
        const Layer light = bake.term(t, size, size, page);
        for (size_t i = 0; i < sum.data.size(); ++i) sum.data[i] += factor * light.data[i];
    }
    return divided(std::move(sum));
}

Layer Stage::term(const Bake& bake, uint32_t index, uint32_t size, uint32_t page) const {
    return divided(bake.term(index, size, size, page));
}

ajar_settings Stage::settings(uint32_t bounces, uint32_t samples) const {
    ajar_settings s = kit::settings(bounces, samples);
    s.threads = variant_.threads;
    return s;
}

} // namespace kit
