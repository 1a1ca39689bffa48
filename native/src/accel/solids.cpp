// SPDX-License-Identifier: GPL-3.0-or-later
#include "accel/solids.h"

#include <algorithm>

#include "base/hash.h"
#include "scene/mesh_patch.h"

namespace ajar {

namespace {

constexpr size_t kLeastPoints = 6, kMostPoints = 256; ///< tried of each emissive instance, one per triangle between
constexpr int kMaxHits = 64;                          ///< of one way; what lies behind more surfaces is not looked for
/// Ways from a source, along no axis that walls are built along.
const Vec3 kWays[] = {{0.31f, 0.17f, 0.935f}, {-0.62f, 0.53f, 0.58f}, {0.41f, -0.84f, -0.356f}};

struct Finder {
    const Snapshot& scene;
    const Tracer& tracer;
    std::vector<Behind> behind;  ///< per instance: solid until light is found
    std::vector<uint8_t> inward; ///< its normals point into it
    std::vector<Vec3> low, high; ///< bounds

    Finder(const Snapshot& s, const Tracer& t)
        : scene(s),
          tracer(t),
          behind(s.instances.size()),
          inward(s.instances.size()),
          low(s.instances.size(), Vec3(std::numeric_limits<float>::infinity())),
          high(s.instances.size(), Vec3(-std::numeric_limits<float>::infinity())) {
        std::vector<uint8_t> closed;
        for (const Mesh& m : s.meshes) closed.push_back(find_patches(m).closed);
        for (size_t i = 0; i < behind.size(); ++i)
            behind[i] = closed[s.instances[i].mesh] != 0 ? Behind::solid : Behind::open;
        std::vector<double> volume(behind.size(), 0.0); // six times it, signed (divergence theorem)
        for (const Triangle& t : s.triangles) {
            const Vec3 a = s.positions[t.vertex[0]], b = s.positions[t.vertex[1]], c = s.positions[t.vertex[2]];
            if (s.materials[t.material].transmits) behind[t.instance] = Behind::open;
            volume[t.instance] += (t.mirrored ? -1.0 : 1.0) * glm::dot(DVec3(a), glm::cross(DVec3(b), DVec3(c)));
            low[t.instance] = glm::min(low[t.instance], glm::min(a, glm::min(b, c)));
            high[t.instance] = glm::max(high[t.instance], glm::max(a, glm::max(b, c)));
        }
        for (size_t i = 0; i < inward.size(); ++i) inward[i] = volume[i] < 0.0;
    }

    bool any() const {
        return std::any_of(behind.begin(), behind.end(), [](Behind b) { return b == Behind::solid; });
    }

    void shine_behind(size_t instance) {
        if (behind[instance] == Behind::solid) behind[instance] = Behind::room;
    }

    /// Light from infinitely far falls on the backs of a room whose normals point into it.
    void light_from_far() {
        for (size_t i = 0; i < behind.size(); ++i)
            if (inward[i] != 0) shine_behind(i);
    }

    void light_from(const Vec3& p) {
        for (size_t i = 0; i < behind.size(); ++i)
            if (inward[i] != 0 && is_apart(p, i)) shine_behind(i);
        for (const Vec3& w : kWays) follow({p, glm::normalize(w)});
    }

    bool is_apart(const Vec3& p, size_t i) const {
        return glm::any(glm::lessThan(p, low[i])) || glm::any(glm::greaterThan(p, high[i]));
    }

    /// A mesh whose back comes first on the way is behind its surface here.
    void follow(Ray ray) {
        std::vector<uint32_t> met;
        for (int i = 0; i < kMaxHits; ++i) {
            const Hit hit = tracer.intersect(ray, kMaskGatherAll);
            if (hit.triangle == kMiss) return;
            ray.tnear = hit.t * (1.0f + 0x1p-21f) + 1e-20f; // past the hit, also one at the start itself
            const uint32_t instance = scene.triangles[hit.triangle].instance;
            if (std::find(met.begin(), met.end(), instance) != met.end()) continue;
            met.push_back(instance);
            if (hit.back) shine_behind(instance);
        }
    }

    void light_from_lamp(const Light& l) {
        if (l.dark()) return;
        if (l.type == Light::Type::sun) return light_from_far();
        for (const Vec2& u : {Vec2(0.0f), Vec2(0.4f), Vec2(-0.4f)})
            light_from(l.position + l.edge_x * u.x + l.edge_y * u.y);
    }

    void light_from_surfaces() {
        std::vector<std::vector<uint32_t>> emissive(scene.instances.size());
        for (uint32_t t = 0; t < scene.triangles.size(); ++t)
            if (scene.materials[scene.triangles[t].material].emits) emissive[scene.triangles[t].instance].push_back(t);
        for (uint32_t i = 0; i < emissive.size(); ++i) {
            if (emissive[i].empty()) continue;
            shine_behind(i); // its backs glow
            const size_t count = std::clamp(emissive[i].size(), kLeastPoints, kMostPoints);
            for (size_t k = 0; k < count; ++k) {
                const uint32_t t = emissive[i][k * emissive[i].size() / count],
                               h = hash_combine(i, static_cast<uint32_t>(k));
                const float r = std::sqrt(unit_float(h));
                light_from(scene.position(t, 1.0f - r, r * unit_float(hash32(h))));
            }
        }
    }
};

} // namespace

std::vector<Behind> find_solids(const Snapshot& scene, const Tracer& tracer) {
    Finder f(scene, tracer);
    if (!f.any()) return f.behind;
    if (scene.sky.lit()) f.light_from_far();
    for (const Light& l : scene.lights) f.light_from_lamp(l);
    f.light_from_surfaces();
    return f.behind;
}

} // namespace ajar
