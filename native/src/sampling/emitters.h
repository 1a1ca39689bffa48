// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "base/parallel.h"
#include "base/work_clock.h"
#include "receiver/uv_raster.h"
#include "sampling/alias_table.h"
#include "sampling/emission_cells.h"
#include "sampling/nearby.h"
#include "sampling/sky_sampler.h"
#include "scene/snapshot.h"

namespace ajar {

/// One sample of an emitter from a receiver.
struct EmitterSample {
    Vec3 direction{0.0f};
    float distance = 0.0f; ///< m; infinite for sun and sky
    Vec3 target{0.0f};     ///< point that must be seen, off its surface; unused at infinity
    Vec3 weight{0.0f};     ///< W/m^2 facing the light, divided by the pdf inside this emitter
    float pdf = 0.0f;      ///< per steradian inside this emitter; 0 for lamps, which rays never hit
    bool casts_shadow = true;
    bool point_like = false;      ///< a point or spot lamp: as strong in every direction nearby
    Vec3 lobe{0.0f};              ///< an area lamp whose light falls with the cosine to this; 0: other emitters
    uint32_t texel = 0xffffffffu; ///< bright texel: page texel whose light it is
    float inverse_density = 0.0f; ///< bright texel: weight = radiance * inverse_density

    /// Turns direction and distance to those from another point, to look whether the target is seen from there.
    void see_from(const Vec3& p) {
        if (!(distance < std::numeric_limits<float>::infinity())) return;
        const Vec3 to = target - p;
        distance = glm::length(to);
        direction = to / std::max(distance, 1e-30f);
    }
};

/// The part of a bright lightmap texel that lies on one triangle, worth aiming at: it reflects radiance from its front.
struct BrightPatch {
    uint32_t texel;     ///< index over all pages
    uint32_t triangle;  ///< of the snapshot
    TexelPolygon shape; ///< texels from origin
    Vec3 origin{0.0f};
    Vec3 edge_x{0.0f}, edge_y{0.0f}; ///< m per texel
    Vec3 normal{0.0f};
    Vec3 radiance{0.0f};    ///< W/(m^2 sr)
    Presence presence = {}; ///< of its surface

    Vec3 at(const Vec2& p) const { return origin + p.x * edge_x + p.y * edge_y; }
    float area() const { return shape.area() * glm::length(glm::cross(edge_x, edge_y)); }
    Vec3 center() const;
};

/// Everything that next-event estimation can aim at: lamps, emissive triangles or clusters of them, an
/// image sky. What fills a large part of the view (large dim emitters, plain skies) is left to
/// the gather rays alone, which find it with less noise.
class EmitterSet {
public:
    /// Up to singles emissive triangles are emitters of their own; of more, some neighbours share one.
    EmitterSet(const Snapshot& scene, ThreadPool& pool, Progress& progress, uint32_t singles = 1024);

    uint32_t count() const { return static_cast<uint32_t>(emitters_.size()); }
    bool is_lamp(uint32_t e) const { return emitters_[e].kind == Kind::lamp; }
    /// A cluster of bright texels.
    bool is_bright(uint32_t e) const { return emitters_[e].kind == Kind::bright; }
    /// The lamp, or null for other emitters.
    const Light* lamp(uint32_t e) const { return is_lamp(e) ? &scene_.lights[emitters_[e].index] : nullptr; }
    /// A lamp whose beam may end within a texel.
    bool is_narrow(uint32_t e) const { return is_lamp(e) && scene_.lights[emitters_[e].index].is_narrow(); }
    /// A lamp whose direct light is not stored.
    bool is_primary(uint32_t e) const { return is_lamp(e) && scene_.lights[emitters_[e].index].primary; }
    /// What sampling an emitter counts as.
    Effect effect(uint32_t e) const;
    /// Light set of an emitter, or kNoElement.
    uint32_t set_of(uint32_t e) const;
    /// Emitters of a set, or those of none for kNoElement.
    std::vector<uint32_t> of_set(uint32_t set) const;
    /// When the emitter's surface is there; lamps and sky always are.
    Presence presence(uint32_t e) const;
    /// Rough unshadowed irradiance at p with normal n; 0 only if it cannot light the surface. reach: m about p
    /// in which a narrow lamp counts too.
    float importance(uint32_t e, const Vec3& p, const Vec3& n, float reach = 0.0f) const;
    EmitterSample sample(uint32_t e, const Vec3& p, const Vec2& u) const;
    /// The same for a lamp that is_wide_lamp() near p.
    EmitterSample sample_wide(uint32_t e, const Vec3& p, const Vec2& u) const;
    /// Asks for the memory that sample(e, p, u) will read, to do other work while it comes.
    [[gnu::always_inline]] void prefetch(uint32_t e, const Vec2& u) const {
        if (emitters_[e].kind != Kind::cluster) return;
        const Cluster& c = clusters_[emitters_[e].index];
        Vec2 on_triangle = u;
        cells_->prefetch(triangles_[find_triangle(c, on_triangle)].triangle, on_triangle);
    }
    /// Emitter that samples this triangle, or kNone.
    uint32_t emitter_of(uint32_t triangle) const {
        return triangle_emitter_.empty() ? kNone : triangle_emitter_[triangle];
    }
    /// Density per steradian with which sample() of its emitter picks the place (u, v) of a triangle, seen from
    /// distance at an angle to its normal.
    float triangle_pdf(uint32_t triangle, const Vec2& uv, float distance, float cosine) const;
    /// Emitter of the image sky, or kNone.
    uint32_t sky_emitter() const { return sky_emitter_; }
    float sky_pdf(const Vec3& w) const { return sky_->pdf(w); }
    uint32_t emissive_triangles() const { return emissive_count_; }

    /// This set plus bright texels; neighbours in the list with like normals share an emitter. Patches of one texel
    /// follow each other.
    EmitterSet with_bright_texels(std::vector<BrightPatch> patches) const;
    bool has_bright_texels() const { return !bright_.empty(); }
    /// Emitter of a bright texel's part on a triangle and its pick density per square metre; kNone for others.
    uint32_t bright_emitter(uint32_t texel, uint32_t triangle, float& density) const;
    /// Picks a lamp, emissive cluster or sky (no bright texel) for a point anywhere, roughly by
    /// importance; kNone if nothing lights it.
    uint32_t pick_anywhere(const Vec3& p, const Vec3& n, uint32_t seed, float& chance) const;
    static constexpr uint32_t kNone = 0xffffffffu;

private:
    enum class Kind { lamp, cluster, sky, bright };
    struct Emitter {
        Kind kind;
        uint32_t index;
    };
    struct Cluster {
        uint32_t first, count;
        Vec3 center;
        float radius;
        Vec3 axis;   ///< mean normal
        float power; ///< sum of luminance * area
        bool two_sided;
        float bend; ///< sine of the largest angle between a normal and axis
        uint32_t set = kNoElement;
        Presence presence = {};
    };
    struct EmissiveTriangle {
        uint32_t triangle;
        float area;
        float power;   ///< mean luminance * area
        float running; ///< running sum of power inside its cluster
    };

    void collect(ThreadPool& pool, Progress& progress);
    void drop_large();
    void split_by_element();
    void split(uint32_t first, uint32_t count);
    void add_cluster(uint32_t first, uint32_t count);
    float cluster_importance(const Cluster& c, const Vec3& p, const Vec3& n) const;
    /// As triangle_pdf, were the triangle's emission even.
    float plain_pdf(uint32_t triangle, float distance, float cosine) const;
    /// Triangle of a cluster for u.x, which becomes the place on it.
    uint32_t find_triangle(const Cluster& c, Vec2& u) const {
        const float target = u.x * c.power;
        uint32_t i = c.first;
        while (i + 1 < c.first + c.count && triangles_[i].running <= target) ++i;
        const EmissiveTriangle& t = triangles_[i];
        u.x = std::clamp((target - (t.running - t.power)) / t.power, 0.0f, 0x1.fffffep-1f);
        return i;
    }
    EmitterSample sample_cluster(const Cluster& c, const Vec3& p, Vec2 u) const;
    EmitterSample sample_sky(const Vec2& u) const;
    EmitterSample sample_bright(const Cluster& c, const Vec3& p, Vec2 u) const;
    void add_bright_cluster(uint32_t first, uint32_t count);
    void weigh_for_anywhere();
    float brings(uint32_t e, const Vec3& p) const;

    const Snapshot& scene_;
    std::shared_ptr<const SkySampler> sky_;
    std::shared_ptr<const EmissionCells> cells_;
    std::vector<Emitter> emitters_;
    std::vector<Cluster> clusters_;
    std::vector<EmissiveTriangle> triangles_;
    std::vector<uint32_t> triangle_emitter_;
    std::vector<float> triangle_density_; ///< pick probability / area
    uint32_t cluster_size_ = 1;
    uint32_t sky_emitter_ = kNone;
    uint32_t emissive_count_ = 0;
    AliasTable anywhere_; ///< over all emitters but bright texels
    std::shared_ptr<const NearbyEmitters> nearby_;

    struct BrightEntry {
        uint32_t texel, triangle;
        uint32_t emitter;
        float density; ///< per m^2
    };
    std::vector<BrightPatch> bright_;
    std::vector<float> bright_running_;  ///< running sums of power inside clusters
    std::vector<uint32_t> bright_index_; ///< per page texel: first in bright_entries_, or kNone
    std::vector<BrightEntry> bright_entries_;
};

} // namespace ajar
