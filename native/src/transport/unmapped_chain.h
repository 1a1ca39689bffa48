// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Gatherer's light by way of surfaces without a lightmap: chains of rays from one to the next.

#include "transport/gather_kernel.h"

namespace ajar {

template <class Sink>
void Gatherer<Sink>::unmapped(const Ray& ray, const Hit& hit, Through through, const Vec3& reflectance, float survives,
                              uint32_t seed, const Sender& sender) {
    if (!(max_component(reflectance) > 0.0f)) return;
    const Working here(Effect::unmapped_surfaces);
    const Facing n = facing_of(hit);
    const Vec3 p = g.tracer.offset(ray.origin + ray.direction * hit.t, n.side);
    through.color *= reflectance;
    if (o.unmapped_direct) {
        const float facing = std::abs(glm::dot(ray.direction, n.side)) / std::max(hit.t * hit.t, 1e-30f);
        direct_light(p, n, hit.triangle, through, hash_combine(seed, 0x11u), {sender.density * facing, sender.spots});
    }
    if (has_spots() && unit_float(hash_combine(seed, 0x66u)) < kChainSpots) chain_spot(p, n, through, seed);
    if (unit_float(hash_combine(seed, 0x22u)) >= survives) return;
    const Vec3 local = sample_hemisphere(owen_sobol(0, hash_combine(seed, 0x33u)), 1.0f);
    const Vec3 w = frame_from_normal(n.shading).to_world(local);
    if (!(glm::dot(w, n.side) > 0.0f)) return;
    through.color /= survives;
    path({p, w}, through, hash_combine(seed, 0x44u), local.z);
}

template <class Sink>
void Gatherer<Sink>::direct_light(const Vec3& p, const Facing& n, uint32_t triangle, const Through& through,
                                  uint32_t seed, const Sharing& sharing) {
    float chance;
    const uint32_t e = g.emitters.pick_anywhere(p, n.shading, hash32(seed), chance);
    if (e == EmitterSet::kNone) return;
    const EmitterSample s = g.emitters.sample(e, p, owen_sobol(0, seed));
    float weight = 1.0f;
    if (std::isfinite(s.distance) && s.pdf > 0.0f)
        weight = s.pdf / (s.pdf + std::max(glm::dot(s.direction, n.shading), 0.0f) * kInvPi);
    else if (sharing.gather > 0.0f && g.spots != nullptr)
        weight = 1.0f -
                 spot_share(sharing, g.spots->density(e, p, n.side), [&] { return g.spots->reaches(e, triangle, p); });
    reflect(p, n, e, s, through, weight / chance);
}

template <class Sink>
void Gatherer<Sink>::reflect(const Vec3& p, const Facing& n, uint32_t e, const EmitterSample& s, Through through,
                             float scale) {
    const float cosine = glm::dot(s.direction, n.shading);
    if (!(cosine > 0.0f) || !(glm::dot(s.direction, n.side) > 0.0f)) return;
    if (!(max_component(s.weight) > 0.0f) || !(scale > 0.0f)) return;
    if constexpr (Sink::kSwitches)
        if (const Presence there = g.emitters.presence(e);
            there.element != kNoElement && !through.condition.require(g.scene.elements, there))
            return;
    const Vec3 light = s.weight * (cosine * kInvPi * scale);
    const Ray ray{p, s.direction, 0.0f, shadow_end(g.tracer, s)};
    if (!s.casts_shadow) return sink.light(through, g.emitters.set_of(e), light);
    if (g.tracer.occluded(ray, kMaskShadowOpaque)) return;
    through_shadow<Sink>(g.scene, g.tracer, ray, through,
                         [&](const Through& t) { sink.light(t, g.emitters.set_of(e), light); });
}

template <class Sink>
bool Gatherer<Sink>::find_glint(const Vec3& x, const Vec2& u, Glint& glint) {
    ++rays;
    if (!g.spots->sample(u, glint.spot)) return false;
    const Vec3 to = glint.spot.position - x;
    const float square = glm::dot(to, to);
    if (!(square > 0.0f)) return false;
    glint.distance = std::sqrt(square), glint.direction = to / glint.distance;
    const float facing = -glm::dot(glint.direction, glint.spot.normal);
    glint.per_area = facing / square;
    if (!(facing > 0.0f)) return false;
    const Hit& hit = glint.spot.hit;
    const uint8_t f = g.surfaces.flags(hit.triangle);
    if (is_inside(hit, f) || (!hit.back && !(f & SurfaceTable::kUnmapped))) return false;
    const uint32_t r = plain_receiver(hit, f);
    glint.reflectance =
        r != kNoReceiver ? g.receivers.albedo[r] : g.scene.surface(hit.triangle, hit.u, hit.v).reflectance;
    return max_component(glint.reflectance) > 0.0f;
}

template <class Sink>
void Gatherer<Sink>::receive(const Glint& glint, const Vec3& x, Through through, float scale, uint32_t seed) {
    const LampSpots::Spot& spot = glint.spot;
    const Vec3 p = g.tracer.offset(spot.position, spot.normal), to = p - x;
    const float distance = glm::length(to);
    if (!((g.scene.ray_mask(g.scene.triangles[spot.hit.triangle]) & kMaskGather) != 0) || !(distance > 0.0f)) return;
    const Ray ray{x, to / distance, 0.0f, distance};
    ++rays;
    if (g.tracer.occluded(ray, kMaskGather)) return;
    through.color *= glint.reflectance;
    const EmitterSample s = g.emitters.sample(spot.emitter, p, owen_sobol(0, seed));
    const Facing n = facing_of(spot.hit);
    const auto arrive = [&](const Through& t) { reflect(p, n, spot.emitter, s, t, scale); };
    if constexpr (Sink::kSwitches) {
        std::vector<Hit> switches;
        g.tracer.all_switches(ray, kMaskGatherSwitch, switches);
        return through_switches<Sink>(g.scene, switches, 0, through, arrive);
    }
    arrive(through);
}

template <class Sink>
void Gatherer<Sink>::receive_spots(uint32_t first, uint32_t number, uint32_t sample) {
    const Working here(Effect::unmapped_surfaces);
    Flight& f = flights[0];
    const uint32_t count = std::min(kLanes, tile.count - first);
    for (uint32_t lane = 0; lane < kLanes; ++lane) f.local.set(lane, Vec3(0, 0, 1), 0.0f);
    for (uint32_t lane = 0; lane < count; ++lane) {
        receive_spot(first + lane, lane, number, f.local);
        sink.end_sample(lane, first + lane, sample, f.local);
    }
    sink.end_packet(first, sample, f.local);
}

template <class Sink>
void Gatherer<Sink>::receive_spot(uint32_t i, uint32_t lane, uint32_t number, PacketDirections& local) {
    const uint32_t r = tile.first + i, h = hash_combine(hash_combine(o.seed, g.receivers.texel[r]), 0x77u);
    if (!takes_spots(i)) return;
    const uint32_t position = (number + h) % g.receivers.positions_per_texel;
    const Vec3& x = g.receivers.origins(r)[position];
    // One after the other, so that neighbours are alike: pairs of them tell the variance.
    const Vec2 u(
        (static_cast<float>(number) + unit_float(hash_combine(h, number))) / static_cast<float>(spots_per_receiver()),
        owen_sobol(number, h).y);
    Glint glint;
    if (!find_glint(x, u, glint) || !g.receivers.is_above(r, position, glint.direction)) return;
    const Vec3 w = g.receivers.frame[r].to_local(glint.direction);
    if (!(w.z > 0.0f)) return;
    float density = mis_gather * hemisphere_pdf(w.z, o.share);
    if (o.aims != nullptr) density += o.aims->density(i, position, glint.direction);
    const Sharing sharing{density * glint.per_area, static_cast<float>(spots_per_receiver())};
    const float share = spot_share(sharing, glint.spot.density, [] { return true; });
    if (!(share > 0.0f)) return;
    local.set(lane, w, mis_gather * glint.per_area * share / (sharing.spots * glint.spot.density));
    receive(glint, x, sink.start(g.scene, g.receivers.triangle[r]), 1.0f, hash_combine(h, number));
}

template <class Sink>
void Gatherer<Sink>::chain_spot(const Vec3& p, const Facing& n, const Through& through, uint32_t seed) {
    Glint glint;
    if (!find_glint(p, owen_sobol(0, hash_combine(seed, 0x77u)), glint)) return;
    const float cosine = glm::dot(glint.direction, n.shading);
    if (!(cosine > 0.0f) || !(glm::dot(glint.direction, n.side) > 0.0f)) return;
    const Sharing sharing{cosine * kInvPi * glint.per_area, kChainSpots};
    const float share = spot_share(sharing, glint.spot.density, [] { return true; });
    if (!(share > 0.0f)) return;
    receive(glint, p, through, sharing.gather * share / (sharing.spots * glint.spot.density),
            hash_combine(seed, 0x88u));
}

template <class Sink>
void Gatherer<Sink>::path(const Ray& ray, Through through, uint32_t seed, float cosine) {
    ++rays;
    path_on(ray, g.tracer.intersect(ray, kMaskGather), through, seed, {}, cosine);
}

template <class Sink>
void Gatherer<Sink>::path_on(const Ray& ray, Hit end, Through through, uint32_t seed, Way way, float cosine) {
    for (;; end = go_on(ray, end, way)) {
        if constexpr (Sink::kSwitches) {
            std::vector<Hit> switches;
            find_switches(ray, end, way, switches);
            if (!path_switches(ray, switches, 0, end, through, seed, way, cosine)) return;
        } else if (!path_end(ray, end, through, seed, way, cosine)) {
            return;
        }
    }
}

template <class Sink>
bool Gatherer<Sink>::path_end(const Ray& ray, const Hit& hit, Through& through, uint32_t seed, Way& way, float cosine) {
    if (hit.triangle != kMiss) return path_shine(ray, hit, through, seed, way, cosine);
    if (o.unmapped_direct && g.emitters.sky_emitter() == EmitterSet::kNone && g.scene.sky.lit())
        sink.light(through, kNoElement, g.scene.sky.radiance(ray.direction));
    return false;
}

template <class Sink>
bool Gatherer<Sink>::path_switches(const Ray& ray, const std::vector<Hit>& switches, size_t next, const Hit& end,
                                   Through& through, uint32_t seed, Way& way, float cosine) {
    if constexpr (Sink::kSwitches) {
        for (; next < switches.size(); ++next) {
            const Presence p = g.scene.presence(switches[next].triangle);
            const uint32_t own_seed = hash_combine(seed, 0x55u + static_cast<uint32_t>(next));
            if ((g.surfaces.flags(switches[next].triangle) & SurfaceTable::kTransmits) != 0 &&
                !through.condition.follows(p.element)) {
                const auto shines = [&](Through& there, Way& behind) {
                    return path_shine(ray, switches[next], there, own_seed, behind, cosine);
                };
                if (!pass_unfollowed(p, through, way, shines)) return false;
                continue;
            }
            Through there = through;
            Way behind = way;
            const bool splits_here = there.condition.require(g.scene.elements, p);
            splits += splits_here;
            if (splits_here && path_shine(ray, switches[next], there, own_seed, behind, cosine) &&
                path_switches(ray, switches, next + 1, end, there, own_seed, behind, cosine))
                path_on(ray, go_on(ray, end, behind), there, own_seed, behind, cosine);
            if (!through.condition.require(g.scene.elements, p.opposite())) return false;
        }
    }
    return path_end(ray, end, through, seed, way, cosine);
}

template <class Sink>
bool Gatherer<Sink>::path_shine(const Ray& ray, const Hit& hit, Through& through, uint32_t seed, Way& way,
                                float cosine) {
    const uint8_t f = g.surfaces.flags(hit.triangle);
    if (is_inside(hit, f)) return false;
    const bool mapped = !hit.back && !(f & SurfaceTable::kUnmapped);
    if (mapped && !(f & (SurfaceTable::kEmits | SurfaceTable::kTransmits))) {
        if (sink.has_texels()) sink.texel(through, lit_texel(ray, hit), 1.0f);
        return false;
    }
    const SurfaceSample s = g.scene.surface(hit.triangle, hit.u, hit.v);
    if (o.unmapped_direct && (f & SurfaceTable::kEmits) != 0)
        sink.light(through, g.scene.instance_of(hit.triangle).light_set, s.emission * ray_share(ray, hit, cosine));
    const bool first = way.segments == 0 && !is_switch(hit) && has_spots();
    if (mapped) {
        if (sink.has_texels()) sink.texel(through, lit_texel(ray, hit), 1.0f);
        return max_component(s.transmittance) > 0.0f && dims(hit, s, through, seed, way);
    }
    // Russian roulette by reflectance and transmittance: on average no more ways leave a surface than meet it.
    const float back = max_component(s.reflectance), on = max_component(s.transmittance);
    const float all = std::max(back + on, 1.0f), goes_on = on / all;
    unmapped(ray, hit, through, s.reflectance, back / all * chance_to_branch(), hash_combine(seed, way.segments),
             {first ? cosine * kInvPi : 0.0f, kChainSpots});
    if (!(unit_float(hash_combine(seed, hit.triangle)) < goes_on)) return false;
    through.color *= s.transmittance / goes_on;
    return max_component(through.color) > 0.0f;
}

template <class Sink>
float Gatherer<Sink>::ray_share(const Ray& ray, const Hit& hit, float cosine) const {
    if (g.emitters.emitter_of(hit.triangle) == EmitterSet::kNone) return 1.0f;
    const float facing = std::abs(glm::dot(ray.direction, g.scene.geometric_normal(hit.triangle)));
    const float own = cosine * kInvPi;
    return own / (own + g.emitters.triangle_pdf(hit.triangle, {hit.u, hit.v}, hit.t, facing));
}

} // namespace ajar
