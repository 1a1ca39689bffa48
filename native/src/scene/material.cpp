// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/material.h"

#include <array>

#include "scene/snapshot.h"
#include "scene/uncut_surface.h"

namespace ajar {

namespace {

// Directional-albedo integrals A and B of the split-sum Fresnel, tabulated at roughness 0, .1 .. 1
// (algorithms.md 11.2; at 0 they follow from the mirror: A = 1 - 1/21, B = 1/21).
constexpr std::array<float, 11> kTableA = {0.9524f, 0.952f, 0.951f, 0.941f, 0.914f, 0.864f,
                                           0.790f,  0.699f, 0.598f, 0.498f, 0.406f};
constexpr std::array<float, 11> kTableB = {0.0476f, 0.0471f, 0.0431f, 0.0354f, 0.0265f, 0.0187f,
                                           0.0127f, 0.0086f, 0.0058f, 0.0040f, 0.0028f};

float lookup(const std::array<float, 11>& table, float roughness) {
    const float x = std::clamp(roughness, 0.0f, 1.0f) * 10.0f;
    const int i = std::min(static_cast<int>(x), 9);
    return table[i] + (table[i + 1] - table[i]) * (x - static_cast<float>(i));
}

Vec2 corner_uv(const Mesh& mesh, uint32_t layer, const MeshPoint& at) {
    if (layer >= mesh.uv_layers.size()) return Vec2(0.0f);
    const Vec2* c = &mesh.uv_layers[layer][3 * static_cast<size_t>(at.triangle)];
    return c[0] * (1.0f - at.u - at.v) + c[1] * at.u + c[2] * at.v;
}

Vec4 corner_color(const Mesh& mesh, uint32_t layer, const MeshPoint& at) {
    if (layer >= mesh.color_layers.size()) return Vec4(1.0f);
    const Vec4* c = &mesh.color_layers[layer][3 * static_cast<size_t>(at.triangle)];
    return c[0] * (1.0f - at.u - at.v) + c[1] * at.u + c[2] * at.v;
}

Vec3 pick(const Vec4& v, uint32_t channel) {
    switch (channel) {
        case AJAR_CHANNEL_R:
            return Vec3(v.x);
        case AJAR_CHANNEL_G:
            return Vec3(v.y);
        case AJAR_CHANNEL_B:
            return Vec3(v.z);
        case AJAR_CHANNEL_A:
            return Vec3(v.w);
        default:
            return Vec3(v);
    }
}

Vec2 texture_uv(const Snapshot& scene, const ajar_input& in, const MeshPoint& at) {
    const Vec2 uv = corner_uv(scene.meshes[at.mesh], in.uv_layer, at);
    const float* m = in.uv_transform;
    return {m[0] * uv.x + m[1] * uv.y + m[2], m[3] * uv.x + m[4] * uv.y + m[5]};
}

Vec3 evaluate_varying(const Snapshot& scene, const ajar_input& in, const MeshPoint& at) {
    const Mesh& mesh = scene.meshes[at.mesh];
    Vec3 result(in.value[0], in.value[1], in.value[2]);
    if (in.texture != AJAR_NONE)
        result *= pick(scene.textures[in.texture].sample(texture_uv(scene, in, at)), in.channel);
    if (in.color_layer != AJAR_NONE) result *= pick(corner_color(mesh, in.color_layer, at), in.channel);
    return in.invert != 0 ? Vec3(1.0f) - result : result;
}

/// Most inputs are constants.
inline Vec3 evaluate(const Snapshot& scene, const ajar_input& in, const MeshPoint& at) {
    if (in.texture != AJAR_NONE || in.color_layer != AJAR_NONE) return evaluate_varying(scene, in, at);
    const Vec3 value(in.value[0], in.value[1], in.value[2]);
    return in.invert != 0 ? Vec3(1.0f) - value : value;
}

float weight(const Snapshot& scene, const ajar_closure& c, const MeshPoint& at) {
    const float a = std::clamp(evaluate(scene, c.weight_a, at).x, 0.0f, 1.0f);
    return a == 0.0f ? 0.0f : a * std::clamp(evaluate(scene, c.weight_b, at).x, 0.0f, 1.0f);
}

constexpr float kVertexColorDetail = 8.0f; ///< texels that stand for colours mixed between corners

float detail(const Snapshot& scene, const ajar_input& in, MeshPoint at) {
    const float colors = in.color_layer != AJAR_NONE ? kVertexColorDetail : 0.0f;
    if (in.texture == AJAR_NONE) return colors;
    const Texture& texture = scene.textures[in.texture];
    const auto corner = [&](float u, float v) {
        at.u = u, at.v = v;
        return texture_uv(scene, in, at) * Vec2(texture.width, texture.height);
    };
    const Vec2 a = corner(0.0f, 0.0f), b = corner(1.0f, 0.0f), c = corner(0.0f, 1.0f);
    return std::max({colors, glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
}

Vec3 unit(const Vec3& v) { return glm::clamp(v, Vec3(0.0f), Vec3(1.0f)); }

void add_closure(const Snapshot& scene, const ajar_closure& c, const MeshPoint& at, SurfaceSample& out) {
    const float w = weight(scene, c, at);
    if (w == 0.0f) return;
    const Vec3 color = evaluate(scene, c.color, at);
    switch (c.type) {
        case AJAR_CLOSURE_DIFFUSE:
            out.reflectance += w * unit(color);
            break;
        case AJAR_CLOSURE_PRINCIPLED:
            out.reflectance +=
                w * principled_albedo(unit(color), std::clamp(evaluate(scene, c.metallic, at).x, 0.0f, 1.0f),
                                      evaluate(scene, c.roughness, at).x, c.specular);
            break;
        case AJAR_CLOSURE_EMISSION:
            out.emission += w * glm::max(color * evaluate(scene, c.strength, at).x, Vec3(0.0f));
            break;
        default:
            out.transmittance += w * unit(color);
            break;
    }
}

} // namespace

Vec3 specular_albedo(const Vec3& f0, float roughness) {
    const float a = lookup(kTableA, roughness), b = lookup(kTableB, roughness);
    const float average = a + b;
    return (f0 * a + b) * (Vec3(1.0f) + f0 * ((1.0f - average) / average));
}

Vec3 principled_albedo(const Vec3& base, float metallic, float roughness, float specular) {
    const Vec3 gloss = specular_albedo(Vec3(0.08f * std::max(specular, 0.0f)), roughness);
    const Vec3 dielectric = gloss + base * (Vec3(1.0f) - gloss);
    return glm::mix(dielectric, specular_albedo(base, roughness), metallic);
}

SurfaceSample Material::sample(const Snapshot& scene, const MeshPoint& at) const {
    SurfaceSample out = sample_uncut(*this, scene, at);
    out.reflectance = glm::min(out.reflectance, Vec3(kMaxReflectance));
    return out;
}

SurfaceSample sample_uncut(const Material& material, const Snapshot& scene, const MeshPoint& at) {
    SurfaceSample out;
    for (const ajar_closure& c : material.closures) add_closure(scene, c, at, out);
    out.reflectance = unit(out.reflectance);
    out.transmittance = unit(out.transmittance);
    if (!is_finite(out.emission)) out.emission = Vec3(0.0f);
    return out;
}

float Material::emission_detail(const Snapshot& scene, const MeshPoint& at) const {
    float most = 0.0f;
    for (const ajar_closure& c : closures)
        if (c.type == AJAR_CLOSURE_EMISSION)
            for (const ajar_input* in : {&c.weight_a, &c.weight_b, &c.color, &c.strength})
                most = std::max(most, detail(scene, *in, at));
    return std::isfinite(most) ? most : 0.0f;
}

Vec3 Material::emission(const Snapshot& scene, const MeshPoint& at) const {
    SurfaceSample out;
    for (const ajar_closure& c : closures)
        if (c.type == AJAR_CLOSURE_EMISSION) add_closure(scene, c, at, out);
    return is_finite(out.emission) ? out.emission : Vec3(0.0f);
}

} // namespace ajar
