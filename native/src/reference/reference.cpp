// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/reference.h"

#include "base/hash.h"
#include "reference/path.h"

namespace ajar {

namespace {

constexpr uint32_t kCells = 8; ///< edge of the grid of first rays
static_assert(kCells * kCells == kBatchPaths);
constexpr size_t kChunk = 4;                       ///< points of one task
constexpr uint32_t kLitPaths = 8;                  ///< each of them looks for every kind of source at every bounce
constexpr uint64_t kLitStream = uint64_t{1} << 32; ///< random numbers that tell lit places from dark ones

struct Sums {
    glm::dvec3 color{0.0};
    double squares = 0.0; ///< of the batches' luminance
};

struct Integrator {
    const World& world;
    const PathTracer& paths;
    const PointChooser& chooser;
    const ReferenceSettings& settings;

    Vertex receiver(const Place& place) const;
    Vec3 batch(const ReferencePoint& point, uint32_t index, uint32_t number) const;
};

/// The vertex of a place with the wanted normal; the lightmap's u gives the tangent.
Vertex Integrator::receiver(const Place& p) const {
    Vertex at = front_vertex(world, p.triangle, p.u, p.v);
    if (settings.normal == Vec3(0, 0, 1)) return at;
    const Snapshot& s = world.scene;
    const Vec2 a = s.lightmap_uv(p.triangle, 1) - s.lightmap_uv(p.triangle, 0),
               b = s.lightmap_uv(p.triangle, 2) - s.lightmap_uv(p.triangle, 0);
    const auto* v = s.triangles[p.triangle].vertex;
    const Vec3 ea = s.positions[v[1]] - s.positions[v[0]], eb = s.positions[v[2]] - s.positions[v[0]];
    const float det = a.x * b.y - a.y * b.x;
    const Vec3 du = (ea * b.y - eb * a.y) / det, dv = (eb * a.x - ea * b.x) / det;
    const float turn = glm::dot(glm::cross(at.normal, du), dv) < 0.0f ? -1.0f : 1.0f;
    at.normal = glm::normalize(frame_from_tangent(at.normal, du, turn).to_world(settings.normal));
    return at;
}

Vec3 Integrator::batch(const ReferencePoint& point, uint32_t index, uint32_t number) const {
    Pcg random(settings.seed * 0x9e3779b97f4a7c15ull + number, index);
    Vec3 sum(0.0f);
    for (uint32_t i = 0; i < kBatchPaths; ++i) {
        const Place place = settings.whole_texels ? chooser.place_in_texel(point, random) : point.place;
        const SceneState state{settings.weights, random.next(), world.scene.presence(place.triangle)};
        const float x = random.uniform(), y = random.uniform();
        const Vec2 first((static_cast<float>(i % kCells) + x) / kCells, (static_cast<float>(i / kCells) + y) / kCells);
        const Vec3 light = paths.irradiance(receiver(place), first, state, random);
        if (is_finite(light)) sum += light;
    }
    return sum / static_cast<float>(kBatchPaths);
}

ReferenceValue value_of(const ReferencePoint& point, const Sums& s, uint32_t batches) {
    const double n = batches;
    const Vec3 mean(s.color / n);
    const double level = luminance(mean), spread = std::max(0.0, s.squares / n - level * level);
    return {point, mean, static_cast<float>(std::sqrt(spread / (n - 1.0)))};
}

} // namespace

ReferenceResult trace_reference(const Snapshot& scene, const Tracer& tracer, const ReferenceSettings& settings,
                                ThreadPool& pool, Progress& progress) {
    const World world(scene, tracer);
    const Lights lights(world, settings.weights);
    const PathTracer paths(world, lights, settings.bounces, settings.door_bounces, settings.weights);
    const auto is_lit = [&](const Place& place) {
        Pcg random(settings.point_seed, kLitStream + place.triangle);
        for (uint32_t i = 0; i < kLitPaths; ++i) {
            const SceneState state{settings.weights, random.next(), scene.presence(place.triangle)};
            const Vec2 first(random.uniform(), random.uniform());
            const Vertex at = front_vertex(world, place.triangle, place.u, place.v);
            if (max_component(paths.irradiance(at, first, state, random)) > 0.0f) return true;
        }
        return false;
    };
    const PointChooser chooser(world, settings.by_texel, settings.whole_texels, {settings.weights}, is_lit);
    const std::vector<ReferencePoint> points = chooser.choose(settings.points, settings.point_seed, progress);
    const Integrator integrator{world, paths, chooser, settings};
    std::vector<Sums> sums(points.size());
    uint32_t done = 0;
    const auto out_of_time = [&] {
        return settings.time_limit > 0.0f && progress.elapsed() > settings.time_limit && done >= kLeastBatches;
    };
    while (done < settings.batches && !out_of_time()) {
        pool.for_each((points.size() + kChunk - 1) / kChunk, progress,
                      [&](size_t chunk) {
                          for (size_t i = chunk * kChunk; i < std::min(points.size(), (chunk + 1) * kChunk); ++i) {
                              progress.check_cancel();
                              const Vec3 e = integrator.batch(points[i], static_cast<uint32_t>(i), done);
                              sums[i].color += glm::dvec3(e);
                              sums[i].squares += double{luminance(e)} * luminance(e);
                          }
                      },
                      false);
        ++done;
        progress.update(static_cast<float>(done) / static_cast<float>(settings.batches));
        progress.add_rays(points.size() * kBatchPaths);
    }
    ReferenceResult out;
    out.batches = done;
    for (size_t i = 0; i < points.size(); ++i) out.values.push_back(value_of(points[i], sums[i], done));
    return out;
}

} // namespace ajar
