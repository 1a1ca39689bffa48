// SPDX-License-Identifier: GPL-3.0-or-later
#include "stage.h"

#include <cmath>

namespace kit {

uint32_t Stage::object(MeshData mesh, uint32_t material, uint32_t page_size, const char* name) {
    for (Float3& p : mesh.positions)
        for (float& c : p) c *= variant_.scale;
    const uint32_t page = page_size == 0 ? AJAR_NONE : scene.page(page_size, page_size);
    scene.instance(scene.mesh(mesh), material, page, name, at({0, 0, 0}).data());
    return page;
}

uint32_t Stage::emitter(Float3 radiance) {
    for (float& c : radiance) c = static_cast<float>(c * variant_.light);
    return scene.emitter(radiance);
}

ajar_light_desc Stage::lamp(uint32_t type, double energy) const {
    ajar_light_desc d;
    ajar_light_desc_init(&d);
    d.name = "lamp";
    d.type = type;
    d.role = AJAR_ROLE_STATIC;
    d.energy = static_cast<float>(energy * variant_.light);
    return d;
}

std::array<double, 12> Stage::at(Float3 p) const {
    const auto moved = [&](float c) { return double(c) * variant_.scale + variant_.away; };
    return translation(moved(p[0]), moved(p[1]), moved(p[2]));
}

void Stage::point(Float3 position, double watts, float radius) {
    ajar_light_desc d = lamp(AJAR_LIGHT_POINT, watts * variant_.scale * variant_.scale);
    d.radius = radius * variant_.scale;
    scene.light(d, at(position).data());
}

void Stage::spot(Float3 position, double watts, float angle) {
    ajar_light_desc d = lamp(AJAR_LIGHT_SPOT, watts * variant_.scale * variant_.scale);
    d.spot_angle = angle;
    d.spot_blend = 0.0f;
    scene.light(d, at(position).data());
}

void Stage::sun(double elevation, double strength) {
    // A lamp shines along -z of its matrix.
    const double s = std::sin(elevation), c = std::cos(elevation);
    scene.light(lamp(AJAR_LIGHT_SUN, strength), std::array<double, 12>{s, 0, c, 0, 0, 1, 0, 0, -c, 0, s, 9}.data());
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

Layer Stage::term(const Bake& bake, uint32_t index, uint32_t size, uint32_t page) const {
    return divided(bake.term(index, size, size, page));
}

ajar_settings Stage::settings(uint32_t bounces, uint32_t samples) const {
    ajar_settings s = kit::settings(bounces, samples);
    s.threads = variant_.threads;
    return s;
}

} // namespace kit
