// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/gather.h"

#include "base/owen_sobol.h"
#include "sampling/warp.h"

#include <bit>

namespace ajar {

namespace {

constexpr uint32_t kBatch = 256;        ///< rays per receiver whose strata are visited together
constexpr int kMaxLayers = 64;          ///< transmissive surfaces one gather ray may cross
constexpr int kMaxUnmapped = 12;        ///< consecutive surfaces without lightmap
constexpr float kNearTexels = 4.0f;     ///< a solid's inside closer than this speaks for an invalid receiver

uint32_t morton2(uint32_t x, uint32_t y) {
    const auto spread = [](uint32_t v) {
        v = (v | (v << 4)) & 0x0f0fu;
        v = (v | (v << 2)) & 0x3333u;
        return (v | (v << 1)) & 0x5555u;
    };
    return spread(x) | (spread(y) << 1);
}

/// A batch of samples of all receivers of a tile, sorted into strata: [stratum][receiver].
struct StratifiedBatch {
    std::vector<float> x, y;

    /// A block of count samples holds one point per cell of a grid; cells are visited in Morton
    /// order, so that neighbours in the order are neighbours on the hemisphere.
    void fill(const LightmapReceivers& receivers, const Tile& tile, uint32_t first_sample, uint32_t count, uint32_t seed) {
        x.resize(size_t{count} * kTileReceivers);
        y.resize(size_t{count} * kTileReceivers);
        const auto log2 = static_cast<uint32_t>(std::countr_zero(count));
        const auto nx = static_cast<float>(1u << ((log2 + 1) / 2)), ny = static_cast<float>(1u << (log2 / 2));
        for (uint32_t i = 0; i < kTileReceivers; ++i) {
            const uint32_t h = hash_combine(seed, i < tile.count ? receivers.texel[tile.first + i] : 0u);
            for (uint32_t s = 0; s < count; ++s) {
                const Vec2 u = owen_sobol(first_sample + s, h);
                auto cx = static_cast<uint32_t>(u.x * nx);
                const auto cy = static_cast<uint32_t>(u.y * ny);
                // Grids twice as wide as high interleave the extra column bit last.
                const uint32_t cell = log2 & 1 ? morton2(cx >> 1, cy) * 2 + (cx & 1) : morton2(cx, cy);
                x[size_t{cell} * kTileReceivers + i] = u.x;
                y[size_t{cell} * kTileReceivers + i] = u.y;
            }
        }
    }
};

struct Gatherer {
    const GatherScene& g;
    const GatherOptions& o;
    const Tile& tile;
    TileSums& sums;
    float mis_gather;
    uint64_t rays = 0;
    StratifiedBatch batch;

    void run();
    void shoot(uint32_t first, uint32_t stratum, uint32_t sample);
    Vec3 shade(uint32_t lane, uint32_t local, const RayPacket& rays, uint32_t sample);
    Vec3 shade_slow(Ray ray, Hit hit, uint32_t local, float cosine, uint32_t seed);
    Vec3 sky(const Vec3& w, uint32_t local, float cosine) const;
    Vec3 emission(const Vec3& radiance, const Ray& ray, const Hit& hit, uint32_t local, float cosine) const;
    float mis_weight(uint32_t emitter, float density, uint32_t local, float cosine) const;
    Vec3 unmapped_radiance(const Ray& ray, const Hit& hit, const Vec3& reflectance, uint32_t seed, int depth);
    Vec3 path_radiance(Ray ray, uint32_t seed, int depth);
    Vec3 texel_radiance(const Hit& hit) const {
        return o.radiance != nullptr ? Vec3(o.radiance[g.surfaces.texel(hit.triangle, hit.u, hit.v)]) : Vec3(0.0f);
    }
    Vec3 first_hit_radiance(uint32_t triangle, float u, float v, float t, const Vec3& w, uint32_t local, float cosine) const;
};

float Gatherer::mis_weight(uint32_t emitter, float density, uint32_t local, float cosine) const {
    if (o.choice == nullptr || o.direct_samples == 0) return 0.0f; // emitter samples were all: none asked here
    const float direct = static_cast<float>(o.direct_samples) * density * o.choice->chance(local, emitter);
    const float own = mis_gather * hemisphere_pdf(cosine, o.share);
    return own / (own + direct);
}

Vec3 Gatherer::sky(const Vec3& w, uint32_t local, float cosine) const {
    const Sky& s = g.scene.sky;
    if (!o.emission || !s.lit()) return Vec3(0.0f);
    const uint32_t e = g.emitters.sky_emitter();
    const float weight = e == EmitterSet::kNone ? 1.0f : mis_weight(e, g.emitters.sky_pdf(w), local, cosine);
    return s.radiance(w) * weight;
}

Vec3 Gatherer::emission(const Vec3& radiance, const Ray& ray, const Hit& hit, uint32_t local, float cosine) const {
    if (!o.emission) return Vec3(0.0f);
    const uint32_t e = g.emitters.emitter_of(hit.triangle);
    if (e == EmitterSet::kNone) return radiance;
    const float facing = std::abs(glm::dot(ray.direction, g.scene.geometric_normal(hit.triangle)));
    return radiance * mis_weight(e, g.emitters.triangle_pdf(hit.triangle, hit.t, facing), local, cosine);
}

/// Surfaces without a lightmap have no stored light: one emitter sample and one more ray stand
/// in. Bounces there are free, they do not count as one of the series.
Vec3 Gatherer::unmapped_radiance(const Ray& ray, const Hit& hit, const Vec3& reflectance, uint32_t seed, int depth) {
    if (depth >= kMaxUnmapped || !(max_component(reflectance) > 0.0f)) return Vec3(0.0f);
    Vec3 n = g.scene.geometric_normal(hit.triangle);
    if (hit.back) n = -n;
    const Vec3 p = g.tracer.offset(ray.origin + ray.direction * hit.t, n);
    Vec3 result(0.0f);
    if (o.unmapped_direct) result += direct_irradiance(g.tracer, g.emitters, p, n, hash_combine(seed, 0x11u)) * kInvPi;
    // Russian roulette by reflectance keeps chains short in dark rooms.
    const float survive = depth == 0 ? 1.0f : std::min(1.0f, max_component(reflectance));
    if (unit_float(hash_combine(seed, 0x22u)) < survive) {
        const Vec3 w = frame_from_normal(n).to_world(sample_hemisphere(owen_sobol(0, hash_combine(seed, 0x33u)), 1.0f));
        result += path_radiance({p, w}, hash_combine(seed, 0x44u), depth + 1) / survive;
    }
    return reflectance * result;
}

/// Radiance along a ray of such a stand-in. What emitter samples find there is left to them.
Vec3 Gatherer::path_radiance(Ray ray, uint32_t seed, int depth) {
    Vec3 through(1.0f), result(0.0f);
    for (int layer = 0; layer < kMaxLayers; ++layer) {
        ++rays;
        const Hit hit = g.tracer.intersect(ray, kMaskGather);
        if (hit.triangle == kMiss) {
            if (o.unmapped_direct && g.emitters.sky_emitter() == EmitterSet::kNone && g.scene.sky.lit()) result += through * g.scene.sky.radiance(ray.direction);
            return result;
        }
        const uint8_t f = g.surfaces.flags(hit.triangle);
        if (hit.back && (f & (SurfaceTable::kOneSided | SurfaceTable::kSolid))) return result;
        const bool plain = !hit.back && !(f & (SurfaceTable::kUnmapped | SurfaceTable::kEmits | SurfaceTable::kTransmits));
        if (plain) return result + through * texel_radiance(hit);
        const SurfaceSample s = g.scene.surface(hit.triangle, hit.u, hit.v);
        if (o.unmapped_direct && g.emitters.emitter_of(hit.triangle) == EmitterSet::kNone) result += through * s.emission;
        result += through * (hit.back || (f & SurfaceTable::kUnmapped) ? unmapped_radiance(ray, hit, s.reflectance, hash_combine(seed, layer), depth) : texel_radiance(hit));
        through *= s.transmittance;
        if (!(max_component(through) > 1e-4f)) return result;
        ray.tnear = next_tnear(hit.t);
    }
    return result;
}

/// What a lightmapped surface sends to a receiver. Bright texels share it with the emitter samples
/// that aim at them; the fourth channel marks them.
Vec3 Gatherer::first_hit_radiance(uint32_t triangle, float u, float v, float t, const Vec3& w, uint32_t local, float cosine) const {
    if (o.radiance == nullptr) return Vec3(0.0f);
    const uint32_t texel = g.surfaces.texel(triangle, u, v);
    const Vec4 radiance = o.radiance[texel];
    if (radiance.w == 0.0f || o.direct_samples == 0) return Vec3(radiance);
    float density = 0.0f;
    const uint32_t e = g.emitters.bright_emitter(texel, density);
    if (e == EmitterSet::kNone) return Vec3(radiance);
    const float facing = std::max(std::abs(glm::dot(w, g.scene.geometric_normal(triangle))), 1e-9f);
    return Vec3(radiance) * mis_weight(e, density * t * t / facing, local, cosine);
}

/// The general case of a gather ray: emission, layers of transmissive surfaces, back faces.
Vec3 Gatherer::shade_slow(Ray ray, Hit hit, uint32_t local, float cosine, uint32_t seed) {
    Vec3 through(1.0f), result(0.0f);
    for (int layer = 0; layer < kMaxLayers; ++layer) {
        if (hit.triangle == kMiss) return result + through * sky(ray.direction, local, cosine);
        const uint8_t f = g.surfaces.flags(hit.triangle);
        if (hit.back && (f & (SurfaceTable::kOneSided | SurfaceTable::kSolid))) {
            if (hit.t < kNearTexels * g.receivers.texel_size[tile.first + local]) sums.inside[local] += 1.0f;
            return result;
        }
        const bool mapped = !hit.back && !(f & SurfaceTable::kUnmapped);
        if (mapped && !(f & SurfaceTable::kTransmits)) {
            if (o.emission && (f & SurfaceTable::kEmits)) result += through * emission(g.scene.emission(hit.triangle, hit.u, hit.v), ray, hit, local, cosine);
            return result + through * first_hit_radiance(hit.triangle, hit.u, hit.v, hit.t, ray.direction, local, cosine);
        }
        const SurfaceSample s = g.scene.surface(hit.triangle, hit.u, hit.v);
        if (f & SurfaceTable::kEmits) result += through * emission(s.emission, ray, hit, local, cosine);
        result += through * (mapped ? first_hit_radiance(hit.triangle, hit.u, hit.v, hit.t, ray.direction, local, cosine)
                                    : unmapped_radiance(ray, hit, s.reflectance, hash_combine(seed, layer), 0));
        through *= s.transmittance;
        if (!(max_component(through) > 1e-4f)) return result;
        ray.tnear = next_tnear(hit.t);
        ++rays;
        hit = g.tracer.intersect(ray, kMaskGather);
    }
    return result;
}

Vec3 Gatherer::shade(uint32_t lane, uint32_t local, const RayPacket& packet, uint32_t sample) {
    const uint32_t triangle = packet.triangle[lane];
    const Vec3 w = packet.direction(lane);
    const bool back = triangle != kMiss && g.surfaces.back(triangle, w, packet.normal(lane));
    const uint8_t special = SurfaceTable::kTransmits | SurfaceTable::kUnmapped | (o.emission ? SurfaceTable::kEmits : 0);
    const float cosine = glm::dot(w, g.receivers.frame[tile.first + local].z);
    if (triangle != kMiss && !back && !(g.surfaces.flags(triangle) & special))
        return first_hit_radiance(triangle, packet.u[lane], packet.v[lane], packet.tfar[lane], w, local, cosine);
    const Ray ray{{packet.ox[lane], packet.oy[lane], packet.oz[lane]}, w};
    const Hit hit{triangle, packet.u[lane], packet.v[lane], packet.tfar[lane], back};
    const Vec3 r = shade_slow(ray, hit, local, cosine, hash_combine(hash_combine(o.seed, g.receivers.texel[tile.first + local]), sample));
    return is_finite(r) ? r : Vec3(0.0f);
}

void Gatherer::shoot(uint32_t first, uint32_t stratum, uint32_t sample) {
    RayPacket packet;
    alignas(32) int32_t valid[kLanes];
    Vec3 local_direction[kLanes];
    float weight[kLanes];
    packet.prepare(kMaskGather);
    const uint32_t k_count = g.receivers.positions_per_texel;
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
        const size_t i = size_t{stratum} * kTileReceivers + first + lane;
        const uint32_t r = tile.first + std::min(first + lane, tile.count - 1);
        valid[lane] = first + lane < tile.count ? -1 : 0;
        const Vec3 w = sample_hemisphere({batch.x[i], batch.y[i]}, o.share);
        local_direction[lane] = w;
        weight[lane] = 1.0f / hemisphere_pdf(std::max(w.z, 1e-6f), o.share);
        // Neighbouring strata visit all positions, and so does each stratum over the batches, in an
        // order that does not follow the sequence.
        const uint32_t turn = shuffle_index(sample / kBatch, hash32(g.receivers.texel[r] ^ o.seed)) & 0xffffu;
        const Vec3 p = g.receivers.origins(r)[(stratum + turn) % k_count];
        packet.set(lane, p, g.receivers.frame[r].to_world(w), std::numeric_limits<float>::infinity());
    }
    g.tracer.intersect(valid, packet);
    for (uint32_t lane = 0; lane < kLanes && first + lane < tile.count; ++lane) {
        const uint32_t local = first + lane;
        ++rays;
        const Vec3 facing = shade(lane, local, packet, sample) * weight[lane];
        const Vec3& w = local_direction[lane];
        sums.cosine_sum[local] += weight[lane] * w.z;
        sums.add_pair(local, sample, luminance(facing) * w.z);
        sums.add(local, w, facing);
    }
}

void Gatherer::run() {
    const uint32_t count = std::min(o.samples, kBatch);
    for (uint32_t begin = 0; begin < o.samples; begin += count) {
        batch.fill(g.receivers, tile, o.first_sample + begin, count, o.seed);
        for (uint32_t s = 0; s < count; ++s)
            for (uint32_t first = 0; first < tile.count; first += kLanes) shoot(first, s, begin + s);
    }
}

} // namespace

uint64_t gather_tile(const GatherScene& scene, const Tile& tile, const GatherOptions& options, TileSums& sums) {
    Gatherer gatherer{scene, options, tile, sums, static_cast<float>(options.samples), 0, {}};
    gatherer.run();
    return gatherer.rays;
}

} // namespace ajar
