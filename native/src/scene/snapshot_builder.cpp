// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/snapshot_builder.h"

#include <cstring>

namespace ajar {

namespace {

constexpr uint32_t kMaxTextureSize = 32768, kMaxPageSize = 16384, kMaxElements = 65000;

void require(bool condition, ajar_result code, const std::string& message, const std::string& culprit) {
    if (!condition) throw Error(code, message, culprit);
}

std::string name_of(const char* name, const char* fallback) { return name != nullptr ? name : fallback; }

/// Floats that are not finite become 0; returns how many.
template <class T>
size_t clean(std::vector<T>& values) {
    size_t bad = 0;
    auto* f = reinterpret_cast<float*>(values.data());
    for (size_t i = 0; i < values.size() * sizeof(T) / sizeof(float); ++i) {
        if (std::isfinite(f[i])) continue;
        f[i] = 0.0f;
        ++bad;
    }
    return bad;
}

template <class T>
std::vector<T> copy_as(const float* source, size_t count) {
    std::vector<T> out(count);
    if (count != 0) std::memcpy(static_cast<void*>(out.data()), source, count * sizeof(T));
    return out;
}

bool is_negative(const float* texel) { return std::min({texel[0], texel[1], texel[2]}) < 0.0f; }

/// Texels of an image with a colour below 0.
size_t negative_texels(const Texture& t) {
    size_t count = 0;
    for (size_t i = 0; i + 3 < t.floats.size(); i += 4) count += is_negative(&t.floats[i]);
    return count;
}

Affine affine_of(const double* m, const std::string& culprit) {
    Affine a;
    for (int i = 0; i < 12; ++i) {
        require(std::isfinite(m[i]), AJAR_ERROR_INPUT, "its transform is not finite; clear or fix its transform",
                culprit);
        a.m[i] = m[i];
    }
    return a;
}

bool may_be_positive(const ajar_input& in) {
    return in.invert != 0 || in.value[0] > 0.0f || in.value[1] > 0.0f || in.value[2] > 0.0f;
}

bool has_weight(const ajar_closure& c) { return may_be_positive(c.weight_a) && may_be_positive(c.weight_b); }

bool closure_emits(const ajar_closure& c) {
    return c.type == AJAR_CLOSURE_EMISSION && has_weight(c) && may_be_positive(c.color) && may_be_positive(c.strength);
}

/// Whether an input's constant, or the image that it is multiplied by, is below 0 somewhere.
bool may_be_negative(const ajar_input& in, const std::vector<Texture>& textures) {
    if (in.invert != 0)
        return in.texture == AJAR_NONE && in.color_layer == AJAR_NONE &&
               std::max({in.value[0], in.value[1], in.value[2]}) > 1.0f;
    if (std::min({in.value[0], in.value[1], in.value[2]}) < 0.0f) return true;
    return in.texture < textures.size() && negative_texels(textures[in.texture]) != 0;
}

bool closure_transmits(const ajar_closure& c) {
    return c.type == AJAR_CLOSURE_TRANSPARENT && has_weight(c) && may_be_positive(c.color);
}

/// W, W/m^2 or W/(m^2 sr), of lamps and skies: some ten thousand samples of it add up within a float. A sun of 3e37 was
/// dark: its sums were infinite and left out.
constexpr float kMostStrength = 1e34f;
constexpr const char* kNegative = "gives negative light, which counts as 0: a package stores no light below 0";

/// World bounds of an instance.
struct Extent {
    const Instance* instance;
    DVec3 low{1e300}, high{-1e300};
    void add(const DVec3& p) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
};

/// The instance that reaches furthest from where most instances are.
const Instance* farthest(const std::vector<Extent>& extents) {
    DVec3 middle;
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<double> centers{0.0}; // of two objects the one that is far from zero is the stray
        for (const Extent& e : extents) centers.push_back(0.5 * e.low[axis] + 0.5 * e.high[axis]);
        std::nth_element(centers.begin(), centers.begin() + static_cast<ptrdiff_t>(centers.size() / 2), centers.end());
        middle[axis] = centers[centers.size() / 2];
    }
    const auto reach = [&](const Extent& e) {
        const DVec3 d = glm::max(middle - e.low, e.high - middle);
        return std::max({d.x, d.y, d.z});
    };
    return std::max_element(extents.begin(), extents.end(),
                            [&](const Extent& a, const Extent& b) { return reach(a) < reach(b); })
        ->instance;
}

size_t clean_input(ajar_input& in) {
    size_t bad = 0;
    for (float& v : in.value)
        if (!std::isfinite(v)) v = 0.0f, ++bad;
    for (float& v : in.uv_transform)
        if (!std::isfinite(v)) v = 0.0f, ++bad;
    return bad;
}

void check_input(const ajar_input& in, const std::string& material, size_t texture_count) {
    require(in.texture == AJAR_NONE || in.texture < texture_count, AJAR_ERROR_ARGUMENT,
            "names a texture that was not added", material);
    require(in.channel <= AJAR_CHANNEL_A, AJAR_ERROR_ARGUMENT, "has an input with an unknown channel", material);
}

} // namespace

SnapshotBuilder::SnapshotBuilder(std::string name) : snapshot_(std::make_shared<Snapshot>()) {
    snapshot_->name = std::move(name);
}

void SnapshotBuilder::warn(const std::string& culprit, const std::string& text) {
    snapshot_->warnings.push_back({culprit, text});
}

uint32_t SnapshotBuilder::add_texture(const ajar_texture_desc& d) {
    const std::string name = name_of(d.name, "image");
    require(d.width > 0 && d.height > 0 && d.width <= kMaxTextureSize && d.height <= kMaxTextureSize,
            AJAR_ERROR_ARGUMENT, "image size is 0 or above 32768", name);
    require(
        d.texels != nullptr && d.texel <= AJAR_TEXEL_F32 && d.color <= AJAR_COLOR_SRGB && d.extend <= AJAR_EXTEND_CLIP,
        AJAR_ERROR_ARGUMENT, "image description is incomplete", name);
    const size_t scalars = size_t{4} * d.width * d.height;
    const size_t bytes = scalars * (d.texel == AJAR_TEXEL_F32 ? sizeof(float) : 1);
    require(d.texel_bytes == bytes, AJAR_ERROR_ARGUMENT, "texel_bytes does not match the image size", name);
    Texture t;
    t.name = name;
    t.width = d.width;
    t.height = d.height;
    t.extend = static_cast<Texture::Extend>(d.extend);
    t.nearest = d.nearest != 0;
    t.srgb = d.color == AJAR_COLOR_SRGB;
    if (d.texel == AJAR_TEXEL_F32) {
        t.floats = copy_as<float>(static_cast<const float*>(d.texels), scalars);
        if (const size_t bad = clean(t.floats))
            warn(name, std::to_string(bad) + " texels are not finite and count as 0");
    } else {
        const auto* b = static_cast<const uint8_t*>(d.texels);
        t.bytes.assign(b, b + scalars);
    }
    snapshot_->textures.push_back(std::move(t));
    return static_cast<uint32_t>(snapshot_->textures.size() - 1);
}

uint32_t SnapshotBuilder::add_material(const ajar_material_desc& d) {
    Material m;
    m.name = name_of(d.name, "material");
    require(d.closure_count <= AJAR_MAX_CLOSURES && (d.closure_count == 0 || d.closures != nullptr),
            AJAR_ERROR_ARGUMENT, "has more closures than AJAR_MAX_CLOSURES, or none given", m.name);
    m.closures.assign(d.closures, d.closures + d.closure_count);
    m.one_sided = d.one_sided != 0;
    size_t bad = 0;
    bool negative = false;
    for (ajar_closure& c : m.closures) {
        require(c.type <= AJAR_CLOSURE_TRANSPARENT, AJAR_ERROR_ARGUMENT, "has a closure of unknown type", m.name);
        for (ajar_input* in : {&c.weight_a, &c.weight_b, &c.color, &c.strength, &c.metallic, &c.roughness})
            bad += clean_input(*in);
        if (!std::isfinite(c.specular)) c.specular = 0.0f, ++bad;
        m.emits |= closure_emits(c);
        negative |= c.type == AJAR_CLOSURE_EMISSION &&
                    (may_be_negative(c.color, snapshot_->textures) || may_be_negative(c.strength, snapshot_->textures));
        m.transmits |= closure_transmits(c);
    }
    if (negative) warn(m.name, kNegative);
    if (bad != 0) warn(m.name, std::to_string(bad) + " material values are not finite and count as 0");
    snapshot_->materials.push_back(std::move(m));
    return static_cast<uint32_t>(snapshot_->materials.size() - 1);
}

uint32_t SnapshotBuilder::add_mesh(const ajar_mesh_desc& d) {
    Mesh m;
    m.name = name_of(d.name, "mesh");
    const size_t corners = size_t{3} * d.triangle_count;
    require(d.triangle_count < (1u << 28), AJAR_ERROR_ARGUMENT, "has too many triangles", m.name);
    require((d.vertex_count == 0 || d.positions != nullptr) && (corners == 0 || d.corner_vertex != nullptr),
            AJAR_ERROR_ARGUMENT, "positions or corner_vertex is missing", m.name);
    require(
        (d.uv_layer_count == 0 || d.uv_layers != nullptr) && (d.color_layer_count == 0 || d.color_layers != nullptr),
        AJAR_ERROR_ARGUMENT, "layer array is missing", m.name);
    m.positions = copy_as<Vec3>(d.positions, d.vertex_count);
    m.corner_vertex.assign(d.corner_vertex, d.corner_vertex + corners);
    for (const uint32_t v : m.corner_vertex)
        require(v < d.vertex_count, AJAR_ERROR_ARGUMENT, "a corner names a vertex that does not exist", m.name);
    if (d.corner_normals != nullptr) m.corner_normals = copy_as<Vec3>(d.corner_normals, corners);
    if (d.triangle_slot != nullptr) m.triangle_slot.assign(d.triangle_slot, d.triangle_slot + d.triangle_count);
    size_t bad = clean(m.corner_normals);
    for (uint32_t i = 0; i < d.uv_layer_count; ++i) {
        require(d.uv_layers[i] != nullptr || corners == 0, AJAR_ERROR_ARGUMENT, "a UV layer is null", m.name);
        bad += clean(m.uv_layers.emplace_back(copy_as<Vec2>(d.uv_layers[i], corners)));
    }
    for (uint32_t i = 0; i < d.color_layer_count; ++i) {
        require(d.color_layers[i] != nullptr || corners == 0, AJAR_ERROR_ARGUMENT, "a colour layer is null", m.name);
        bad += clean(m.color_layers.emplace_back(copy_as<Vec4>(d.color_layers[i], corners)));
    }
    if (bad != 0) warn(m.name, std::to_string(bad) + " normals, UVs or colours are not finite and count as 0");
    snapshot_->meshes.push_back(std::move(m));
    return static_cast<uint32_t>(snapshot_->meshes.size() - 1);
}

uint32_t SnapshotBuilder::add_element(const ajar_element_desc& d) {
    Element e;
    e.name = name_of(d.name, "element");
    require(d.kind <= AJAR_ELEMENT_TOGGLE, AJAR_ERROR_ARGUMENT, "unknown kind of element", e.name);
    require(snapshot_->elements.size() < kMaxElements, AJAR_ERROR_INPUT,
            "the scene has more than 65000 light sets, doors and toggles", e.name);
    e.kind = static_cast<ElementKind>(d.kind);
    require(d.weight >= 0.0f && std::isfinite(d.weight), AJAR_ERROR_INPUT, "its weight is negative or not finite",
            e.name);
    require(!e.is_switch() || d.weight <= 1.0f, AJAR_ERROR_INPUT, "its openness or presence is above 1", e.name);
    e.weight = d.weight;
    e.combines = d.combine != 0;
    e.bounces = d.bounce != 0;
    snapshot_->elements.push_back(std::move(e));
    return static_cast<uint32_t>(snapshot_->elements.size() - 1);
}

void SnapshotBuilder::check_element(uint32_t id, bool light_set, const std::string& culprit) const {
    if (id == AJAR_NONE) return;
    require(id < snapshot_->elements.size(), AJAR_ERROR_ARGUMENT, "names an element that was not added", culprit);
    require(snapshot_->elements[id].is_switch() != light_set, AJAR_ERROR_ARGUMENT,
            light_set ? "its light set is a door or toggle" : "its door or toggle is a light set", culprit);
}

uint32_t SnapshotBuilder::add_instance(const ajar_instance_desc& d) {
    Instance i;
    i.name = name_of(d.name, "object");
    require(d.mesh < snapshot_->meshes.size(), AJAR_ERROR_ARGUMENT, "names a mesh that was not added", i.name);
    require(d.material_count == 0 || d.materials != nullptr, AJAR_ERROR_ARGUMENT, "material list is missing", i.name);
    require(d.surface <= AJAR_SURFACE_OCCLUDER, AJAR_ERROR_ARGUMENT, "unknown kind of surface", i.name);
    require(d.bake_side <= AJAR_SIDE_BACK, AJAR_ERROR_ARGUMENT, "unknown side to bake", i.name);
    i.mesh = d.mesh;
    i.transform = affine_of(d.transform, i.name);
    i.materials.assign(d.materials, d.materials + d.material_count);
    i.lightmapped = d.surface == AJAR_SURFACE_LIGHTMAP;
    i.visibility = d.visibility;
    i.lightmap_layer = d.lightmap_layer;
    i.page = d.page;
    i.uv_scale = {d.uv_scale[0], d.uv_scale[1]};
    i.uv_offset = {d.uv_offset[0], d.uv_offset[1]};
    require(is_finite(Vec3(i.uv_scale, i.uv_offset.x)) && std::isfinite(i.uv_offset.y), AJAR_ERROR_ARGUMENT,
            "lightmap rectangle is not finite", i.name);
    check_element(d.element, false, i.name);
    check_element(d.light_set, true, i.name);
    i.element = d.element;
    i.open_pose = d.open_pose != 0;
    i.light_set = d.light_set;
    i.bake_back = i.lightmapped && d.bake_side == AJAR_SIDE_BACK;
    require(!i.open_pose || (i.element != AJAR_NONE && snapshot_->elements[i.element].kind == ElementKind::door),
            AJAR_ERROR_ARGUMENT, "is the open pose of no door", i.name);
    snapshot_->instances.push_back(std::move(i));
    return static_cast<uint32_t>(snapshot_->instances.size() - 1);
}

uint32_t SnapshotBuilder::add_light(const ajar_light_desc& d) {
    const std::string name = name_of(d.name, "light");
    require(d.type <= AJAR_LIGHT_AREA_ELLIPSE && d.role <= AJAR_ROLE_STATIC, AJAR_ERROR_ARGUMENT,
            "unknown type or role of light", name);
    for (const float v : {d.color[0], d.color[1], d.color[2], d.energy, d.radius, d.spot_angle, d.spot_blend,
                          d.sun_angle, d.size_x, d.size_y, d.spread})
        require(std::isfinite(v), AJAR_ERROR_INPUT,
                "has a value that is not finite; set its power, colour and size again", name);
    check_element(d.light_set, true, name);
    const Vec3 strength = Vec3(d.color[0], d.color[1], d.color[2]) * d.energy;
    require(max_component(glm::abs(strength)) <= kMostStrength, AJAR_ERROR_INPUT,
            "its power is beyond what sums of samples can hold (1e34); lower it", name);
    if (is_negative(&strength.x)) warn(name, kNegative);
    snapshot_->lights.push_back(make_light(d, name, affine_of(d.transform, name)));
    snapshot_->lights.back().light_set = d.light_set;
    return static_cast<uint32_t>(snapshot_->lights.size() - 1);
}

uint32_t SnapshotBuilder::add_page(uint32_t width, uint32_t height) {
    require(width > 0 && height > 0 && width <= kMaxPageSize && height <= kMaxPageSize, AJAR_ERROR_ARGUMENT,
            "page size is 0 or above 16384", "page");
    const uint64_t first = snapshot_->texel_count();
    require(first + uint64_t{width} * height < 0xffffffffull, AJAR_ERROR_INPUT,
            "the pages hold more than 4 billion texels; lower the texel density", "page");
    snapshot_->pages.push_back({width, height, first});
    return static_cast<uint32_t>(snapshot_->pages.size() - 1);
}

void SnapshotBuilder::set_sky(const ajar_sky_desc& d) {
    require(d.type <= AJAR_SKY_EQUIRECT, AJAR_ERROR_ARGUMENT, "unknown type of sky", "world");
    Sky sky;
    sky.present = d.type != AJAR_SKY_NONE;
    sky.color = glm::max(Vec3(d.color[0], d.color[1], d.color[2]), Vec3(0.0f));
    require(is_finite(sky.color), AJAR_ERROR_INPUT, "sky colour is not finite; set its colour and strength again",
            "world");
    require(max_component(sky.color) <= kMostStrength, AJAR_ERROR_INPUT,
            "its strength is beyond what sums of samples can hold (1e34); lower it", "world");
    if (sky.present && is_negative(d.color)) warn("world", kNegative);
    if (d.type == AJAR_SKY_EQUIRECT) {
        require(d.texture < snapshot_->textures.size(), AJAR_ERROR_ARGUMENT, "sky names a texture that was not added",
                "world");
        sky.has_image = true;
        sky.image = snapshot_->textures[d.texture];
        if (const size_t count = negative_texels(sky.image))
            warn(sky.image.name, std::to_string(count) +
                                     " texels of the sky's image are below 0 and count as 0; a package stores no light "
                                     "below 0");
        for (float& v : sky.image.floats) v = std::max(v, 0.0f);
    }
    snapshot_->sky = std::move(sky);
}

void SnapshotBuilder::check_materials() const {
    for (const Material& m : snapshot_->materials)
        for (const ajar_closure& c : m.closures)
            for (const ajar_input* in : {&c.weight_a, &c.weight_b, &c.color, &c.strength, &c.metallic, &c.roughness})
                check_input(*in, m.name, snapshot_->textures.size());
}

void SnapshotBuilder::give_fallback_material() {
    const auto fallback = static_cast<uint32_t>(snapshot_->materials.size());
    for (Instance& i : snapshot_->instances) {
        if (snapshot_->meshes[i.mesh].triangle_count() == 0) warn(i.name, "has no faces and is left out");
        if (!i.materials.empty()) continue;
        warn(i.name, "has no material and counts as black; give it a material");
        i.materials.push_back(fallback);
        if (snapshot_->materials.size() == fallback)
            snapshot_->materials.push_back({"(none)", {}, false, false, false});
    }
}

void SnapshotBuilder::check_instance(const Instance& i) const {
    for (const uint32_t m : i.materials)
        require(m < snapshot_->materials.size(), AJAR_ERROR_ARGUMENT, "names a material that was not added", i.name);
    if (!i.lightmapped) return;
    require(i.page < snapshot_->pages.size(), AJAR_ERROR_ARGUMENT, "names a lightmap page that was not added", i.name);
    require(i.lightmap_layer < snapshot_->meshes[i.mesh].uv_layers.size(), AJAR_ERROR_INPUT,
            "has no lightmap UVs; run Prepare UVs or mark it as occluder", i.name);
}

// Floats near 0 are finest, so the scene is moved there in double precision first (algorithms.md 9.8).
void SnapshotBuilder::choose_origin() {
    DVec3 low(1e300), high(-1e300);
    std::vector<Extent> extents;
    for (const Instance& i : snapshot_->instances) {
        Extent e{&i};
        for (const Vec3& p : snapshot_->meshes[i.mesh].positions)
            if (is_finite(p)) e.add(i.transform.point(DVec3(p)));
        if (!(e.low.x <= e.high.x)) continue;
        low = glm::min(low, e.low);
        high = glm::max(high, e.high);
        extents.push_back(e);
    }
    if (extents.empty()) return;
    const double half = 0.5 * std::max({high.x - low.x, high.y - low.y, high.z - low.z});
    require(half * 0x1p-23 < 1e-3, AJAR_ERROR_INPUT,
            "the scene is so wide that millimetres are lost; move this object closer or bake the scene in parts",
            farthest(extents)->name);
    snapshot_->origin = 0.5 * (low + high);
    snapshot_->bounds_min = Vec3(low - snapshot_->origin);
    snapshot_->bounds_max = Vec3(high - snapshot_->origin);
}

void SnapshotBuilder::flatten(uint32_t index) {
    Snapshot& s = *snapshot_;
    const Instance& i = s.instances[index];
    const Mesh& mesh = s.meshes[i.mesh];
    const auto base = static_cast<uint32_t>(s.positions.size());
    require(s.positions.size() + mesh.positions.size() < 0xffffffffull, AJAR_ERROR_INPUT,
            "the scene has more than 4 billion vertices", i.name);
    for (const Vec3& p : mesh.positions) s.positions.push_back(Vec3(i.transform.point(DVec3(p)) - s.origin));
    const bool mirrored = i.transform.determinant() < 0.0;
    size_t broken = 0, flat = 0, culled = 0;
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
        const uint32_t* v = &mesh.corner_vertex[3 * size_t{t}];
        if (!is_finite(mesh.positions[v[0]]) || !is_finite(mesh.positions[v[1]]) || !is_finite(mesh.positions[v[2]])) {
            ++broken;
            continue;
        }
        const uint32_t slot = mesh.triangle_slot.empty() ? 0 : mesh.triangle_slot[t];
        const uint32_t material = i.materials[std::min<size_t>(slot, i.materials.size() - 1)];
        const bool turned = i.bake_back && !s.materials[material].one_sided;
        culled += i.bake_back && !turned;
        s.triangles.push_back({{base + v[0], base + v[1], base + v[2]}, index, t, material, mirrored != turned});
        if (!(s.area(static_cast<uint32_t>(s.triangles.size() - 1)) > 0.0f)) s.triangles.pop_back(), ++flat;
    }
    for (size_t p = base; p < s.positions.size(); ++p)
        if (!is_finite(s.positions[p])) s.positions[p] = Vec3(0.0f);
    if (broken != 0)
        warn(i.name, std::to_string(broken) +
                         " triangles have a vertex that is not finite and are left out; fix or delete those vertices");
    if (culled != 0)
        warn(i.name, "has its back baked, but " + std::to_string(culled) +
                         " triangles have materials with backface culling, which show no back; their front is baked. "
                         "Turn Backface Culling off, or flip the normals");
    if (flat != 0) warn(i.name, std::to_string(flat) + " triangles have no area and are left out");
}

// Rays of different purposes see different groups; contiguous groups spare a lookup per hit.
void SnapshotBuilder::group_triangles() {
    Snapshot& s = *snapshot_;
    const auto key = [&](const Triangle& t) { return s.ray_mask(t); };
    std::stable_sort(s.triangles.begin(), s.triangles.end(),
                     [&](const Triangle& a, const Triangle& b) { return key(a) < key(b); });
}

void SnapshotBuilder::commit() {
    require(!committed_, AJAR_ERROR_STATE, "the scene is committed already", snapshot_->name);
    check_materials();
    for (const Instance& i : snapshot_->instances) check_instance(i);
    choose_origin();
    give_fallback_material();
    for (uint32_t i = 0; i < snapshot_->instances.size(); ++i) flatten(i);
    group_triangles();
    for (Light& l : snapshot_->lights) l.move(-snapshot_->origin);
    committed_ = true;
}

} // namespace ajar
