// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "accel/passed.h"

namespace ajar {

/// Ray tracing over the flattened snapshot, which must outlive it. Safe from any thread.
class Tracer {
public:
    explicit Tracer(const Snapshot& scene);
    ~Tracer();
    Tracer(const Tracer&) = delete;
    Tracer& operator=(const Tracer&) = delete;

    /// Closest hits of the lanes whose valid entry is -1, among what is always there.
    void intersect(const int32_t* valid, RayPacket& rays) const;
    /// Lanes that are blocked by an opaque surface which is always there get tfar = -infinity.
    void occluded(const int32_t* valid, RayPacket& rays) const;
    /// Bits of those valid lanes with tfar >= 0 that meet a switchable surface of mask up to tfar.
    uint32_t crossing(const int32_t* valid, const RayPacket& rays, uint32_t mask) const;
    /// Nearest surface of mask.
    Hit intersect(const Ray& ray, uint32_t mask) const;
    /// Nearest fixed surface of mask that the ray has not passed. The scene must have some that let light through.
    Hit next(const Ray& ray, uint32_t mask, const Passed& passed) const;
    /// Goes through a surface that was met.
    void pass(const Hit& hit, Passed& passed) const;
    /// Whether intersect() would find something; faster.
    bool occluded(const Ray& ray, uint32_t mask) const;
    /// Every switchable surface of mask along the ray, between tnear (without) and tfar (with), each once, nearest
    /// first; also those in one plane.
    void all_switches(const Ray& ray, uint32_t mask, std::vector<Hit>& out) const;
    /// What is left of light along a shadow ray: 0 behind anything opaque, else the product of
    /// the transmittances in between.
    Vec3 transmittance(const Ray& ray) const;
    /// The transmissive surfaces' part of transmittance; 1 if the scene has none. Behind many layers an estimate
    /// whose mean is right (LayerChance), the same for the same ray.
    Vec3 tint(const Ray& ray) const;
    bool has_transmissive() const { return has_transmissive_; }

    /// Origin moved off the surface along the unit normal n, far enough that a ray which starts
    /// there does not meet the surface again (algorithms.md 9.6).
    Vec3 offset(const Vec3& p, const Vec3& n) const { return p + n * offset_distance(p); }
    float offset_distance(const Vec3& p) const {
        return std::max(std::max(std::abs(p.x), std::abs(p.y)), std::max(std::abs(p.z), floor_)) * (16.0f * 0x1p-23f);
    }

private:
    struct Impl;
    const Snapshot& scene_;
    std::unique_ptr<Impl> impl_;
    float floor_;
    bool has_transmissive_ = false;
};

} // namespace ajar
