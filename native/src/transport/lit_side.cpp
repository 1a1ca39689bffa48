// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/lit_side.h"

#include <algorithm>
#include <functional>

#include "base/owen_sobol.h"
#include "sampling/warp.h"
#include "scene/mesh_patch.h"
#include "transport/shadow.h"

namespace ajar {

namespace {

constexpr uint32_t kMostPoints = 48; ///< per patch
constexpr uint32_t kLeastPoints = 6, kLeastFacetPoints = 24;
constexpr float kFacetCosine = 0.7f; ///< of the steepest angle inside a facet
constexpr uint32_t kRays = 8;        ///< per point and side
constexpr uint32_t kLampSamples = 2; ///< per point and side
constexpr int kMostRounds = 4;       ///< a turned wall changes what its neighbours look at
constexpr float kFewLamps = 0.05f;   ///< share of lamp samples: a side that more of them reach is lit
constexpr float kEnclosed = 0.5f;    ///< most rays that may leave the scene from inside a room

/// What one side of a patch sees.
struct View {
    float fronts = 0.0f, backs = 0.0f, misses = 0.0f; ///< shares of its rays
    float below = 0.0f;                               ///< share of its rays that leave the scene downwards
    float lamps = 0.0f;                               ///< share of its points' lamp samples that arrive
    float lit = 0.0f;                                 ///< share of its rays that meet light or lit surfaces
    float reach = 0.0f;                               ///< m, mean length of its rays
};

/// Connected triangles of one instance.
struct Patch {
    std::vector<uint32_t> triangles;
    std::vector<float> running_area;
    bool closed = false;
    bool may_turn = true; ///< has a lightmap, and backs that reflect
    uint32_t instance = 0;
};

struct Finder {
    const Snapshot& scene;
    const Tracer tracer;
    const EmitterSet emitters;
    std::vector<Patch> patches;
    std::vector<uint8_t> turned; ///< per triangle
    uint32_t least_points = kLeastPoints;

    Finder(const Snapshot& s, ThreadPool& pool, Progress& progress)
        : scene(s), tracer(s), emitters(s, pool, progress), turned(s.triangles.size(), 0) {
        collect(-1.0f);
    }

    void collect(float least_cosine) {
        patches.clear();
        std::vector<MeshPatches> of_mesh;
        for (const Mesh& m : scene.meshes) of_mesh.push_back(find_patches(m, least_cosine));
        std::vector<uint32_t> first;
        for (const Instance& i : scene.instances) {
            first.push_back(static_cast<uint32_t>(patches.size()));
            patches.resize(patches.size() + of_mesh[i.mesh].count);
        }
        for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
            const Triangle& triangle = scene.triangles[t];
            const Instance& instance = scene.instances[triangle.instance];
            const Material& material = scene.materials[triangle.material];
            const MeshPatches& mesh = of_mesh[instance.mesh];
            Patch& p = patches[first[triangle.instance] + mesh.patch[triangle.source]];
            p.triangles.push_back(t);
            p.running_area.push_back((p.running_area.empty() ? 0.0f : p.running_area.back()) + scene.area(t));
            p.closed = mesh.closed;
            p.may_turn = p.may_turn && instance.lightmapped && !material.one_sided;
            p.instance = triangle.instance;
        }
    }

    std::vector<uint32_t> patch_of_triangles() const {
        std::vector<uint32_t> out(scene.triangles.size(), 0);
        for (uint32_t i = 0; i < patches.size(); ++i)
            for (const uint32_t t : patches[i].triangles) out[t] = i;
        return out;
    }

    uint32_t point_count(const Patch& p) const {
        return std::clamp(static_cast<uint32_t>(p.triangles.size()), least_points, kMostPoints);
    }

    /// A ray's share in what a side sees. Tinted surfaces say nothing, from either side.
    void look(const Ray& ray, View& view, float weight, uint32_t seed) const {
        const Hit hit = tracer.intersect(ray, kMaskGather); // doors are open, toggles absent
        if (hit.triangle == kMiss) {
            view.misses += weight;
            if (ray.direction.z < 0.0f) view.below += weight;
            view.reach += weight * scene.diagonal();
            if (scene.sky.lit()) view.lit += weight;
            return;
        }
        view.reach += weight * hit.t;
        const Material& material = scene.materials[scene.triangles[hit.triangle].material];
        if (!material.transmits) (hit.back != (turned[hit.triangle] != 0) ? view.backs : view.fronts) += weight;
        if (material.emits || material.transmits || is_lit(ray, hit, seed)) view.lit += weight;
    }

    /// Whether a lamp lights the side of a surface that a ray meets.
    bool is_lit(const Ray& ray, const Hit& hit, uint32_t seed) const {
        Vec3 n = scene.geometric_normal(hit.triangle);
        if (hit.back) n = -n;
        return sees_lamp(tracer.offset(ray.origin + ray.direction * hit.t, n), n, seed);
    }

    bool sees_lamp(const Vec3& p, const Vec3& n, uint32_t seed) const {
        float chance;
        const uint32_t e = emitters.pick_anywhere(p, n, hash32(seed), chance);
        if (e == EmitterSet::kNone || e == emitters.sky_emitter()) return false;
        const EmitterSample s = emitters.sample(e, p, owen_sobol(0, seed));
        if (!(glm::dot(s.direction, n) > 0.0f) || !(max_component(s.weight) > 0.0f)) return false;
        return !tracer.occluded({p, s.direction, 0.0f, shadow_end(tracer, s)}, kMaskWall);
    }

    View view(const Patch& patch, bool back, uint32_t seed) const {
        View v;
        const uint32_t count = point_count(patch);
        for (uint32_t i = 0; i < count; ++i) {
            const Vec2 u = owen_sobol(i, seed);
            const float at = (static_cast<float>(i) + u.x) / static_cast<float>(count) * patch.running_area.back();
            const auto found = std::upper_bound(patch.running_area.begin(), patch.running_area.end() - 1, at);
            const uint32_t t = patch.triangles[static_cast<size_t>(found - patch.running_area.begin())];
            const Vec2 b = sample_triangle(owen_sobol(i, hash32(seed)));
            const Vec3 n = scene.geometric_normal(t) * (back ? -1.0f : 1.0f);
            const Vec3 p = tracer.offset(scene.position(t, b.x, b.y), n);
            const Frame frame = frame_from_normal(n);
            const uint32_t own = hash_combine(seed, i);
            for (uint32_t r = 0; r < kRays; ++r)
                look({p, frame.to_world(sample_hemisphere(owen_sobol(r, own), 1.0f))}, v,
                     1.0f / static_cast<float>(count * kRays), hash_combine(own, 0x10u + r));
            for (uint32_t l = 0; l < kLampSamples; ++l)
                if (sees_lamp(p, n, hash_combine(own, l))) v.lamps += 1.0f / static_cast<float>(count * kLampSamples);
        }
        return v;
    }

    /// The front looks into solids. Few props show backs to a sane front: one with holes, or with a
    /// turned neighbour, shows fronts beside them.
    static bool is_buried(const View& front, const View& back) {
        return front.backs >= 0.4f && back.backs <= 0.25f && back.fronts >= front.fronts + 0.3f;
    }
    /// Lamps shine on the back and hardly on the front, which looks at backs or past the edge of the
    /// world: no player stands there.
    static bool is_hidden(const View& front, const View& back) {
        return front.backs + front.below >= 0.1f && back.fronts >= front.fronts && back.lamps >= kFewLamps &&
               front.lamps <= 0.3f * back.lamps;
    }
    /// The front looks into a gap without any light, behind a panel say, the back into the open.
    /// A dark room is no gap: there is space before its walls.
    static bool is_in_gap(const View& front, const View& back) {
        return front.lamps == 0.0f && front.lit < 0.005f && front.reach < 0.5f * back.reach &&
               back.lamps + back.lit >= 0.1f;
    }
    /// The front looks past the edge of the world, where no ground is, the back into a place.
    static bool is_over_void(const View& front, const View& back) {
        return front.below >= std::max(0.08f, 5.0f * back.below) && back.fronts >= front.fronts + 0.2f &&
               back.lamps + back.lit >= 0.04f;
    }
    /// The front looks out of a closed room into nothing.
    bool is_inside_out(const Patch& patch, const View& front, const View& back) const {
        return (patch.closed || !scene.sky.lit()) && front.fronts < 0.25f && back.misses < kEnclosed &&
               back.lamps >= 2.0f * kFewLamps;
    }
    /// No lamp shines on the front of a facet and many on its back.
    static bool is_clearly_hidden(const View& front, const View& back) {
        return is_hidden(front, back) && front.lamps == 0.0f && back.lamps >= 4.0f * kFewLamps &&
               front.lit < 0.5f * back.lit;
    }
    /// Whether the side that the normals point away from is the one to bake.
    bool should_turn(const Patch& patch, const View& front, const View& back) const {
        if (is_over_void(front, back) || is_hidden(front, back)) return true;
        return front.lamps < kFewLamps &&
               (is_buried(front, back) || is_in_gap(front, back) || is_inside_out(patch, front, back));
    }
};

/// Turns patches until no more look the wrong way; is_wrong: of a patch that is not turned yet, by its number.
void turn_patches(Finder& f, SurfaceSides& out, ThreadPool& pool, Progress& progress,
                  const std::function<bool(size_t)>& is_wrong) {
    std::vector<uint8_t> turn(f.patches.size(), 0);
    for (int round = 0; round < kMostRounds; ++round) {
        std::vector<uint8_t> next = turn;
        f.turned = out.turned;
        pool.for_each(
            f.patches.size(), progress,
            [&](size_t i) {
                const Patch& p = f.patches[i];
                if (p.triangles.empty() || !p.may_turn || out.turned[p.triangles[0]] != 0) return;
                next[i] = is_wrong(i);
            },
            false);
        if (next == turn) break;
        turn = next;
        for (size_t i = 0; i < turn.size(); ++i) {
            if (turn[i] == 0) continue;
            out.hollow[f.patches[i].instance] = 1;
            for (const uint32_t t : f.patches[i].triangles) out.turned[t] = 1;
        }
    }
}

} // namespace

SurfaceSides find_lit_sides(const Snapshot& scene, ThreadPool& pool, Progress& progress) {
    Finder f(scene, pool, progress);
    SurfaceSides out{std::vector<uint8_t>(scene.triangles.size(), 0), std::vector<uint8_t>(scene.instances.size(), 0)};
    std::vector<uint8_t> lit_inside(f.patches.size(), 0);
    const auto views = [&](size_t i) {
        const auto seed = hash32(static_cast<uint32_t>(i));
        return std::pair{f.view(f.patches[i], false, seed), f.view(f.patches[i], true, hash_combine(seed, 1u))};
    };
    turn_patches(f, out, pool, progress, [&](size_t i) {
        const auto [front, back] = views(i);
        lit_inside[i] = f.patches[i].closed && back.lamps > 0.0f;
        return f.should_turn(f.patches[i], front, back);
    });
    for (size_t i = 0; i < lit_inside.size(); ++i)
        if (lit_inside[i] != 0) out.hollow[f.patches[i].instance] = 1;
    // Where turned and right surfaces hang together, the patch as a whole does not tell; its facets may, and one
    // that surely looks the wrong way lends its word to the others of its patch.
    const std::vector<uint32_t> patch = f.patch_of_triangles();
    std::vector<uint8_t> has_turned(f.patches.size(), 0);
    f.collect(kFacetCosine);
    f.least_points = kLeastFacetPoints;
    for (const bool sure : {true, false}) {
        turn_patches(f, out, pool, progress, [&](size_t i) {
            if (f.patches[i].closed || (!sure && has_turned[patch[f.patches[i].triangles[0]]] == 0)) return false;
            const auto [front, back] = views(i);
            return sure ? f.is_clearly_hidden(front, back) : f.is_hidden(front, back);
        });
        for (size_t t = 0; t < patch.size(); ++t) has_turned[patch[t]] |= out.turned[t];
    }
    return out;
}

} // namespace ajar
