// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/snapshot.h"

namespace ajar {

Effect bookkeeping_effect(const std::vector<Element>& elements) {
    const auto has = [&](ElementKind kind) {
        return std::any_of(elements.begin(), elements.end(), [&](const Element& e) { return e.kind == kind; });
    };
    return has(ElementKind::light_set) ? Effect::light_sets : has(ElementKind::door) ? Effect::doors : Effect::toggles;
}

uint32_t Snapshot::ray_mask(const Triangle& t) const {
    const uint32_t visibility = instances[t.instance].visibility;
    const bool is_switch = instances[t.instance].element != kNoElement;
    const uint32_t fixed = materials[t.material].transmits ? kMaskShadowTransmissive : kMaskShadowOpaque;
    const uint32_t shadow = is_switch ? kMaskShadowSwitch : fixed, gather = is_switch ? kMaskGatherSwitch : kMaskGather;
    return (visibility & AJAR_VISIBLE_GATHER ? gather : 0u) | (visibility & AJAR_VISIBLE_SHADOW ? shadow : 0u);
}

bool Snapshot::has_switches() const {
    return std::any_of(instances.begin(), instances.end(), [](const Instance& i) { return i.element != kNoElement; });
}

Vec3 Snapshot::position(uint32_t triangle, float u, float v) const {
    const Triangle& t = triangles[triangle];
    const Vec3 a = positions[t.vertex[0]];
    return a + (positions[t.vertex[1]] - a) * u + (positions[t.vertex[2]] - a) * v;
}

Vec3 Snapshot::geometric_normal(uint32_t triangle) const {
    const Triangle& t = triangles[triangle];
    const DVec3 a(positions[t.vertex[0]]), b(positions[t.vertex[1]]), c(positions[t.vertex[2]]);
    const DVec3 n = glm::cross(b - a, c - a);
    const double length = glm::length(n);
    return length > 0.0 ? Vec3(n * ((t.mirrored ? -1.0 : 1.0) / length)) : Vec3(0.0f, 0.0f, 1.0f);
}

float Snapshot::area(uint32_t triangle) const {
    const Triangle& t = triangles[triangle];
    const DVec3 a(positions[t.vertex[0]]), b(positions[t.vertex[1]]), c(positions[t.vertex[2]]);
    return static_cast<float>(0.5 * glm::length(glm::cross(b - a, c - a)));
}

Vec3 Snapshot::corner_normal(uint32_t triangle, int corner) const {
    const Triangle& t = triangles[triangle];
    const Instance& instance = instances[t.instance];
    if (is_flat(triangle)) return geometric_normal(triangle);
    const DVec3 local(meshes[instance.mesh].corner_normals[3 * static_cast<size_t>(t.source) + corner]);
    const DVec3 world = instance.transform.normal(local) * (t.mirrored ? -1.0 : 1.0);
    const double length = glm::length(world);
    return length > 0.0 && std::isfinite(length) ? Vec3(world / length) : geometric_normal(triangle);
}

Vec3 Snapshot::shading_normal(uint32_t triangle, float u, float v) const {
    if (is_flat(triangle)) return geometric_normal(triangle);
    const Vec3 n =
        corner_normal(triangle, 0) * (1.0f - u - v) + corner_normal(triangle, 1) * u + corner_normal(triangle, 2) * v;
    return normalize_or(n, geometric_normal(triangle));
}

Vec2 Snapshot::lightmap_uv(uint32_t triangle, int corner) const {
    const Triangle& t = triangles[triangle];
    const Instance& instance = instances[t.instance];
    const Page& page = pages[instance.page];
    const Vec2 uv =
        meshes[instance.mesh].uv_layers[instance.lightmap_layer][3 * static_cast<size_t>(t.source) + corner];
    // Further out floats no longer tell texels apart, and products of such numbers overflow.
    constexpr float kFarthest = 0x1p24f;
    return glm::clamp((uv * instance.uv_scale + instance.uv_offset) * Vec2(page.width, page.height), -kFarthest,
                      kFarthest);
}

} // namespace ajar
