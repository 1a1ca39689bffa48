// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/direct.h"

#include "base/owen_sobol.h"
#include "sampling/warp.h"
#include "transport/light_sink.h"
#include "transport/near_lamp.h"
#include "transport/shadow.h"

namespace ajar {

namespace {

constexpr uint32_t kProbes = 2; ///< samples of each receiver of a packet that decide whether the others are worth it
constexpr float kGoOn = 0.25f;  ///< chance of a packet to go on although they found nothing

/// Samples per position from which on they spread over its cell. Fewer are evener at the positions themselves: the edge
/// of a toggle's shadow, which few samples look for, was 1.3 times as noisy.
constexpr uint32_t kCellSamples = 4;

/// Numbers that n samples take up: pairs never share them with other samples.
constexpr uint32_t even(uint32_t n) { return (n + 1) & ~1u; }

/// A point of a position's part of the texel, one of a sequence over a receiver's samples: what is left of the number
/// that chose among the positions, and multiples of the plastic number's inverse (Roberts 2018).
Vec2 place_in_cell(uint32_t sample, uint32_t hash, float chosen, uint32_t positions) {
    const float scaled = chosen * static_cast<float>(positions);
    return {scaled - std::floor(scaled), unit_float(hash + sample * 0xc13fa9a9u)};
}

/// Eight receivers' samples that wait for their shadow rays.
struct ShadowPacket {
    RayPacket rays;
    alignas(32) int32_t valid[kLanes];
    EmitterSample sample[kLanes];
    PacketDirections local;
    float book_scale = 1.0f; ///< of what is booked
    uint32_t crossing = 0;   ///< bits of lanes that meet a switchable surface
    bool arrived = false;    ///< some sample so far was not blocked
    bool moved = false;      ///< samples of positions that switchable solids cover, from where they are moved to
    float scale[kLanes];
    uint32_t emitter[kLanes];
    bool lit[kLanes];
    Presence covered[kLanes]; ///< whether a switchable solid must be there; element kNoElement: none
};

/// The emitter that a sample goes to.
struct Pick {
    uint32_t emitter;
    float chance; ///< that it was picked
    Vec2 u;       ///< for the place on it
    float spread; ///< the sequence's other number, for the place on the receiver
};

template <class Sink>
struct DirectSampler {
    const GatherScene& g;
    const DirectGroups::Group& group;
    const Tile& tile;
    MisCounts mis;
    uint32_t seed;
    PacketChoice packets;
    Sink sink;
    uint32_t first_sample = 0; ///< number of the first sample in the sums
    bool mean = false;         ///< book means over the samples, not sums
    bool thrifty = false;
    uint64_t rays = 0;
    Worker& worker = Worker::mine();

    void shoot(ShadowPacket& packet, uint32_t first, uint32_t begin, uint32_t end);
    bool has_moved(uint32_t first) const;
    Pick pick(uint32_t local, uint32_t sample, uint32_t samples) const;
    bool prepare(uint32_t local, uint32_t sample, uint32_t samples, const Pick& picked, ShadowPacket& packet,
                 uint32_t lane) const;
    EmitterSample sample_from(uint32_t r, uint32_t position, const Vec3& p, const Pick& picked, const Vec2& place,
                              uint32_t samples, LampStart& start) const;
    bool start_at(uint32_t receiver, uint32_t position, ShadowPacket& packet, uint32_t lane, Vec3& p) const;
    void trace(ShadowPacket& packet, uint32_t first, uint32_t sample, uint32_t samples, uint32_t number);
    void finish(ShadowPacket& packet, uint32_t first, uint32_t number);
    void arrive(const ShadowPacket& packet, uint32_t lane, uint32_t receiver);
    uint64_t run();
};

/// Origin p of a position's sample, and what must be there for it; false if there is none.
template <class Sink>
bool DirectSampler<Sink>::start_at(uint32_t receiver, uint32_t position, ShadowPacket& packet, uint32_t lane,
                                   Vec3& p) const {
    p = g.receivers.origins(receiver)[position];
    if constexpr (Sink::kSwitches) {
        const MovedPosition m = g.receivers.moved_from(receiver, position);
        if (packet.moved) p = m.origin;
        packet.covered[lane] = {m.presence.element, m.presence.state == packet.moved};
        return !packet.moved || m.exists();
    }
    return true;
}

template <class Sink>
Pick DirectSampler<Sink>::pick(uint32_t local, uint32_t sample, uint32_t samples) const {
    const uint32_t h = hash_combine(seed, g.receivers.texel[tile.first + local]);
    // The samples of one emitter follow each other: they divide its first coordinate evenly among them, and
    // the sequence spreads the second and the positions over any few in a row.
    float u = (static_cast<float>(sample) + unit_float(hash_combine(h, sample))) / static_cast<float>(samples), chance;
    const uint32_t emitter = group.choice.pick(local, u, chance);
    const Vec2 spread = owen_sobol(sample, h);
    const Vec2 place(u, spread.x);
    g.emitters.prefetch(emitter, place);
    return {emitter, chance, place, spread.y};
}

/// A sample of the picked emitter; start: of its ray, on the position's part of the texel, and a factor of its weight.
template <class Sink>
EmitterSample DirectSampler<Sink>::sample_from(uint32_t r, uint32_t position, const Vec3& p, const Pick& picked,
                                               const Vec2& place, uint32_t samples, LampStart& start) const {
    const uint32_t emitter = picked.emitter;
    const Light* lamp = g.emitters.lamp(emitter);
    const bool open = g.receivers.open[r] != 0, close = lamp != nullptr && is_close(g.receivers, r, p, *lamp);
    if (open && close) {
        start = lamp_start(g.receivers, r, position, p, *lamp, place);
        if (start.wide) return g.emitters.sample_wide(emitter, start.point, picked.u);
        if (start.near) return g.emitters.sample(emitter, start.point, picked.u);
    }
    const bool in_cell = open && samples >= kCellSamples * g.receivers.positions_per_texel;
    start = {in_cell ? g.receivers.in_cell(r, position, place) : p};
    const bool narrow = g.emitters.is_narrow(emitter);
    EmitterSample s = g.emitters.sample(emitter, narrow ? start.point : p, picked.u);
    if (!close || !is_near_lamp(g.receivers, r, s)) return s;
    if (narrow) s = g.emitters.sample(emitter, p, picked.u);
    start.weight = near_lamp_factor(g.receivers, r, position, p, s);
    return s;
}

template <class Sink>
bool DirectSampler<Sink>::prepare(uint32_t local, uint32_t sample, uint32_t samples, const Pick& picked,
                                  ShadowPacket& packet, uint32_t lane) const {
    const uint32_t r = tile.first + local, emitter = picked.emitter;
    const uint32_t h = hash_combine(seed, g.receivers.texel[r]);
    worker.set(g.emitters.effect(emitter));
    const uint32_t positions = g.receivers.positions_per_texel,
                   position =
                       std::min(static_cast<uint32_t>(picked.spread * static_cast<float>(positions)), positions - 1);
    Vec3 p;
    if (!start_at(r, position, packet, lane, p)) return false;
    const Vec2 place = place_in_cell(sample, h, picked.spread, positions);
    LampStart start;
    EmitterSample s = sample_from(r, position, p, picked, place, samples, start);
    const Vec3 w = g.receivers.frame[r].to_local(s.direction);
    if (!(w.z > 0.0f) || !(max_component(s.weight) > 0.0f) || !g.receivers.is_above(r, position, s.direction))
        return false;
    const float own = static_cast<float>(samples) * s.pdf * picked.chance;
    float rays = mis.gather * hemisphere_pdf(w.z, mis.share); // per steradian
    if (mis.aims != nullptr) rays += mis.aims->density(local, position, s.direction);
    const float weight = s.pdf > 0.0f ? own / (own + rays) : start.weight;
    packet.scale[lane] = weight / picked.chance;
    packet.emitter[lane] = emitter;
    packet.local.set(lane, w, packet.book_scale);
    packet.lit[lane] = !s.casts_shadow;
    if (start.point != p) s.see_from(start.point);
    packet.sample[lane] = s;
    packet.rays.set(lane, start.point, s.direction, shadow_end(g.tracer, s));
    return is_finite(s.weight * packet.scale[lane]);
}

/// Books the unblocked sample of a lane under the conditions of its way.
template <class Sink>
void DirectSampler<Sink>::arrive(const ShadowPacket& packet, uint32_t lane, uint32_t receiver) {
    const EmitterSample& s = packet.sample[lane];
    auto through = sink.start(g.scene, g.receivers.triangle[receiver]);
    if constexpr (Sink::kSwitches)
        for (const Presence& p : {packet.covered[lane], g.emitters.presence(packet.emitter[lane])})
            if (p.element != kNoElement && !through.condition.require(g.scene.elements, p)) return;
    const auto book = [&](const auto& way) {
        // A bright texel's weight is its whole radiance over the density; its terms share it.
        if (s.texel != kNoReceiver && sink.has_texels())
            sink.texel(way, s.texel, packet.scale[lane] * s.inverse_density);
        else
            sink.light(way, group.set, s.weight * packet.scale[lane]);
    };
    if (packet.lit[lane]) return book(through);
    const Ray ray{
        {packet.rays.ox[lane], packet.rays.oy[lane], packet.rays.oz[lane]}, s.direction, 0.0f, shadow_end(g.tracer, s)};
    through_shadow<Sink>(g.scene, g.tracer, ray, through, book, (packet.crossing >> lane & 1) != 0);
}

template <class Sink>
void DirectSampler<Sink>::finish(ShadowPacket& packet, uint32_t first, uint32_t number) {
    for (uint32_t lane = 0; lane < kLanes && first + lane < tile.count; ++lane) {
        if (packet.valid[lane] != 0 && (packet.lit[lane] || packet.rays.tfar[lane] >= 0.0f)) {
            packet.arrived = true;
            arrive(packet, lane, tile.first + first + lane);
        }
        sink.end_sample(lane, first + lane, first_sample + number, packet.local);
    }
    sink.end_packet(first, first_sample + number, packet.local);
}

/// Sample number sample of the receivers of one packet, booked as number.
template <class Sink>
void DirectSampler<Sink>::trace(ShadowPacket& packet, uint32_t first, uint32_t sample, uint32_t samples,
                                uint32_t number) {
    packet.rays.prepare(kMaskShadowOpaque);
    Pick picked[kLanes];
    for (uint32_t lane = 0; lane < kLanes && first + lane < tile.count; ++lane)
        picked[lane] = pick(first + lane, sample, samples);
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
        packet.valid[lane] =
            first + lane < tile.count && prepare(first + lane, sample, samples, picked[lane], packet, lane) ? -1 : 0;
        if (packet.valid[lane] == 0) packet.rays.set(lane, Vec3(0.0f), Vec3(0, 0, 1), 0.0f);
        rays += packet.valid[lane] != 0;
    }
    g.tracer.occluded(packet.valid, packet.rays);
    if (Sink::kSwitches) packet.crossing = g.tracer.crossing(packet.valid, packet.rays, kMaskShadowSwitch);
    finish(packet, first, number);
}

template <class Sink>
bool DirectSampler<Sink>::has_moved(uint32_t first) const {
    const uint32_t end = std::min(first + kLanes, tile.count);
    for (uint32_t i = first; Sink::kSwitches && i < end; ++i)
        if (g.receivers.has_moved(tile.first + i)) return true;
    return false;
}

/// Samples begin to end of the receivers of one packet. Those of moved positions have numbers of their own, so
/// that pairs of samples stay pairs.
template <class Sink>
void DirectSampler<Sink>::shoot(ShadowPacket& packet, uint32_t first, uint32_t begin, uint32_t end) {
    const uint32_t samples = group.samples_at(first);
    packet.moved = false;
    for (uint32_t sample = begin; sample < end; ++sample) trace(packet, first, sample, samples, sample);
    if (!has_moved(first)) return;
    packet.moved = true;
    for (uint32_t sample = begin; sample < end; ++sample) trace(packet, first, sample, samples, even(samples) + sample);
}

template <class Sink>
uint64_t DirectSampler<Sink>::run() {
    const Working here(worker.effect());
    ShadowPacket packet{};
    for (uint32_t first = 0; first < tile.count; first += kLanes) {
        if (!packets.has(first)) continue;
        g.progress.check_cancel();
        const uint32_t samples = group.samples_at(first);
        packet.book_scale = mean ? 1.0f / static_cast<float>(samples) : 1.0f;
        packet.arrived = false;
        const uint32_t probes = thrifty && samples > 4 * kProbes ? kProbes : samples;
        shoot(packet, first, 0, probes);
        if (probes == samples) continue;
        if (!packet.arrived) {
            if (unit_float(hash_combine(seed, g.receivers.texel[tile.first + first])) >= kGoOn) continue;
            packet.book_scale /= kGoOn;
        }
        shoot(packet, first, probes, samples);
    }
    return rays;
}

/// Every group of a tile, each as the mean over its own samples.
template <class Sink>
uint64_t run_groups(const GatherScene& scene, const DirectGroups& groups, const Tile& tile, const MisCounts& mis,
                    uint32_t seed, bool thrifty, const Sink& sink) {
    uint64_t rays = 0;
    uint32_t first_sample = 0;
    for (const DirectGroups::Group& g : groups.groups()) {
        if (g.samples == 0) continue;
        const bool is_set = g.set != kNoElement;
        const uint32_t own_seed = is_set ? hash_combine(seed, g.set) : seed;
        rays +=
            DirectSampler<Sink>{scene, g, tile, mis, own_seed, {}, sink, first_sample, true, thrifty && is_set}.run();
        first_sample += 2 * even(g.samples); // samples of two groups never make a pair
    }
    return rays;
}

} // namespace

uint64_t sample_direct(const GatherScene& scene, const DirectGroups::Group& group, const Tile& tile,
                       const MisCounts& mis, uint32_t seed, PacketChoice packets, TileSums& sums) {
    if (group.samples == 0) return 0;
    return DirectSampler<PlainSink>{scene, group, tile, mis, seed, packets, PlainSink(nullptr, sums)}.run();
}

uint64_t sample_direct(const GatherScene& scene, const DirectGroups& groups, const Tile& tile, const MisCounts& mis,
                       uint32_t seed, bool thrifty, const TermRows* rows, const TermLimits& limits, TermSums& sums) {
    if (scene.scene.has_switches())
        return run_groups(scene, groups, tile, mis, seed, thrifty, TermSink<true>(scene.scene, rows, limits, sums));
    return run_groups(scene, groups, tile, mis, seed, thrifty, TermSink<false>(scene.scene, rows, limits, sums));
}

} // namespace ajar
