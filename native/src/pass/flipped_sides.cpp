// SPDX-License-Identifier: GPL-3.0-or-later
#include "pass/flipped_sides.h"

#include <algorithm>
#include <cstdio>

#include "base/owen_sobol.h"
#include "sampling/warp.h"
#include "scene/mesh_patch.h"

namespace ajar {

namespace {

constexpr float kMostReach = 0.5f;     ///< m
constexpr float kReachOfWidth = 0.25f; ///< of the surface's width
// Of a front that looks flipped: half of what an upright sheet over the edge of the world sees is above the horizon.
constexpr float kBlind = 0.4f;
// Of its back. Sheets above each other and cards in the air are blind on both sides, or on neither.
constexpr float kOpen = 0.5f, kBlindBack = 0.25f;
constexpr float kLeastShare = 0.02f,
                kLeastArea = 0.25f;                    ///< of the object, and m^2: parts smaller than both do not count
constexpr uint32_t kRaysPerPoint = 4;                  ///< and side
constexpr uint32_t kMostPoints = 64, kLeastPoints = 4; ///< per part
constexpr uint64_t kRayBudget = 4000000;               ///< of all fronts
constexpr size_t kNamedAlone = 8;                      ///< objects with a warning of their own

/// A connected part of one instance.
struct Part {
    uint32_t instance = 0;
    std::vector<uint32_t> triangles;
    std::vector<float> running_area;
    float reach = 0.0f; ///< m

    float area() const { return running_area.back(); }
};

/// What the hemisphere over one side ends on, shares.
struct View {
    float blind = 0.0f, open = 0.0f;
};

class Measure {
public:
    Measure(const Snapshot& scene, const Tracer& tracer, const std::vector<Behind>& behind)
        : scene_(scene), tracer_(tracer), behind_(behind) {}

    View look(const Part& part, bool back, uint32_t points, uint32_t seed) const {
        View v;
        const float weight = 1.0f / static_cast<float>(points * kRaysPerPoint);
        for (uint32_t i = 0; i < points; ++i) {
            const Vec2 u = owen_sobol(i, seed), b = sample_triangle(owen_sobol(i, hash32(seed)));
            const float at = (static_cast<float>(i) + u.x) / static_cast<float>(points) * part.area();
            const auto found = std::upper_bound(part.running_area.begin(), part.running_area.end() - 1, at);
            const uint32_t t = part.triangles[static_cast<size_t>(found - part.running_area.begin())];
            const Vec3 n = scene_.geometric_normal(t) * (back ? -1.0f : 1.0f);
            const Frame frame = frame_from_normal(n);
            const Vec3 p = tracer_.offset(scene_.position(t, b.x, b.y), n);
            for (uint32_t r = 0; r < kRaysPerPoint; ++r)
                add({p, frame.to_world(sample_hemisphere(owen_sobol(r, hash_combine(seed, i)), 1.0f))}, part, weight,
                    v);
        }
        return v;
    }

private:
    void add(const Ray& ray, const Part& part, float weight, View& v) const {
        const Hit hit = tracer_.intersect(ray, kMaskGather); // doors are open, toggles absent
        if (hit.triangle == kMiss) {
            if (!(ray.direction.z > 0.0f))
                v.blind += weight;
            else if (scene_.sky.lit())
                v.open += weight;
            return;
        }
        const Triangle& t = scene_.triangles[hit.triangle];
        const bool opaque = !scene_.materials[t.material].transmits;
        const bool inside = hit.back && behind_[t.instance] == Behind::solid;
        if (inside || (opaque && hit.t < part.reach))
            v.blind += weight;
        else if (!hit.back || t.instance == part.instance) // own backs would be fronts
            v.open += weight;
    }

    const Snapshot& scene_;
    const Tracer& tracer_;
    const std::vector<Behind>& behind_;
};

/// The second longest edge of the box around a part: its width, if it is a sheet.
float width_of(const Snapshot& scene, const Part& part) {
    Vec3 low(std::numeric_limits<float>::infinity()), high = -low;
    for (const uint32_t t : part.triangles)
        for (const uint32_t v : scene.triangles[t].vertex)
            low = glm::min(low, scene.positions[v]), high = glm::max(high, scene.positions[v]);
    std::array<float, 3> edges{high.x - low.x, high.y - low.y, high.z - low.z};
    std::sort(edges.begin(), edges.end());
    return edges[1];
}

/// Every part of lightmapped instances that is large enough, and the areas (m^2) of instances.
std::vector<Part> collect(const Snapshot& scene, std::vector<float>& area) {
    std::vector<MeshPatches> of_mesh;
    for (const Mesh& m : scene.meshes) of_mesh.push_back(find_patches(m));
    std::vector<std::vector<Part>> parts(scene.instances.size());
    for (size_t i = 0; i < parts.size(); ++i)
        if (scene.instances[i].lightmapped) parts[i].resize(of_mesh[scene.instances[i].mesh].count);
    area.assign(scene.instances.size(), 0.0f);
    for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
        const Triangle& triangle = scene.triangles[t];
        if (!scene.instances[triangle.instance].lightmapped) continue;
        Part& p = parts[triangle.instance][of_mesh[scene.instances[triangle.instance].mesh].patch[triangle.source]];
        const float own = scene.area(t);
        p.instance = triangle.instance;
        p.triangles.push_back(t);
        p.running_area.push_back((p.running_area.empty() ? 0.0f : p.running_area.back()) + own);
        area[triangle.instance] += own;
    }
    std::vector<Part> out;
    for (std::vector<Part>& of : parts) {
        for (Part& p : of) {
            if (p.triangles.empty() || (p.area() < kLeastShare * area[p.instance] && p.area() < kLeastArea)) continue;
            p.reach = std::min(kMostReach, kReachOfWidth * width_of(scene, p));
            out.push_back(std::move(p));
        }
    }
    return out;
}

/// Parts of one object that look flipped.
struct Finding {
    uint32_t instance = 0;
    float area = 0.0f, blind = 0.0f, reach = 0.0f; ///< m^2; mean over the area; m, of the largest part
};

std::string text_of(const Finding& f, float object_area) {
    constexpr float kWhole = 0.9f; // of the surface: the object as a whole is to be turned
    const float share = f.area / object_area;
    char text[400];
    std::snprintf(
        text, sizeof text,
        "looks flipped, %.0f %% of its surface: the front faces what nobody sees (%.0f %% of it ends within "
        "%.2g m, inside solids or below the scene), the back the open; the lightmap holds the front and stays "
        "dark. Flip %s",
        100.0 * share, 100.0 * f.blind, f.reach,
        share >= kWhole ? "its normals (Mesh > Normals > Flip), or set Bake side to Back"
                        : "the faces that show red in the Face Orientation overlay (Mesh > Normals > Flip)");
    return text;
}

} // namespace

std::vector<Warning> find_flipped_sides(const Snapshot& scene, const Tracer& tracer, const std::vector<Behind>& behind,
                                        ThreadPool& pool, Progress& progress) {
    std::vector<float> area;
    const std::vector<Part> parts = collect(scene, area);
    const Measure measure(scene, tracer, behind);
    const uint64_t share = kRayBudget / (kRaysPerPoint * std::max<uint64_t>(parts.size(), 1));
    const auto points = static_cast<uint32_t>(std::clamp<uint64_t>(share, kLeastPoints, kMostPoints));
    std::vector<float> blind(parts.size(), 0.0f); ///< of parts that look flipped
    pool.for_each(
        parts.size(), progress,
        [&](size_t i) {
            const uint32_t seed = hash32(static_cast<uint32_t>(i));
            const float front = measure.look(parts[i], false, points, seed).blind;
            if (front < kBlind) return;
            const View back = measure.look(parts[i], true, points, seed);
            if (back.open >= kOpen && back.blind <= kBlindBack) blind[i] = front;
        },
        false);
    std::vector<Finding> findings;
    for (size_t i = 0; i < parts.size(); ++i) {
        if (blind[i] == 0.0f) continue;
        if (findings.empty() || findings.back().instance != parts[i].instance)
            findings.push_back({parts[i].instance, 0.0f, 0.0f, parts[i].reach});
        findings.back().area += parts[i].area();
        findings.back().blind += blind[i] * parts[i].area();
    }
    std::stable_sort(findings.begin(), findings.end(),
                     [](const Finding& a, const Finding& b) { return a.area > b.area; });
    std::vector<Warning> out;
    std::string others;
    for (size_t i = 0; i < findings.size(); ++i) {
        Finding& f = findings[i];
        f.blind /= f.area;
        const std::string& name = scene.instances[f.instance].name;
        if (i < kNamedAlone)
            out.push_back({name, text_of(f, area[f.instance])});
        else
            others += (others.empty() ? "" : ", ") + name;
    }
    if (!others.empty())
        out.push_back({scene.name, std::to_string(findings.size() - kNamedAlone) +
                                       " more objects look flipped, in part or whole: " + others +
                                       ". Flip their normals (Mesh > Normals > Flip), or set Bake side to Back"});
    return out;
}

} // namespace ajar
