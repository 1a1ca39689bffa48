// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What the kernels do with the light that arrives. The kernels are compiled once per sink, so a
// scene pays only for what it has: one colour, colours per light set, or colours per product of
// elements with the conditions that switchable surfaces put on a path.

#include "base/work_clock.h"
#include "transport/gather.h"

namespace ajar {

/// Everything adds up to one colour.
class PlainSink {
public:
    static constexpr bool kSwitches = false;
    static constexpr uint32_t kTogether = 1; ///< strata of a packet's receivers that are visited in a row
    /// What is left of light on the way to the receiver.
    struct Through {
        Vec3 color{1.0f};
    };

    PlainSink(const Vec4* radiance, TileSums& sums) : radiance_(radiance), sums_(sums) {}

    Through start(const Snapshot&, uint32_t) const { return {}; }
    bool has_texels() const { return radiance_ != nullptr; }
    uint8_t flags(uint32_t texel) const { return static_cast<uint8_t>(radiance_[texel].w); }
    void fetch(uint32_t texel) const { __builtin_prefetch(&radiance_[texel]); }
    void light(const Through& through, uint32_t, const Vec3& radiance) { arrived_ += through.color * radiance; }
    void texel(const Through& through, uint32_t texel, float weight) {
        arrived_ += through.color * Vec3(radiance_[texel]) * weight;
    }
    void add_inside(uint32_t local) { sums_.inside[local] += 1.0f; }
    void add_cosines(uint32_t first, uint32_t, const PacketDirections& w) { sums_.add_cosines(first, w); }
    /// Keeps what one sample brought until its packet is complete.
    void end_sample(uint32_t lane, uint32_t, uint32_t, const PacketDirections&) {
        for (int c = 0; c < 3; ++c) packet_[c][lane] = arrived_[c];
        arrived_ = Vec3(0.0f);
    }
    /// Books the samples of receivers first to first + kLanes.
    void end_packet(uint32_t first, uint32_t sample, const PacketDirections& w) {
        sums_.add(first, sample, w, packet_);
        for (auto& channel : packet_) std::fill(std::begin(channel), std::end(channel), 0.0f);
    }

private:
    const Vec4* radiance_;
    TileSums& sums_;
    Vec3 arrived_{0.0f};
    alignas(32) float packet_[3][kLanes] = {}; ///< radiance of a packet's samples
};

/// A colour per term. Without switchable surfaces terms are light sets and nothing else.
template <bool Switches>
class TermSink {
public:
    static constexpr bool kSwitches = Switches;
    static constexpr uint32_t kTogether = 64;
    struct Through {
        Vec3 color{1.0f};
        Condition condition;
    };

    TermSink(const Snapshot& scene, const TermRows* rows, const TermLimits& limits, TermSums& sums)
        : scene_(scene),
          rows_(rows),
          limits_(limits),
          sums_(sums),
          all_combine_(
              std::all_of(scene.elements.begin(), scene.elements.end(), [](const Element& e) { return e.combines; })) {}

    /// A receiver on a switchable surface matters only while that surface is there.
    Through start(const Snapshot& scene, uint32_t triangle) const {
        Through t;
        if constexpr (Switches)
            if (const Presence p = scene.presence(triangle); p.element != kNoElement) t.condition.assume(p);
        return t;
    }
    bool has_texels() const { return rows_ != nullptr; }
    uint8_t flags(uint32_t texel) const { return rows_->flags[texel]; }
    void fetch(uint32_t texel) const { __builtin_prefetch(rows_->begin(texel)); }
    void light(const Through& through, uint32_t set, const Vec3& radiance) {
        arrive(through.condition, sums_.slot_of_set(set), through.color * radiance);
    }
    void texel(const Through& through, uint32_t texel, float weight) {
        const Vec3 scale = through.color * weight;
        if (!Switches || through.condition.empty()) return sums_.arrive(rows_->begin(texel), rows_->end(texel), scale);
        for (const TermColor* e = rows_->begin(texel); e != rows_->end(texel); ++e)
            arrive(through.condition, sums_.slot_of(e->term), e->color * scale);
    }
    void add_inside(uint32_t local) { sums_.add_inside(local); }
    void add_cosines(uint32_t first, uint32_t count, const PacketDirections& w) {
        for (uint32_t lane = 0; lane < count; ++lane) sums_.add_cosine(first + lane, w.weight[lane] * w.z[lane]);
    }
    void end_sample(uint32_t lane, uint32_t local, uint32_t sample, const PacketDirections& w) {
        sums_.end_sample(local, sample, w.at(lane), w.weight[lane]);
    }
    void end_packet(uint32_t, uint32_t, const PacketDirections&) {}

private:
    // Most ways meet no switchable surface: each term passes as it is.
    void arrive(const Condition& condition, uint32_t slot, const Vec3& light) {
        if (!Switches || condition.empty())
            sums_.arrive(slot, light);
        else
            arrive_if(condition, slot, light);
    }
    struct Product {
        uint32_t slot;
        float factor;
    };
    struct Products {
        Product of[1u << Condition::kCapacity];
        uint32_t count = 0;

        void add(uint32_t slot, float factor) {
            if (factor != 0.0f) of[count++] = {slot, factor};
        }
    };

    /// Light that needs states of doors and toggles: each presence, constant + linear x, multiplies it.
    void arrive_if(const Condition& condition, uint32_t slot, const Vec3& light) {
        sums_.meet(light, sums_.term(slot).switch_count() == 0 ? started(condition) : 0.0f);
        if (condition.count() == 1 && !condition.has_assumed()) return arrive_behind(condition[0], slot, light);
        Products buffers[2];
        Products *now = &buffers[0], *next = &buffers[1];
        if (condition.has_assumed())
            settle(condition[0], slot, condition.at_start(), *now);
        else
            now->add(slot, condition.at_start());
        for (uint32_t i = condition.has_assumed(); i < condition.count(); ++i) {
            next->count = 0;
            const PresenceFactors p = presence_factors(scene_.elements[condition[i].element], condition[i].state);
            for (uint32_t k = 0; k < now->count; ++k) multiply(now->of[k], condition[i].element, p, light, *next);
            std::swap(now, next);
        }
        if (const uint32_t e = condition.not_followed(); e != kNoElement) sums_.cut(e, light);
        for (uint32_t k = 0; k < now->count; ++k) sums_.arrive(now->of[k].slot, light * now->of[k].factor);
    }
    /// Share of light that passes at the start.
    float started(const Condition& condition) const {
        float share = condition.at_start();
        for (uint32_t i = condition.has_assumed(); i < condition.count(); ++i)
            share *= presence_factors(scene_.elements[condition[i].element], condition[i].state).constant;
        return share;
    }
    /// The same for one surface, which is the common case.
    void arrive_behind(const Presence& surface, uint32_t slot, const Vec3& light) {
        const PresenceFactors p = presence_factors(scene_.elements[surface.element], surface.state);
        const uint32_t with = times(slot, surface.element);
        if (with == slot) {
            if (p.kept != 0.0f) sums_.arrive(slot, light * p.kept);
            if (p.freed != 0.0f) sums_.arrive(slot_without(slot, surface.element), light * p.freed);
            return;
        }
        if (p.constant != 0.0f) sums_.arrive(slot, light * p.constant);
        if (with == TermSums::kCut)
            sums_.cut(surface.element, light * p.linear);
        else if (with != TermSums::kNone)
            sums_.arrive(with, light * p.linear);
    }
    void multiply(const Product& product, uint32_t element, const PresenceFactors& p, const Vec3& light,
                  Products& out) {
        const uint32_t with = times(product.slot, element);
        if (with != product.slot) {
            out.add(product.slot, product.factor * p.constant);
            if (with == TermSums::kCut)
                sums_.cut(element, light * (product.factor * p.linear));
            else if (with != TermSums::kNone)
                out.add(with, product.factor * p.linear);
        } else {
            out.add(product.slot, product.factor * p.kept);
            if (p.freed != 0.0f) out.add(slot_without(product.slot, element), product.factor * p.freed);
        }
    }
    /// The state is known: the variable is a number.
    void settle(const Presence& known, uint32_t slot, float factor, Products& out) {
        if (sums_.term(slot).contains(known.element)) {
            factor *= scene_.elements[known.element].variable(known.state ? 1.0f : 0.0f);
            slot = slot_without(slot, known.element);
        }
        out.add(slot, factor);
    }
    uint32_t slot_without(uint32_t slot, uint32_t element) { return sums_.slot_of(sums_.term(slot).without(element)); }
    uint32_t times(uint32_t slot, uint32_t element) {
        return sums_.times(slot, element, limits_.order, [&](const Term& product) {
            return all_combine_ || product.order() < 2 || may_combine(product);
        });
    }
    bool may_combine(const Term& term) const {
        if (term.set() != kNoElement && !scene_.elements[term.set()].combines) return false;
        for (uint32_t i = 0; i < term.switch_count(); ++i)
            if (!scene_.elements[term.element(i)].combines) return false;
        return true;
    }

    const Snapshot& scene_;
    const TermRows* rows_;
    TermLimits limits_;
    TermSums& sums_;
    bool all_combine_; ///< no element opts out
};

/// What light that meets a switchable surface counts as.
inline Effect effect_of(const Snapshot& scene, const Presence& presence) {
    return scene.elements[presence.element].kind == ElementKind::door ? Effect::doors : Effect::toggles;
}

/// See-through surfaces of elements that a path does not follow split no path in two, or n of them would make 2^n: what
/// passes is what they let through at the start. (Front and back of one that is partly there count as two.)
template <class Through>
void pass_at_start(const std::vector<Element>& elements, const Presence& p, const Vec3& transmittance,
                   Through& through) {
    const float there = presence_factors(elements[p.element], p.state).constant;
    through.color *= Vec3(1.0f - there) + there * transmittance;
    through.condition.leave_at_start(p.element);
}

/// Light that passes switchable surfaces: each is absent, or there and perhaps lets some through.
template <class Sink, class Emit>
void through_switches(const Snapshot& scene, const std::vector<Hit>& hits, size_t next, typename Sink::Through through,
                      Emit&& emit) {
    for (; next < hits.size(); ++next) {
        const Hit& hit = hits[next];
        const Presence p = scene.presence(hit.triangle);
        const bool transmits = scene.materials[scene.triangles[hit.triangle].material].transmits;
        if (transmits && !through.condition.follows(p.element)) {
            pass_at_start(scene.elements, p, scene.surface(hit.triangle, hit.u, hit.v).transmittance, through);
            continue;
        }
        auto there = through;
        if (transmits && there.condition.require(scene.elements, p)) {
            there.color *= scene.surface(hit.triangle, hit.u, hit.v).transmittance;
            if (max_component(there.color) > 0.0f) through_switches<Sink>(scene, hits, next + 1, there, emit);
        }
        if (!through.condition.require(scene.elements, p.opposite())) return;
    }
    emit(through);
}

/// Follows a shadow ray that fixed opaque surfaces leave free through tinted and switchable ones.
/// Calls emit(through) for each way in which light gets along it. crosses: it may meet switchable ones.
template <class Sink, class Emit>
void through_shadow(const Snapshot& scene, const Tracer& tracer, const Ray& ray, typename Sink::Through through,
                    Emit&& emit, bool crosses = true) {
    if (tracer.has_transmissive()) {
        const Working here(Effect::transparency);
        through.color *= tracer.tint(ray);
    }
    if (!(max_component(through.color) > 0.0f)) return;
    if constexpr (Sink::kSwitches)
        if (crosses) {
            thread_local std::vector<Hit> hits;
            tracer.all_switches(ray, kMaskShadowSwitch, hits);
            if (!hits.empty()) Worker::mine().set(effect_of(scene, scene.presence(hits.front().triangle)));
            return through_switches<Sink>(scene, hits, 0, through, emit);
        }
    emit(through);
}

} // namespace ajar
