// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The gather kernel, a template over the sink (light_sink.h). What follows a ray from surface to surface without
// lightmap is in unmapped_chain.h.

#include "base/owen_sobol.h"
#include "transport/light_sink.h"
#include "transport/shadow.h"
#include "transport/tile_rays.h"

namespace ajar {

template <class Sink>
struct Gatherer {
    using Through = typename Sink::Through;
    static constexpr float kNearTexels = 4.0f; ///< a solid's inside closer than this speaks for an invalid receiver
    static constexpr uint32_t kNoTexel = 0xffffffffu;
    static constexpr float kChainSplits =
        16.0f; ///< ways that switchable surfaces split a chain into before chance ends some
    /// Gather rays of a receiver per place that is drawn from the lamps' side, and how often a chain draws one. With
    /// 256 rays, by way of the ceiling of a 4 x 4 x 3 m room, texels have 4.0 % of noise from a lamp 0.2 m and 4.4 %
    /// from one 5 cm under it, and 3.6 % from one 1.5 m under it, which needs no such places.
    static constexpr uint32_t kRaysPerSpot = 8;
    static constexpr float kChainSpots = 0.25f;
    /// Places that such draws choose less often than gather rays, by this factor, are left to the rays.
    static constexpr float kRareSpot = 0.05f;

    const GatherScene& g;
    const GatherOptions& o;
    const Tile& tile;
    Sink sink;
    float mis_gather; ///< rays over the hemisphere, per receiver
    uint64_t rays = 0;
    uint32_t splits = 0; ///< of the present stand-in's chain, by switchable surfaces
    TileRays tile_rays;
    Worker& worker = Worker::mine();
    Effect own;      ///< what ordinary rays count as
    uint8_t special; ///< surfaces with such a flag take the long way

    /// Where a gather ray comes from.
    struct Origin {
        uint32_t local;
        uint32_t sample;
        float weight; ///< inverse density of the ray, as if the hemisphere's rays were all, sr
    };

    /// What lies behind a ray on its way through layers.
    struct Way {
        Passed passed;         ///< fixed surfaces
        LayerChance chance;    ///< of going on
        float start = 0.0f;    ///< switchable surfaces up to here are behind
        uint32_t segments = 0; ///< between fixed surfaces
    };

    /// A packet on its way. The light it met is read after the next one is traced: by then it has come from memory.
    struct Flight {
        RayPacket packet;
        PacketDirections local;
        alignas(32) int32_t valid[kLanes];
        uint32_t texel[kLanes];    ///< whose light an ordinary hit sees, or kNoTexel
        uint32_t position[kLanes]; ///< of the receiver's
        uint32_t first, sample;
        bool waits = false;
        uint32_t crossing = 0; ///< bits of lanes that meet a switchable surface before their hit

        bool crosses(uint32_t lane) const { return Sink::kSwitches && (crossing >> lane & 1) != 0; }
    };
    Flight flights[2];
    uint32_t turn = 0;

    Gatherer(const GatherScene& scene, const GatherOptions& options, const Tile& t, const Sink& s)
        : g(scene),
          o(options),
          tile(t),
          sink(s),
          mis_gather(static_cast<float>(options.samples)),
          tile_rays(scene.receivers, t, options.share, options.seed),
          own(s.has_texels()                            ? Effect::bounces
              : scene.emitters.emissive_triangles() > 0 ? Effect::emissive_surfaces
                                                        : Effect::sky),
          special(SurfaceTable::kTransmits | SurfaceTable::kUnmapped |
                  (options.emission ? SurfaceTable::kEmits : SurfaceTable::kPlain)) {}

    void run() {
        const Working here(own);
        const uint32_t count = std::min(o.samples, StratifiedBatch::kRays);
        for (uint32_t begin = 0; begin < o.samples; begin += count) {
            g.progress.check_cancel();
            tile_rays.begin(o.first_sample + begin, count, begin / StratifiedBatch::kRays, o.packets);
            // Strata of all receivers together keep rays close, those of few receivers their many sums.
            const uint32_t together = Sink::kTogether < count ? Sink::kTogether : count;
            for (uint32_t part = 0; part < count; part += together)
                for (uint32_t first = 0; first < tile.count; first += kLanes)
                    for (uint32_t s = part; o.packets.has(first) && s < part + together; ++s)
                        shoot(first, s, begin + s);
        }
        uint32_t sample = o.samples;
        if (o.aims != nullptr) own = Effect::doors;
        for (uint32_t aim = 0; o.aims != nullptr && aim < o.aims->count(); ++aim)
            for (uint32_t s = 0; s < o.aims->rays(aim); ++s, ++sample)
                for (uint32_t first = 0; first < tile.count; first += kLanes)
                    if (o.packets.has(first)) shoot_aimed(first, aim, s, sample);
        land(flights[turn ^ 1]);
        if (has_spots())
            for (uint32_t s = 0; s < spots_per_receiver(); ++s, ++sample)
                for (uint32_t first = 0; first < tile.count; first += kLanes)
                    if (o.packets.has(first)) receive_spots(first, s, sample);
    }

    void shoot(uint32_t first, uint32_t stratum, uint32_t sample) {
        const uint32_t count = std::min(kLanes, tile.count - first);
        Flight& f = flights[turn];
        for (uint32_t lane = 0; lane < kLanes; ++lane) f.valid[lane] = lane < count ? -1 : 0;
        tile_rays.aim(first, stratum, f.packet, f.local, f.position);
        if (!g.receivers.plane_row.empty()) leave_out_below(first, count, f);
        if (o.aims != nullptr)
            for (uint32_t lane = 0; lane < count; ++lane) {
                const float aimed = o.aims->density(first + lane, f.position[lane], f.packet.direction(lane));
                f.local.weight[lane] = mis_gather / (mis_gather / f.local.weight[lane] + aimed);
            }
        trace(first, sample);
    }

    /// Rays that point below their surface bring nothing, but count as samples.
    void leave_out_below(uint32_t first, uint32_t count, Flight& f) const {
        for (uint32_t lane = 0; lane < count; ++lane)
            if (!g.receivers.is_above(tile.first + first + lane, f.position[lane], f.packet.direction(lane)))
                f.valid[lane] = 0;
    }

    /// One ray from each receiver of a packet into a box.
    void shoot_aimed(uint32_t first, uint32_t aim, uint32_t number, uint32_t sample) {
        Flight& f = flights[turn];
        for (uint32_t lane = 0; lane < kLanes; ++lane) {
            f.valid[lane] = first + lane < tile.count && aim_lane(first + lane, lane, aim, number, f) ? -1 : 0;
            if (f.valid[lane] != 0) continue;
            f.packet.set(lane, Vec3(0.0f), Vec3(0, 0, 1), 0.0f);
            f.local.set(lane, Vec3(0, 0, 1), 0.0f);
        }
        trace(first, sample);
    }

    bool aim_lane(uint32_t i, uint32_t lane, uint32_t aim, uint32_t number, Flight& f) const {
        const uint32_t r = tile.first + i, h = hash_combine(hash_combine(o.seed, g.receivers.texel[r]), aim);
        const uint32_t position = (number + h) % g.receivers.positions_per_texel;
        // Positions follow the low bits of the number, so the points in the box must not.
        const Vec2 u = owen_sobol(shuffle_index(number, h ^ 0x9e3779b9u), h);
        Vec3 direction;
        if (!o.aims->sample(aim, i, position, u, direction)) return false;
        const Vec3 w = g.receivers.frame[r].to_local(direction);
        if (!(w.z > 0.0f) || !g.receivers.is_above(r, position, direction)) return false;
        const float density = mis_gather * hemisphere_pdf(w.z, o.share) + o.aims->density(i, position, direction);
        f.position[lane] = position;
        f.local.set(lane, w, mis_gather / density);
        f.packet.set(lane, g.receivers.origins(r)[position], direction, std::numeric_limits<float>::infinity());
        return true;
    }

    void trace(uint32_t first, uint32_t sample) {
        Flight& f = flights[turn];
        f.first = first, f.sample = sample, f.waits = true;
        f.packet.prepare(kMaskGather);
        g.tracer.intersect(f.valid, f.packet);
        if (Sink::kSwitches) f.crossing = g.tracer.crossing(f.valid, f.packet, kMaskGatherSwitch);
        fetch(f, std::min(kLanes, tile.count - first));
        turn ^= 1;
        land(flights[turn]);
    }

    void land(Flight& f) {
        if (!f.waits) return;
        f.waits = false;
        const uint32_t count = std::min(kLanes, tile.count - f.first);
        for (uint32_t lane = 0; lane < count; ++lane) {
            if (f.valid[lane] == 0) continue;
            ++rays;
            shade(lane, f);
            sink.end_sample(lane, f.first + lane, f.sample, f.local);
            worker.set(own);
        }
        sink.add_cosines(f.first, count, f.local);
        sink.end_packet(f.first, f.sample, f.local);
    }

    /// Calls for what the lanes will read from all over memory, so that they wait for it together.
    /// Most rays meet an ordinary lightmapped surface.
    void fetch(Flight& f, uint32_t count) const {
        std::fill(std::begin(f.texel), std::end(f.texel), kNoTexel);
        if (!sink.has_texels()) return;
        for (uint32_t lane = 0; lane < count; ++lane) {
            const uint32_t t = f.packet.triangle[lane];
            if (t == kMiss || f.crosses(lane) || (g.surfaces.flags(t) & special) != 0 || is_back(f.packet, lane))
                continue;
            f.texel[lane] = g.surfaces.texel(t, f.packet.u[lane], f.packet.v[lane]);
            sink.fetch(f.texel[lane]);
        }
    }

    bool is_back(const RayPacket& packet, uint32_t lane) const {
        return g.surfaces.back(packet.triangle[lane], packet.direction(lane), packet.normal(lane));
    }

    void shade(uint32_t lane, const Flight& f) {
        const RayPacket& packet = f.packet;
        const uint32_t triangle = packet.triangle[lane], texel = f.texel[lane], local = f.first + lane;
        Through through = sink.start(g.scene, g.receivers.triangle[tile.first + local]);
        if (!shade_moved(lane, f, through)) return;
        if (texel != kNoTexel && sink.flags(texel) == 0) return sink.texel(through, texel, 1.0f);
        const Ray ray{{packet.ox[lane], packet.oy[lane], packet.oz[lane]}, packet.direction(lane)};
        const Hit hit{triangle, packet.u[lane], packet.v[lane], packet.tfar[lane],
                      triangle != kMiss && is_back(packet, lane)};
        const Origin from{local, f.sample, f.local.weight[lane]};
        if (texel != kNoTexel) return first_hit(ray, hit, through, from);
        walk(ray, hit, through, from, {}, f.crosses(lane));
    }

    /// The ray of a position that a switchable solid covers, from where it is moved to while the solid is there.
    /// Leaves the position's own ray the other case; false if it has none.
    bool shade_moved(uint32_t lane, const Flight& f, Through& through) {
        if constexpr (Sink::kSwitches) {
            const uint32_t local = f.first + lane;
            const MovedPosition moved = g.receivers.moved_from(tile.first + local, f.position[lane]);
            if (!moved.exists()) return true;
            Through there = through;
            if (there.condition.require(g.scene.elements, moved.presence)) {
                worker.set(effect_of(g.scene, moved.presence));
                const Ray ray{moved.origin, f.packet.direction(lane)};
                ++rays;
                walk(ray, g.tracer.intersect(ray, kMaskGather), there, {local, f.sample, f.local.weight[lane]}, {});
            }
            return through.condition.require(g.scene.elements, moved.presence.opposite());
        }
        return true;
    }

    /// The general case: emission, layers of transmissive and switchable surfaces, back faces.
    /// hit: the nearest of what is always there. crosses: switchable surfaces may lie before it.
    void walk(const Ray& ray, Hit hit, Through through, const Origin& from, Way way, bool crosses = true) {
        for (;; crosses = true) {
            std::vector<Hit> switches;
            if (Sink::kSwitches && crosses) {
                find_switches(ray, hit, way, switches);
                if (!switches.empty()) worker.set(effect_of(g.scene, g.scene.presence(switches.front().triangle)));
            }
            if (switches.empty() ? !end_segment(ray, hit, through, from, way)
                                 : !pass_switches(ray, switches, 0, hit, through, from, way))
                return;
            hit = go_on(ray, hit, way);
        }
    }

    /// Switchable surfaces between those that the ray has passed and the fixed one it meets.
    void find_switches(const Ray& ray, const Hit& end, const Way& way, std::vector<Hit>& switches) const {
        Ray part = ray;
        part.tnear = way.start;
        if (end.triangle != kMiss) part.tfar = end.t;
        g.tracer.all_switches(part, kMaskGatherSwitch, switches);
    }

    /// The next fixed surface behind one that lets light through.
    Hit go_on(const Ray& ray, const Hit& passed, Way& way) {
        g.tracer.pass(passed, way.passed);
        way.start = std::max(way.start, passed.t);
        ++way.segments;
        ++rays;
        return g.tracer.next(ray, kMaskGather, way.passed);
    }

    /// What lies at the end of a stretch without switchable surfaces; true if the ray goes on.
    bool end_segment(const Ray& ray, const Hit& hit, Through& through, const Origin& from, Way& way) {
        if (hit.triangle == kMiss) {
            sky(ray.direction, through, from);
            return false;
        }
        return meet_fixed(ray, hit, g.surfaces.flags(hit.triangle), through, from, way);
    }

    /// Switchable surfaces from number next on, then the fixed hit behind them. A way that goes on
    /// behind a surface which is there is followed to its end here; true if the plain one goes on.
    bool pass_switches(const Ray& ray, const std::vector<Hit>& switches, size_t next, const Hit& end, Through& through,
                       const Origin& from, Way& way) {
        if constexpr (Sink::kSwitches) {
            for (; next < switches.size(); ++next) {
                const Hit& hit = switches[next];
                const Presence p = g.scene.presence(hit.triangle);
                const uint8_t f = g.surfaces.flags(hit.triangle);
                if ((f & SurfaceTable::kTransmits) != 0 && !through.condition.follows(p.element)) {
                    const auto shines = [&](Through& there, Way& behind) {
                        return !is_inside(hit, f) && shine(ray, hit, f, there, from, behind);
                    };
                    if (!pass_unfollowed(p, through, way, shines)) return false;
                    continue;
                }
                Through there = through;
                Way behind = way;
                if (there.condition.require(g.scene.elements, p) && !is_inside(hit, f) &&
                    shine(ray, hit, f, there, from, behind) &&
                    pass_switches(ray, switches, next + 1, end, there, from, behind))
                    walk(ray, go_on(ray, end, behind), there, from, behind);
                if (!through.condition.require(g.scene.elements, p.opposite())) return false;
            }
        }
        return end_segment(ray, end, through, from, way);
    }

    /// A see-through surface whose element the way does not follow: the way goes on in one, with what passes at the
    /// start. shines(there, behind): light of the surface itself; whether some goes through it. False if none goes on.
    template <class Shines>
    bool pass_unfollowed(const Presence& p, Through& through, Way& way, const Shines& shines) const {
        const float share = presence_factors(g.scene.elements[p.element], p.state).constant;
        Through there = through;
        Way behind = way;
        const bool passes = share > 0.0f && there.condition.require(g.scene.elements, p) && shines(there, behind);
        if (share > 0.0f) way = behind;
        through.color = (1.0f - share) * through.color + (passes ? share * there.color : Vec3(0.0f));
        through.condition.leave_at_start(p.element);
        return max_component(through.color) > 0.0f;
    }

    /// Light of a surface that is always there; true if some goes through it.
    bool meet_fixed(const Ray& ray, const Hit& hit, uint8_t f, Through& through, const Origin& from, Way& way) {
        if (is_inside(hit, f)) {
            if (hit.t < kNearTexels * g.receivers.texel_size[tile.first + from.local]) sink.add_inside(from.local);
            return false;
        }
        return shine(ray, hit, f, through, from, way);
    }

    static bool is_inside(const Hit& hit, uint8_t f) {
        return hit.back && (f & (SurfaceTable::kOneSided | SurfaceTable::kSolid)) != 0;
    }

    /// What a surface sends along the ray; true if light from behind gets through, dimmed.
    bool shine(const Ray& ray, const Hit& hit, uint8_t f, Through& through, const Origin& from, Way& way) {
        const bool mapped = !hit.back && !(f & SurfaceTable::kUnmapped);
        if (mapped && !(f & SurfaceTable::kTransmits)) {
            if (o.emission && (f & SurfaceTable::kEmits))
                emission(g.scene.emission(hit.triangle, hit.u, hit.v), ray, hit, through, from);
            first_hit(ray, hit, through, from);
            return false;
        }
        if (const uint32_t r = plain_receiver(hit, f); r != kNoReceiver) {
            stand_in(ray, hit, through, g.receivers.albedo[r], from, way);
            return false;
        }
        if ((f & SurfaceTable::kTransmits) != 0 && worker.effect() == own) worker.set(Effect::transparency);
        const SurfaceSample s = g.scene.surface(hit.triangle, hit.u, hit.v);
        if (f & SurfaceTable::kEmits) emission(s.emission, ray, hit, through, from);
        if (mapped)
            first_hit(ray, hit, through, from);
        else
            stand_in(ray, hit, through, s.reflectance, from, way);
        return max_component(s.transmittance) > 0.0f && dims(hit, s, through, seed_of(from), way);
    }

    /// Light that goes on through a surface; false if none does.
    bool dims(const Hit& hit, const SurfaceSample& s, Through& through, uint32_t seed, Way& way) const {
        return way.chance.pass(through.color, s.transmittance, unit_float(hash_combine(seed, hit.triangle)));
    }

    /// Receiver of the texel of a surface that neither glows nor lets light through: its back reflects as its front.
    uint32_t plain_receiver(const Hit& hit, uint8_t f) const {
        if ((f & (SurfaceTable::kUnmapped | SurfaceTable::kTransmits | SurfaceTable::kEmits)) != 0) return kNoReceiver;
        return g.receivers.of_texel[g.surfaces.texel(hit.triangle, hit.u, hit.v)];
    }

    /// What stands in for stored light where a gather ray meets a surface without it.
    void stand_in(const Ray& ray, const Hit& hit, const Through& through, const Vec3& reflectance, const Origin& from,
                  const Way& way) {
        splits = 0;
        const bool first = way.segments == 0 && !is_switch(hit) && takes_spots(from.local);
        const Sender sender{first ? mis_gather / from.weight : 0.0f, static_cast<float>(spots_per_receiver())};
        unmapped(ray, hit, through, reflectance, 1.0f, hash_combine(seed_of(from), way.segments), sender);
    }

    uint32_t seed_of(const Origin& from) const {
        return hash_combine(hash_combine(o.seed, g.receivers.texel[tile.first + from.local]), from.sample);
    }

    float mis_weight(uint32_t emitter, float density, const Origin& from) const {
        if (o.direct == nullptr) return 0.0f; // emitter samples were all: none asked here
        return mis_gather / (mis_gather + from.weight * density * o.direct->expected(from.local, emitter));
    }

    void sky(const Vec3& w, const Through& through, const Origin& from) {
        const Sky& s = g.scene.sky;
        if (!o.emission || !s.lit()) return;
        const uint32_t e = g.emitters.sky_emitter();
        const float weight = e == EmitterSet::kNone ? 1.0f : mis_weight(e, g.emitters.sky_pdf(w), from);
        sink.light(through, kNoElement, s.radiance(w) * weight);
    }

    void emission(const Vec3& radiance, const Ray& ray, const Hit& hit, const Through& through, const Origin& from) {
        if (!o.emission) return;
        const uint32_t e = g.emitters.emitter_of(hit.triangle);
        float weight = 1.0f;
        if (e != EmitterSet::kNone) {
            const float facing = std::abs(glm::dot(ray.direction, g.scene.geometric_normal(hit.triangle)));
            weight = mis_weight(e, g.emitters.triangle_pdf(hit.triangle, {hit.u, hit.v}, hit.t, facing), from);
        }
        sink.light(through, g.scene.instance_of(hit.triangle).light_set, radiance * weight);
    }

    /// What a lightmapped surface sends to a receiver. Bright texels share it with the emitter
    /// samples that aim at them.
    void first_hit(const Ray& ray, const Hit& hit, const Through& through, const Origin& from) {
        if (!sink.has_texels()) return;
        const uint32_t texel = lit_texel(ray, hit);
        float weight = 1.0f, density = 0.0f;
        if ((sink.flags(texel) & kTexelBright) != 0 && o.direct != nullptr)
            if (const uint32_t e = g.emitters.bright_emitter(texel, hit.triangle, density); e != EmitterSet::kNone) {
                const float facing =
                    std::max(std::abs(glm::dot(ray.direction, g.scene.geometric_normal(hit.triangle))), 1e-9f);
                weight = mis_weight(e, density * hit.t * hit.t / facing, from);
            }
        sink.texel(through, texel, weight);
    }

    /// Texel whose light a hit sees. Where a wall cuts the texel, one on the hit's side of it.
    uint32_t lit_texel(const Ray& ray, const Hit& hit) const {
        const uint32_t texel = g.surfaces.texel(hit.triangle, hit.u, hit.v);
        if ((sink.flags(texel) & kTexelCut) == 0) return texel;
        return texel_on_side(g, hit.triangle, texel, ray.origin + ray.direction * hit.t);
    }

    /// Where a ray that met a surface came from, for others that may find the same place (LampSpots).
    struct Sender {
        float density; ///< rays per steradian; 0: no others find it
        float spots;   ///< expected number of places drawn from the lamps' side
    };
    /// Such a place and its sender. Both have the same weights for it.
    struct Sharing {
        float gather = 0.0f; ///< rays per square metre of the surface; 0: all is theirs
        float spots = 0.0f;
    };

    /// Unit normals of the side of a surface that a ray met: of its shading, which the cosine is measured from, and of
    /// its plane, whose back gives and gets no light.
    struct Facing {
        Vec3 shading, side;
    };
    Facing facing_of(const Hit& hit) const {
        const float turn = hit.back ? -1.0f : 1.0f;
        const Vec3 side = g.scene.geometric_normal(hit.triangle) * turn;
        if (g.scene.is_flat(hit.triangle)) return {side, side};
        return {g.scene.shading_normal(hit.triangle, hit.u, hit.v) * turn, side};
    }

    bool has_spots() const { return o.unmapped_direct && g.spots != nullptr && !g.spots->empty(); }
    uint32_t spots_per_receiver() const { return std::max(o.samples / kRaysPerSpot, 1u); }
    bool takes_spots(uint32_t local) const { return has_spots() && !g.receivers.has_moved(tile.first + local); }
    bool is_switch(const Hit& hit) const {
        return Sink::kSwitches && g.scene.presence(hit.triangle).element != kNoElement;
    }

    /// Surfaces without a lightmap have no stored light: one emitter sample and one more ray stand
    /// in. Bounces there are free, they do not count as one of the series. survives: chance of the further ray.
    void unmapped(const Ray& ray, const Hit& hit, Through through, const Vec3& reflectance, float survives,
                  uint32_t seed, const Sender& sender);

    /// Every switchable surface splits a chain in two, for it is there or not: their number would be exponential.
    float chance_to_branch() const { return std::min(1.0f, kChainSplits / static_cast<float>(std::max(splits, 1u))); }

    /// What one emitter sample sends off a surface at p. Lamps share it with places drawn from their side, emissive
    /// triangles with the chain's next ray.
    void direct_light(const Vec3& p, const Facing& n, uint32_t triangle, const Through& through, uint32_t seed,
                      const Sharing& sharing);

    /// Light of an emitter sample off a surface at p, times scale over what the way there is worth.
    void reflect(const Vec3& p, const Facing& n, uint32_t e, const EmitterSample& s, Through through, float scale);

    /// Share of places drawn from the lamps' side in the light of one, by the balance heuristic.
    /// reaches(): whether they draw it at all.
    template <class Reaches>
    static float spot_share(const Sharing& sharing, float density, const Reaches& reaches) {
        const float drawn = sharing.spots * density;
        return drawn > kRareSpot * sharing.gather && reaches() ? drawn / (drawn + sharing.gather) : 0.0f;
    }

    /// A place that a lamp lights, and a direction from x to it.
    struct Glint {
        LampSpots::Spot spot;
        Vec3 direction{0.0f};
        float distance = 0.0f, per_area = 0.0f; ///< steradian per square metre of the place
        Vec3 reflectance{0.0f};
    };

    /// Draws a place whose light may arrive at x; false if none does.
    bool find_glint(const Vec3& x, const Vec2& u, Glint& glint);

    /// Sends its light to x, times scale. Only places that are the first fixed surface from there count.
    void receive(const Glint& glint, const Vec3& x, Through through, float scale, uint32_t seed);

    /// One place drawn from the lamps' side for each receiver of a packet.
    void receive_spots(uint32_t first, uint32_t number, uint32_t sample);

    void receive_spot(uint32_t i, uint32_t lane, uint32_t number, PacketDirections& local);

    /// The same for a surface at p on such a chain.
    void chain_spot(const Vec3& p, const Facing& n, const Through& through, uint32_t seed);

    /// Follows a ray of such a stand-in. cosine: at its start.
    void path(const Ray& ray, Through through, uint32_t seed, float cosine);

    void path_on(const Ray& ray, Hit end, Through through, uint32_t seed, Way way, float cosine);

    bool path_end(const Ray& ray, const Hit& hit, Through& through, uint32_t seed, Way& way, float cosine);

    /// As pass_switches, along such a path.
    bool path_switches(const Ray& ray, const std::vector<Hit>& switches, size_t next, const Hit& end, Through& through,
                       uint32_t seed, Way& way, float cosine);

    /// Light of one surface on such a path; true if some from behind gets through.
    bool path_shine(const Ray& ray, const Hit& hit, Through& through, uint32_t seed, Way& way, float cosine);

    /// Share of such a path's ray in the light of an emissive triangle, beside the emitter samples of its start.
    float ray_share(const Ray& ray, const Hit& hit, float cosine) const;
};

template <class Sink>
uint64_t run_gather(const GatherScene& scene, const Tile& tile, const GatherOptions& options, const Sink& sink) {
    Gatherer<Sink> gatherer(scene, options, tile, sink);
    gatherer.run();
    return gatherer.rays;
}

} // namespace ajar
