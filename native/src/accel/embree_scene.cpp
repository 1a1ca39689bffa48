// SPDX-License-Identifier: GPL-3.0-or-later
// The only file that knows Embree; compiles against versions 3 and 4.
#include "accel/embree_scene.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#define AJAR_EMBREE4
#else
#include <embree3/rtcore.h>
#endif

#include <tbb/task_arena.h>

#include <bit>
#include <cstring>

namespace ajar {

namespace {

static_assert(sizeof(RayPacket) == sizeof(RTCRayHit8));
static_assert(offsetof(RayPacket, tfar) == offsetof(RTCRay8, tfar));
static_assert(offsetof(RayPacket, nx) == offsetof(RTCRayHit8, hit) + offsetof(RTCHit8, Ng_x));
static_assert(offsetof(RayPacket, triangle) == offsetof(RTCRayHit8, hit) + offsetof(RTCHit8, primID));

/// How far surfaces along a ray may come in the wrong order, of the distance and of the scene's diagonal: some
/// hundred roundings of floats, for rays at grazing angles and triangles of any size. More only costs a little time.
constexpr float kNearby = 1e-3f, kNearbyScene = 2e-5f;
constexpr size_t kPadding = 16; ///< bytes that the ray tracer may read behind the last vertex

/// Asks a query of Embree's. Version 4 takes arguments behind the rays, version 3 a context before them.
template <auto Query, class Rays>
void ask(RTCScene scene, Rays* rays) {
#ifdef AJAR_EMBREE4
    Query(scene, rays, nullptr);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    Query(scene, &context, rays);
#endif
}

template <auto Query, class Rays>
void ask(const int32_t* valid, RTCScene scene, Rays* rays) {
#ifdef AJAR_EMBREE4
    Query(valid, scene, rays, nullptr);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    Query(valid, scene, &context, rays);
#endif
}

RTCRayHit make_ray(const Ray& r, uint32_t mask) {
    RTCRayHit q{};
    q.ray.org_x = r.origin.x, q.ray.org_y = r.origin.y, q.ray.org_z = r.origin.z;
    q.ray.dir_x = r.direction.x, q.ray.dir_y = r.direction.y, q.ray.dir_z = r.direction.z;
    q.ray.tnear = r.tnear;
    q.ray.tfar = r.tfar;
    q.ray.mask = mask;
    q.hit.geomID = q.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    return q;
}

#ifdef AJAR_EMBREE4
constexpr RTCSceneFlags kFilterFlag = RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;
using Context = RTCRayQueryContext;
#else
constexpr RTCSceneFlags kFilterFlag = RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;
using Context = RTCIntersectContext;
#endif

/// A query that is asked about each hit. The tracer's own context must come first.
struct Filter {
    Context context;
    const std::vector<uint32_t>& first; ///< first triangle of each geometry

    Crossing place(const RTCFilterFunctionNArguments* a) const {
        return {RTCHitN_primID(a->hit, a->N, 0) + first[RTCHitN_geomID(a->hit, a->N, 0)], RTCHitN_u(a->hit, a->N, 0),
                RTCHitN_v(a->hit, a->N, 0)};
    }
};

/// What a query's filter works on.
template <class T>
T* state(const RTCFilterFunctionNArguments* a) {
    return static_cast<T*>(reinterpret_cast<Filter*>(a->context));
}

/// Where all_switches leaves what it meets.
struct Collector : Filter {
    const Snapshot& scene;
    std::vector<Hit>& out;
    float begin; ///< hits up to here do not count
};

/// Notes the hit and turns it down, so that the ray goes on.
void collect(const RTCFilterFunctionNArguments* a) {
    const Collector* c = state<Collector>(a);
    a->valid[0] = 0;
    if (!(RTCRayN_tfar(a->ray, a->N, 0) > c->begin)) return;
    const Crossing place = c->place(a);
    // The common edge of two triangles of a pane dims once. (Coincident surfaces of other elements count.)
    const Presence presence = c->scene.presence(place.triangle);
    if (std::any_of(c->out.begin(), c->out.end(), [&](const Hit& h) {
            return place.is_same({h.triangle, h.u, h.v}, c->scene) && c->scene.presence(h.triangle) == presence;
        }))
        return;
    const float side = RTCRayN_dir_x(a->ray, a->N, 0) * RTCHitN_Ng_x(a->hit, a->N, 0) +
                       RTCRayN_dir_y(a->ray, a->N, 0) * RTCHitN_Ng_y(a->hit, a->N, 0) +
                       RTCRayN_dir_z(a->ray, a->N, 0) * RTCHitN_Ng_z(a->hit, a->N, 0);
    c->out.push_back({place.triangle, place.u, place.v, RTCRayN_tfar(a->ray, a->N, 0), side > 0.0f});
}

/// What next looks for.
struct Unpassed : Filter {
    const Passed& passed;
    const Snapshot& scene;
};

void leave_out_passed(const RTCFilterFunctionNArguments* a) {
    const Unpassed* u = state<Unpassed>(a);
    if (u->passed.has(u->place(a), u->scene)) a->valid[0] = 0;
}

/// What is left of light that goes through layers, in whatever order the tracer finds them.
struct Dimming : Filter {
    const Snapshot& scene;
    uint32_t seed;
    std::vector<Crossing>& met; ///< the tracer may show a triangle more than once
    LayerChance chance;
    Vec3 left{1.0f};
};

/// Turns down layers that let light through, so that the ray goes on; none that ends it.
void dim(const RTCFilterFunctionNArguments* a) {
    Dimming* d = state<Dimming>(a);
    const Crossing place = d->place(a);
    a->valid[0] = 0;
    if (std::any_of(d->met.begin(), d->met.end(), [&](const Crossing& m) { return place.is_same(m, d->scene); }))
        return;
    d->met.push_back(place);
    const Vec3 transmittance = d->scene.surface(place.triangle, place.u, place.v).transmittance;
    if (d->chance.pass(d->left, transmittance, unit_float(hash_combine(d->seed, place.triangle)))) return;
    d->left = Vec3(0.0f);
    a->valid[0] = -1;
}

/// Asks Query, RTCRayHit's nearest hit or RTCRay's any, and for each hit call.
template <auto Query, class Rays, class Arguments>
void ask_filtered(RTCScene scene, Rays* ray, Context& context, RTCFilterFunctionN call,
                  [[maybe_unused]] void (*init)(Arguments*)) {
#ifdef AJAR_EMBREE4
    rtcInitRayQueryContext(&context);
    Arguments arguments;
    init(&arguments);
    arguments.flags = static_cast<RTCRayQueryFlags>(arguments.flags | RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER);
    arguments.context = &context;
    arguments.filter = call;
    Query(scene, ray, &arguments);
#else
    rtcInitIntersectContext(&context);
    context.filter = call;
    Query(scene, &context, ray);
#endif
}

#ifdef AJAR_EMBREE4
constexpr auto kNearestArguments = rtcInitIntersectArguments;
constexpr auto kAnyArguments = rtcInitOccludedArguments;
#else
constexpr void (*kNearestArguments)(Context*) = nullptr;
constexpr void (*kAnyArguments)(Context*) = nullptr;
#endif

uint32_t seed_of(const Ray& ray) {
    uint32_t seed = 0;
    for (int i = 0; i < 3; ++i)
        seed = hash_combine(hash_combine(seed, std::bit_cast<uint32_t>(ray.origin[i])),
                            std::bit_cast<uint32_t>(ray.direction[i]));
    return seed;
}

} // namespace

void RayPacket::prepare(uint32_t ray_mask) {
    for (uint32_t i = 0; i < kLanes; ++i) {
        tnear[i] = time[i] = 0.0f;
        mask[i] = ray_mask;
        id[i] = flags[i] = 0;
        group[i] = instance[i] = RTC_INVALID_GEOMETRY_ID;
        triangle[i] = kMiss;
    }
}

struct Tracer::Impl {
    /// What is always there, or what is switchable: few rays meet the latter, in a tree of its own they cost little.
    struct Part {
        RTCScene scene = nullptr;
        std::vector<uint32_t> first; ///< first triangle of each geometry

        bool empty() const { return first.empty(); }
        uint32_t triangle(uint32_t geometry, uint32_t primitive) const { return first[geometry] + primitive; }
    };
    RTCDevice device = nullptr;
    RTCBuffer vertices = nullptr; ///< one copy for all geometries
    Part fixed, switches;
    bool layers = false; ///< something lets light through

    ~Impl() {
        for (const Part* part : {&fixed, &switches})
            if (part->scene != nullptr) rtcReleaseScene(part->scene);
        if (vertices != nullptr) rtcReleaseBuffer(vertices);
        if (device != nullptr) rtcReleaseDevice(device);
    }

    void begin(const Snapshot& s) {
        device = rtcNewDevice(nullptr);
        if (device == nullptr) throw Error(AJAR_ERROR_INTERNAL, "the ray tracer could not start");
        layers = std::any_of(s.materials.begin(), s.materials.end(), [](const Material& m) { return m.transmits; });
        const RTCSceneFlags robust = RTC_SCENE_FLAG_ROBUST;
        fixed.scene = new_scene(layers ? static_cast<RTCSceneFlags>(robust | kFilterFlag) : robust);
        switches.scene = new_scene(static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | kFilterFlag));
        vertices = rtcNewBuffer(device, s.positions.size() * sizeof(Vec3) + kPadding);
        if (vertices == nullptr) no_memory();
        std::copy(s.positions.begin(), s.positions.end(), static_cast<Vec3*>(rtcGetBufferData(vertices)));
    }

    RTCScene new_scene(RTCSceneFlags flags) const {
        RTCScene scene = rtcNewScene(device);
        rtcSetSceneFlags(scene, flags);
        rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
        return scene;
    }

    [[noreturn]] static void no_memory() { throw Error(AJAR_ERROR_MEMORY, "not enough memory for the ray tracer"); }

    /// Triangles begin to end, of one mask.
    void add_group(const Snapshot& s, uint32_t begin, uint32_t end) {
        const uint32_t mask = s.ray_mask(s.triangles[begin]);
        Part& part = (mask & kMaskSwitch) != 0 ? switches : fixed;
        RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices, 0, sizeof(Vec3),
                             s.positions.size());
        auto* indices = static_cast<uint32_t*>(
            rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), end - begin));
        if (indices == nullptr) no_memory();
        for (uint32_t t = begin; t < end; ++t)
            std::memcpy(indices + 3 * size_t{t - begin}, s.triangles[t].vertex, 3 * sizeof(uint32_t));
#ifdef AJAR_EMBREE4
        rtcSetGeometryEnableFilterFunctionFromArguments(g, layers || (mask & kMaskSwitch) != 0);
#endif
        rtcSetGeometryMask(g, mask);
        rtcCommitGeometry(g);
        rtcAttachGeometry(part.scene, g);
        rtcReleaseGeometry(g);
        part.first.push_back(begin);
    }

    /// Nearest hit of one part; a miss leaves out as it is.
    void intersect(const Part& part, const Snapshot& s, const Ray& ray, uint32_t mask, Hit& out) const {
        RTCRayHit q = make_ray(ray, mask);
        ask<rtcIntersect1>(part.scene, &q);
        read(part, s, q, ray, out);
    }

    static void read(const Part& part, const Snapshot& s, const RTCRayHit& q, const Ray& ray, Hit& out) {
        if (q.hit.geomID == RTC_INVALID_GEOMETRY_ID) return;
        const uint32_t triangle = part.triangle(q.hit.geomID, q.hit.primID);
        const float side = glm::dot(ray.direction, Vec3(q.hit.Ng_x, q.hit.Ng_y, q.hit.Ng_z));
        out = {triangle, q.hit.u, q.hit.v, q.ray.tfar, (side > 0.0f) != s.triangles[triangle].mirrored};
    }

    /// Whether a ray meets something of a part.
    bool occluded(const Part& part, const Ray& ray, uint32_t mask) const {
        if (mask == 0 || part.empty()) return false;
        RTCRayHit q = make_ray(ray, mask);
        ask<rtcOccluded1>(part.scene, &q.ray);
        return q.ray.tfar < 0.0f;
    }
};

Tracer::Tracer(const Snapshot& s)
    : scene_(s), impl_(std::make_unique<Impl>()), floor_(std::max(s.diagonal(), 1e-6f) * 1e-3f) {
    impl_->begin(s);
    const auto count = static_cast<uint32_t>(s.triangles.size());
    for (uint32_t begin = 0, end; begin < count; begin = end) {
        for (end = begin + 1; end < count && s.ray_mask(s.triangles[end]) == s.ray_mask(s.triangles[begin]);) ++end;
        has_transmissive_ |= (s.ray_mask(s.triangles[begin]) & kMaskShadowTransmissive) != 0;
        if (s.ray_mask(s.triangles[begin]) != 0) impl_->add_group(s, begin, end);
    }
    // One thread: a parallel build may order coincident triangles differently each time, and the
    // bake promises the same bytes for any number of threads.
    tbb::task_arena(1).execute([&] {
        rtcCommitScene(impl_->fixed.scene);
        rtcCommitScene(impl_->switches.scene);
    });
    if (rtcGetDeviceError(impl_->device) != RTC_ERROR_NONE)
        throw Error(AJAR_ERROR_MEMORY, "the ray tracer could not be built");
}

Tracer::~Tracer() = default;

void Tracer::intersect(const int32_t* valid, RayPacket& rays) const {
    const Impl::Part& part = impl_->fixed;
    ask<rtcIntersect8>(valid, part.scene, reinterpret_cast<RTCRayHit8*>(&rays));
    for (uint32_t i = 0; i < kLanes; ++i)
        rays.triangle[i] =
            rays.group[i] == RTC_INVALID_GEOMETRY_ID ? kMiss : part.triangle(rays.group[i], rays.triangle[i]);
}

void Tracer::occluded(const int32_t* valid, RayPacket& rays) const {
    ask<rtcOccluded8>(valid, impl_->fixed.scene, reinterpret_cast<RTCRay8*>(&rays));
}

uint32_t Tracer::crossing(const int32_t* valid, const RayPacket& rays, uint32_t mask) const {
    if (impl_->switches.empty()) return 0;
    alignas(32) int32_t wanted[kLanes];
    alignas(32) RTCRay8 copy;
    std::memcpy(&copy, &rays, sizeof(copy));
    for (uint32_t i = 0; i < kLanes; ++i) {
        wanted[i] = valid[i] != 0 && rays.tfar[i] >= 0.0f ? -1 : 0;
        copy.mask[i] = mask;
    }
    ask<rtcOccluded8>(wanted, impl_->switches.scene, &copy);
    uint32_t lanes = 0;
    for (uint32_t i = 0; i < kLanes; ++i) lanes |= uint32_t{wanted[i] != 0 && copy.tfar[i] < 0.0f} << i;
    return lanes;
}

Hit Tracer::intersect(const Ray& ray, uint32_t mask) const {
    Hit hit;
    if ((mask & ~uint32_t{kMaskSwitch}) != 0) impl_->intersect(impl_->fixed, scene_, ray, mask, hit);
    if ((mask & kMaskSwitch) == 0 || impl_->switches.empty()) return hit;
    Ray before = ray;
    if (hit.triangle != kMiss) before.tfar = hit.t;
    impl_->intersect(impl_->switches, scene_, before, mask, hit);
    return hit;
}

Hit Tracer::next(const Ray& ray, uint32_t mask, const Passed& passed) const {
    RTCRayHit q = make_ray(ray, mask);
    q.ray.tnear = std::max(ray.tnear, passed.start());
    Unpassed u{{{}, impl_->fixed.first}, passed, scene_};
    ask_filtered<rtcIntersect1>(impl_->fixed.scene, &q, u.context, leave_out_passed, kNearestArguments);
    Hit hit;
    Impl::read(impl_->fixed, scene_, q, ray, hit);
    return hit;
}

void Tracer::pass(const Hit& hit, Passed& passed) const {
    passed.add(hit, kNearby * hit.t + kNearbyScene * scene_.diagonal());
}

bool Tracer::occluded(const Ray& ray, uint32_t mask) const {
    return impl_->occluded(impl_->fixed, ray, mask & ~uint32_t{kMaskSwitch}) ||
           impl_->occluded(impl_->switches, ray, mask & kMaskSwitch);
}

void Tracer::all_switches(const Ray& ray, uint32_t mask, std::vector<Hit>& out) const {
    out.clear();
    if (impl_->switches.empty() || !(ray.tfar > ray.tnear)) return;
    RTCRayHit q = make_ray(ray, mask);
    Collector c{{{}, impl_->switches.first}, scene_, out, ray.tnear > 0.0f ? ray.tnear : -1.0f};
    ask_filtered<rtcIntersect1>(impl_->switches.scene, &q, c.context, collect, kNearestArguments);
    std::sort(out.begin(), out.end(),
              [](const Hit& a, const Hit& b) { return a.t != b.t ? a.t < b.t : a.triangle < b.triangle; });
    for (Hit& h : out) h.back = h.back != scene_.triangles[h.triangle].mirrored;
}

Vec3 Tracer::tint(const Ray& ray) const {
    if (!has_transmissive_) return Vec3(1.0f);
    thread_local std::vector<Crossing> met;
    met.clear();
    RTCRayHit q = make_ray(ray, kMaskShadowTransmissive);
    Dimming d{{{}, impl_->fixed.first}, scene_, seed_of(ray), met, {}};
    ask_filtered<rtcOccluded1>(impl_->fixed.scene, &q.ray, d.context, dim, kAnyArguments);
    return d.left;
}

Vec3 Tracer::transmittance(const Ray& ray) const { return occluded(ray, kMaskShadowOpaque) ? Vec3(0.0f) : tint(ray); }

} // namespace ajar
