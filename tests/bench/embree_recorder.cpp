// SPDX-License-Identifier: GPL-3.0-or-later
#include "embree_recorder.h"

#include <bit>
#include <vector>

// Embree 3 takes a context before the rays, Embree 4 arguments behind them.
#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#define PACKET_CALL(f) f(const int* valid, RTCScene scene, RTCRayHit8* rays, RTCIntersectArguments* extra)
#define SINGLE_CALL(f) f(RTCScene scene, RTCRayHit* ray, RTCIntersectArguments* extra)
#define PACKET_ARGUMENTS valid, scene, rays, extra
#define SINGLE_ARGUMENTS scene, ray, extra
using Extra = RTCIntersectArguments;
static void init(Extra* extra) { rtcInitIntersectArguments(extra); }
#else
#include <embree3/rtcore.h>
#define PACKET_CALL(f) f(const int* valid, RTCScene scene, RTCIntersectContext* extra, RTCRayHit8* rays)
#define SINGLE_CALL(f) f(RTCScene scene, RTCIntersectContext* extra, RTCRayHit* ray)
#define PACKET_ARGUMENTS valid, scene, extra, rays
#define SINGLE_ARGUMENTS scene, extra, ray
using Extra = RTCIntersectContext;
static void init(Extra* extra) { rtcInitIntersectContext(extra); }
#endif

extern "C" {
void PACKET_CALL(__real_rtcIntersect8);
void SINGLE_CALL(__real_rtcIntersect1);
}

namespace bench {

namespace {

constexpr int kLanes = 8;

struct Packet {
    RTCRay8 rays;
    uint32_t lanes; ///< bit per lane
};

uint32_t lanes_of(const int* valid) {
    uint32_t bits = 0;
    for (int i = 0; i < kLanes; ++i) bits |= uint32_t{valid[i] != 0} << i;
    return bits;
}

uint32_t hits_of(const RTCRayHit8& rays, uint32_t lanes) {
    uint32_t bits = 0;
    for (int i = 0; i < kLanes; ++i) bits |= uint32_t{rays.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID} << i;
    return bits & lanes;
}

uint64_t count_bits(uint32_t bits) { return static_cast<uint64_t>(std::popcount(bits)); }

} // namespace

struct EmbreeRecorder::Calls {
    RTCScene scene = nullptr;
    std::vector<Packet> packets;
    std::vector<RTCRay> singles;
    uint64_t hits = 0;

    void trace(const Packet& packet, RayCount& seen) const;
    void trace(const RTCRay& single, RayCount& seen) const;
};

void EmbreeRecorder::Calls::trace(const Packet& packet, RayCount& seen) const {
    Extra context;
    init(&context);
    RTCRayHit8 traced;
    traced.ray = packet.rays;
    alignas(32) int valid[kLanes];
    for (int i = 0; i < kLanes; ++i) {
        valid[i] = (packet.lanes >> i & 1) != 0 ? -1 : 0;
        traced.hit.geomID[i] = traced.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    RTCRayHit8* rays = &traced;
    Extra* extra = &context;
    __real_rtcIntersect8(PACKET_ARGUMENTS);
    seen.rays += count_bits(packet.lanes);
    seen.hits += count_bits(hits_of(traced, packet.lanes));
}

void EmbreeRecorder::Calls::trace(const RTCRay& single, RayCount& seen) const {
    Extra context;
    init(&context);
    RTCRayHit traced;
    traced.ray = single;
    traced.hit.geomID = traced.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    RTCRayHit* ray = &traced;
    Extra* extra = &context;
    __real_rtcIntersect1(SINGLE_ARGUMENTS);
    seen.rays += 1;
    seen.hits += traced.hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

namespace {
EmbreeRecorder::Calls* active = nullptr;
} // namespace

EmbreeRecorder::EmbreeRecorder() : calls_(std::make_unique<Calls>()) {}
EmbreeRecorder::~EmbreeRecorder() = default;
EmbreeRecorder::EmbreeRecorder(EmbreeRecorder&&) noexcept = default;

void EmbreeRecorder::start() { active = calls_.get(); }
void EmbreeRecorder::stop() { active = nullptr; }

RayCount EmbreeRecorder::recorded() const {
    RayCount count{calls_->singles.size(), calls_->hits};
    for (const Packet& p : calls_->packets) count.rays += count_bits(p.lanes);
    return count;
}

RayCount EmbreeRecorder::replay() const {
    RayCount seen;
    for (const Packet& p : calls_->packets) calls_->trace(p, seen);
    for (const RTCRay& r : calls_->singles) calls_->trace(r, seen);
    return seen;
}

} // namespace bench

extern "C" {

void PACKET_CALL(__wrap_rtcIntersect8) {
    using namespace bench;
    if (active == nullptr) return __real_rtcIntersect8(PACKET_ARGUMENTS);
    const Packet packet{rays->ray, lanes_of(valid)};
    __real_rtcIntersect8(PACKET_ARGUMENTS);
    active->scene = scene;
    active->packets.push_back(packet);
    active->hits += count_bits(hits_of(*rays, packet.lanes));
}

void SINGLE_CALL(__wrap_rtcIntersect1) {
    using namespace bench;
    if (active == nullptr) return __real_rtcIntersect1(SINGLE_ARGUMENTS);
    const RTCRay single = ray->ray;
    __real_rtcIntersect1(SINGLE_ARGUMENTS);
    active->scene = scene;
    active->singles.push_back(single);
    active->hits += ray->hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

} // extern "C"
