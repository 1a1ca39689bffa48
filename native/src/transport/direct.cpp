// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/direct.h"

#include "base/owen_sobol.h"
#include "sampling/warp.h"

namespace ajar {

namespace {

/// Where a shadow ray ends: just before the emitter.
float shadow_end(const Tracer& tracer, const EmitterSample& s) {
    if (!std::isfinite(s.distance)) return s.distance;
    return std::max(0.0f, s.distance * (1.0f - 1e-5f) - 2.0f * tracer.offset_distance(s.target));
}

/// Eight receivers' samples that wait for their shadow rays.
struct ShadowPacket {
    RayPacket rays;
    alignas(32) int32_t valid[kLanes];
    Vec3 facing[kLanes], local[kLanes];
    bool lit[kLanes];
};

struct DirectSampler {
    const Snapshot& scene;
    const Tracer& tracer;
    const EmitterSet& emitters;
    const LightChoice& choice;
    const LightmapReceivers& receivers;
    const Tile& tile;
    uint32_t samples;
    MisCounts mis;
    uint32_t seed;

    bool prepare(uint32_t local, uint32_t sample, ShadowPacket& packet, uint32_t lane) const;
    void finish(ShadowPacket& packet, uint32_t first, uint32_t sample, TileSums& sums) const;
};

bool DirectSampler::prepare(uint32_t local, uint32_t sample, ShadowPacket& packet, uint32_t lane) const {
    const uint32_t r = tile.first + local;
    const uint32_t h = hash_combine(seed, receivers.texel[r]);
    float u = (static_cast<float>(sample) + unit_float(hash_combine(h, sample))) / static_cast<float>(samples);
    float chance;
    const uint32_t emitter = choice.pick(local, u, chance);
    const Vec3 p = receivers.origins(r)[(sample + h) % receivers.positions_per_texel];
    // Positions follow the low bits of the sample number, so the points on the lamp must not.
    const EmitterSample s = emitters.sample(emitter, p, owen_sobol(shuffle_index(sample, h ^ 0x9e3779b9u), h));
    const Vec3 w = receivers.frame[r].to_local(s.direction);
    if (!(w.z > 0.0f) || !(max_component(s.weight) > 0.0f)) return false;
    const float pdf = s.pdf * chance;
    const float weight = s.pdf > 0.0f ? mis.direct * pdf / (mis.direct * pdf + mis.gather * hemisphere_pdf(w.z, mis.share)) : 1.0f;
    packet.facing[lane] = s.weight * (weight / chance);
    packet.local[lane] = w;
    packet.lit[lane] = !s.casts_shadow;
    packet.rays.set(lane, p, s.direction, shadow_end(tracer, s));
    return is_finite(packet.facing[lane]);
}

void DirectSampler::finish(ShadowPacket& packet, uint32_t first, uint32_t sample, TileSums& sums) const {
    for (uint32_t lane = 0; lane < kLanes && first + lane < tile.count; ++lane) {
        Vec3 facing(0.0f);
        if (packet.valid[lane] != 0 && (packet.lit[lane] || packet.rays.tfar[lane] >= 0.0f)) {
            facing = packet.facing[lane];
            if (!packet.lit[lane] && tracer.has_transmissive())
                facing *= tracer.tint({{packet.rays.ox[lane], packet.rays.oy[lane], packet.rays.oz[lane]}, packet.rays.direction(lane), 0.0f, packet.rays.tfar[lane]});
            sums.add(first + lane, packet.local[lane], facing);
        }
        sums.add_pair(first + lane, sample, luminance(facing) * packet.local[lane].z);
    }
}

} // namespace

uint64_t sample_direct(const Snapshot& scene, const Tracer& tracer, const EmitterSet& emitters, const LightChoice& choice,
                       const LightmapReceivers& receivers, const Tile& tile, uint32_t samples, const MisCounts& mis, uint32_t seed, TileSums& sums) {
    if (choice.empty()) return 0;
    const DirectSampler sampler{scene, tracer, emitters, choice, receivers, tile, samples, mis, seed};
    ShadowPacket packet{};
    uint64_t rays = 0;
    for (uint32_t sample = 0; sample < samples; ++sample)
        for (uint32_t first = 0; first < tile.count; first += kLanes) {
            packet.rays.prepare(kMaskShadowOpaque);
            for (uint32_t lane = 0; lane < kLanes; ++lane) {
                packet.valid[lane] = first + lane < tile.count && sampler.prepare(first + lane, sample, packet, lane) ? -1 : 0;
                if (packet.valid[lane] == 0) packet.rays.set(lane, Vec3(0.0f), Vec3(0, 0, 1), 0.0f);
                rays += packet.valid[lane] != 0;
            }
            tracer.occluded(packet.valid, packet.rays);
            sampler.finish(packet, first, sample, sums);
        }
    return rays;
}

Vec3 direct_irradiance(const Tracer& tracer, const EmitterSet& emitters, const Vec3& p, const Vec3& n, uint32_t seed) {
    float chance;
    const uint32_t e = emitters.pick_anywhere(p, n, hash32(seed), chance);
    if (e == EmitterSet::kNone) return Vec3(0.0f);
    const EmitterSample s = emitters.sample(e, p, owen_sobol(0, seed));
    const float cosine = glm::dot(s.direction, n);
    if (!(cosine > 0.0f) || !(max_component(s.weight) > 0.0f)) return Vec3(0.0f);
    const Vec3 seen = s.casts_shadow ? tracer.transmittance({p, s.direction, 0.0f, shadow_end(tracer, s)}) : Vec3(1.0f);
    return s.weight * seen * (cosine / chance);
}

} // namespace ajar
