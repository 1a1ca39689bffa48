// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene_kit.h"

#include <cmath>
#include <stdexcept>

namespace kit {

void check(ajar_result result) {
    if (result != AJAR_OK)
        throw std::runtime_error(std::string(ajar_result_text(result)) + ": " + ajar_error_message() + " (" +
                                 ajar_error_culprit() + ")");
}

std::array<double, 12> translation(double x, double y, double z) { return {1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z}; }

void MeshData::quad(Float3 a, Float3 b, Float3 c, Float3 d, Float2 low, Float2 high) {
    const auto base = static_cast<uint32_t>(positions.size());
    positions.insert(positions.end(), {a, b, c, d});
    const Float2 ua = low, ub = {high[0], low[1]}, uc = high, ud = {low[0], high[1]};
    corners.insert(corners.end(), {base, base + 1, base + 2, base, base + 2, base + 3});
    uv.insert(uv.end(), {ua, ub, uc, ua, uc, ud});
}

MeshData box(Float3 l, Float3 h, bool inside, float m) {
    MeshData mesh;
    const Float3 p[8] = {{l[0], l[1], l[2]}, {h[0], l[1], l[2]}, {h[0], h[1], l[2]}, {l[0], h[1], l[2]},
                         {l[0], l[1], h[2]}, {h[0], l[1], h[2]}, {h[0], h[1], h[2]}, {l[0], h[1], h[2]}};
    // Counterclockwise from inside: floor, ceiling, then the four walls.
    const int faces[6][4] = {{0, 1, 2, 3}, {4, 7, 6, 5}, {0, 4, 5, 1}, {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}};
    for (int f = 0; f < 6; ++f) {
        const float x = static_cast<float>(f % 3) / 3.0f, y = static_cast<float>(f / 3) / 2.0f;
        const Float2 low = {x + m, y + m}, high = {x + 1.0f / 3.0f - m, y + 0.5f - m};
        const int* q = faces[f];
        if (inside)
            mesh.quad(p[q[0]], p[q[1]], p[q[2]], p[q[3]], low, high);
        else
            mesh.quad(p[q[0]], p[q[3]], p[q[2]], p[q[1]], low, high);
    }
    return mesh;
}

MeshData plane(float size, float z, bool up) {
    MeshData mesh;
    const float s = 0.5f * size;
    if (up)
        mesh.quad({-s, -s, z}, {s, -s, z}, {s, s, z}, {-s, s, z}, {0, 0}, {1, 1});
    else
        mesh.quad({-s, s, z}, {s, s, z}, {s, -s, z}, {-s, -s, z}, {0, 0}, {1, 1});
    return mesh;
}

namespace {

Float3 normalized(Float3 p, float radius) {
    const float l = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    return {p[0] / l * radius, p[1] / l * radius, p[2] / l * radius};
}

Float3 middle(Float3 a, Float3 b) { return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2}; }

void subdivide(Float3 a, Float3 b, Float3 c, int n, float radius, std::vector<std::array<Float3, 3>>& out) {
    if (n == 0) {
        out.push_back({a, b, c});
        return;
    }
    const Float3 ab = normalized(middle(a, b), radius), bc = normalized(middle(b, c), radius),
                 ca = normalized(middle(c, a), radius);
    subdivide(a, ab, ca, n - 1, radius, out);
    subdivide(ab, b, bc, n - 1, radius, out);
    subdivide(ca, bc, c, n - 1, radius, out);
    subdivide(ab, bc, ca, n - 1, radius, out);
}

} // namespace

MeshData sliver_strip() {
    MeshData strip;
    float x = -1.0f;
    for (int i = 0; x < 1.0f; ++i) {
        const float next = i % 2 ? std::min(x + 0.19f, 1.0f) : x + 1e-6f;
        strip.quad({x, -1, 0}, {next, -1, 0}, {next, 1, 0}, {x, 1, 0}, {0.5f * (x + 1), 0}, {0.5f * (next + 1), 1});
        x = next;
    }
    return strip;
}

MeshData sphere_inside(float radius, int subdivisions) {
    std::vector<std::array<Float3, 3>> triangles;
    const float r = radius;
    const Float3 x{r, 0, 0}, y{0, r, 0}, z{0, 0, r}, nx{-r, 0, 0}, ny{0, -r, 0}, nz{0, 0, -r};
    const Float3 octants[8][3] = {{x, y, z},  {y, nx, z},  {nx, ny, z},  {ny, x, z},
                                  {y, x, nz}, {nx, y, nz}, {ny, nx, nz}, {x, ny, nz}};
    for (const auto& o : octants) subdivide(o[0], o[1], o[2], subdivisions, radius, triangles);
    MeshData mesh;
    const auto cells = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(triangles.size()))));
    const float step = 1.0f / static_cast<float>(cells), m = 0.2f * step;
    for (size_t i = 0; i < triangles.size(); ++i) {
        const auto base = static_cast<uint32_t>(mesh.positions.size());
        for (const Float3& p : triangles[i]) mesh.positions.push_back(p);
        mesh.corners.insert(mesh.corners.end(), {base, base + 2, base + 1}); // front faces the centre
        const float u = static_cast<float>(static_cast<int>(i) % cells) * step,
                    v = static_cast<float>(static_cast<int>(i) / cells) * step;
        mesh.uv.insert(mesh.uv.end(), {Float2{u + m, v + m}, Float2{u + step - m, v + m}, Float2{u + m, v + step - m}});
    }
    return mesh;
}

Scene::Scene(const char* name) { check(ajar_scene_create(name, &scene_)); }
Scene::~Scene() { ajar_scene_release(&scene_); }

uint32_t Scene::texture(const std::vector<float>& rgba, uint32_t width, uint32_t height) {
    ajar_texture_desc d;
    ajar_texture_desc_init(&d);
    d.name = "texture";
    d.width = width;
    d.height = height;
    d.texel = AJAR_TEXEL_F32;
    d.texels = rgba.data();
    d.texel_bytes = rgba.size() * sizeof(float);
    uint32_t id = 0;
    check(ajar_scene_add_texture(scene_, &d, &id));
    return id;
}

uint32_t Scene::material(const std::vector<ajar_closure>& closures, bool one_sided) {
    ajar_material_desc d;
    ajar_material_desc_init(&d);
    d.name = "material";
    d.closure_count = static_cast<uint32_t>(closures.size());
    d.closures = closures.data();
    d.one_sided = one_sided;
    uint32_t id = 0;
    check(ajar_scene_add_material(scene_, &d, &id));
    return id;
}

namespace {

ajar_closure closure(uint32_t type, Float3 color) {
    ajar_closure c;
    ajar_closure_init(&c);
    c.type = type;
    for (int i = 0; i < 3; ++i) c.color.value[i] = color[i];
    return c;
}

} // namespace

uint32_t Scene::diffuse(Float3 albedo) { return material({closure(AJAR_CLOSURE_DIFFUSE, albedo)}); }

uint32_t Scene::emitter(Float3 radiance, Float3 albedo, bool one_sided) {
    return material({closure(AJAR_CLOSURE_EMISSION, radiance), closure(AJAR_CLOSURE_DIFFUSE, albedo)}, one_sided);
}

uint32_t Scene::page(uint32_t width, uint32_t height) {
    uint32_t id = 0;
    check(ajar_scene_add_page(scene_, width, height, &id));
    return id;
}

uint32_t Scene::mesh(const MeshData& data) {
    ajar_mesh_desc d;
    ajar_mesh_desc_init(&d);
    d.name = "mesh";
    d.vertex_count = static_cast<uint32_t>(data.positions.size());
    d.triangle_count = static_cast<uint32_t>(data.corners.size() / 3);
    d.positions = data.positions.empty() ? nullptr : data.positions[0].data();
    d.corner_vertex = data.corners.data();
    d.corner_normals = data.normals.empty() ? nullptr : data.normals[0].data();
    const float* layers[1] = {data.uv.empty() ? nullptr : data.uv[0].data()};
    d.uv_layer_count = data.uv.empty() ? 0 : 1;
    d.uv_layers = layers;
    uint32_t id = 0;
    check(ajar_scene_add_mesh(scene_, &d, &id));
    return id;
}

uint32_t Scene::instance(uint32_t mesh, uint32_t material, uint32_t page, const std::string& name,
                         const double* transform) {
    ajar_instance_desc d;
    ajar_instance_desc_init(&d);
    d.name = name.c_str();
    d.mesh = mesh;
    for (int i = 0; transform != nullptr && i < 12; ++i) d.transform[i] = transform[i];
    d.material_count = 1;
    d.materials = &material;
    d.element = current_switch;
    d.open_pose = open_pose;
    d.visibility = visibility;
    d.light_set = current_set;
    d.bake_side = bake_side;
    if (page != AJAR_NONE) {
        d.surface = AJAR_SURFACE_LIGHTMAP;
        d.lightmap_layer = 0;
        d.page = page;
    }
    uint32_t id = 0;
    check(ajar_scene_add_instance(scene_, &d, &id));
    return id;
}

uint32_t Scene::light(ajar_light_desc d, const double* transform) {
    for (int i = 0; i < 12; ++i) d.transform[i] = transform[i];
    d.light_set = current_set;
    uint32_t id = 0;
    check(ajar_scene_add_light(scene_, &d, &id));
    return id;
}

uint32_t Scene::point_light(Float3 p, float watts, float radius, bool primary) {
    ajar_light_desc d;
    ajar_light_desc_init(&d);
    d.name = "point";
    d.type = AJAR_LIGHT_POINT;
    d.role = primary ? AJAR_ROLE_PRIMARY : AJAR_ROLE_STATIC;
    d.energy = watts;
    d.radius = radius;
    return light(d, translation(p[0], p[1], p[2]).data());
}

uint32_t Scene::element(uint32_t kind, const std::string& name, bool bounces, float weight) {
    ajar_element_desc d;
    ajar_element_desc_init(&d);
    d.name = name.c_str();
    d.kind = kind;
    d.bounce = bounces;
    d.weight = weight;
    uint32_t id = 0;
    check(ajar_scene_add_element(scene_, &d, &id));
    return id;
}

void Scene::sky(Float3 radiance) {
    ajar_sky_desc d;
    ajar_sky_desc_init(&d);
    d.type = AJAR_SKY_CONSTANT;
    for (int i = 0; i < 3; ++i) d.color[i] = radiance[i];
    check(ajar_scene_set_sky(scene_, &d));
}

void Scene::sky_image(uint32_t texture, Float3 radiance) {
    ajar_sky_desc d;
    ajar_sky_desc_init(&d);
    d.type = AJAR_SKY_EQUIRECT;
    d.texture = texture;
    for (int i = 0; i < 3; ++i) d.color[i] = radiance[i];
    check(ajar_scene_set_sky(scene_, &d));
}

void Scene::commit() { check(ajar_scene_commit(scene_)); }

Bake::Bake(const Scene& scene, const ajar_settings& s) {
    check(ajar_job_start(scene.handle(), &s, &job_));
    const ajar_result result = ajar_job_wait(job_, -1.0);
    if (result == AJAR_OK) return;
    const std::string why = ajar_error_message();
    ajar_job_release(&job_);
    throw std::runtime_error(why);
}

Bake::~Bake() { ajar_job_release(&job_); }

Layer Bake::layer(uint32_t which, uint32_t page) const {
    Layer l;
    check(ajar_job_layer_size(job_, page, which, &l.width, &l.height, &l.channels));
    l.data.resize(size_t{l.width} * l.height * l.channels);
    check(ajar_job_read_layer(job_, page, which, l.data.data(), l.data.size()));
    return l;
}

std::string Bake::report() const {
    uint64_t size = 0;
    check(ajar_job_report(job_, nullptr, &size));
    std::string text(size, 0);
    check(ajar_job_report(job_, text.data(), &size));
    text.pop_back();
    return text;
}

std::vector<ajar_term_info> Bake::terms() const {
    uint32_t count = 0;
    check(ajar_job_term_count(job_, &count));
    std::vector<ajar_term_info> out(count);
    for (uint32_t i = 0; i < count; ++i) {
        ajar_term_info_init(&out[i]);
        check(ajar_job_term(job_, i, &out[i]));
    }
    return out;
}

Layer Bake::term(uint32_t index, uint32_t width, uint32_t height, uint32_t page) const {
    Layer l{width, height, 3, std::vector<float>(size_t{3} * width * height)};
    check(ajar_job_read_term(job_, index, page, l.data.data(), l.data.size()));
    return l;
}

std::vector<ajar_reference_point> trace(const Scene& scene, const ajar_reference_settings& settings) {
    ajar_reference reference = nullptr;
    check(ajar_reference_start(scene.handle(), &settings, &reference));
    std::vector<ajar_reference_point> out(settings.points);
    uint32_t batches = 0;
    ajar_result result = ajar_reference_wait(reference, -1.0);
    if (result == AJAR_OK) result = ajar_reference_read(reference, out.data(), out.size(), &batches);
    const std::string why = ajar_error_message();
    ajar_reference_release(&reference);
    if (result != AJAR_OK) throw std::runtime_error(why);
    return out;
}

ajar_reference_settings reference_settings(uint32_t bounces, uint32_t points, uint32_t batches) {
    ajar_reference_settings s;
    ajar_reference_settings_init(&s);
    s.bounces = bounces;
    s.points = points;
    s.batches = batches;
    s.texel_mean = 1;
    return s;
}

ajar_settings settings(uint32_t bounces, uint32_t samples) {
    ajar_settings s;
    ajar_settings_init(&s);
    s.bounces = bounces;
    s.noise_target = 0.0f;
    s.samples = samples;
    s.bounce_samples = 64;
    s.direct_samples = 64;
    s.positions_per_texel = 16;
    s.stitch_seams = 0;
    return s;
}

} // namespace kit
