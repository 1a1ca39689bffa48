// SPDX-License-Identifier: GPL-3.0-or-later
// ajar_reference_*: check, guard, forward.
#include "api/guard.h"
#include "api/job.h"
#include "api/tables.h"

using namespace ajar;

namespace {

static_assert(AJAR_REFERENCE_BATCH_PATHS == kBatchPaths && AJAR_REFERENCE_MIN_BATCHES == kLeastBatches);

[[noreturn]] void fail(const char* text) { throw Error(AJAR_ERROR_ARGUMENT, text, "reference settings"); }

/// Weights of every element, those at the start if the caller gives none.
std::vector<float> checked_weights(const ajar_reference_settings& s, const Snapshot& scene) {
    std::vector<float> out;
    for (const Element& e : scene.elements) out.push_back(e.weight);
    if (s.weight_count == 0) return out;
    if (s.weight_count != out.size() || s.weights == nullptr) fail("weights must hold one number per element");
    for (size_t i = 0; i < out.size(); ++i) {
        out[i] = s.weights[i];
        if (!(out[i] >= 0.0f) || !std::isfinite(out[i])) fail("a weight is negative or not finite");
        if (scene.elements[i].is_switch() && out[i] > 1.0f) fail("the weight of a door or toggle is above 1");
    }
    return out;
}

Vec3 checked_normal(const float* n) {
    const Vec3 v(n[0], n[1], n[2]);
    if (!is_finite(v) || !(v.z > 0.0f) || std::abs(glm::length(v) - 1.0f) > 1e-3f)
        fail("normal must be of unit length and point out of the surface");
    return v;
}

ReferenceSettings checked_settings(const ajar_reference_settings* settings, const Snapshot& scene) {
    const ajar_reference_settings s = checked(settings);
    if (s.points == 0 || s.points > (1u << 20)) fail("points must lie in 1..1048576");
    if (s.bounces > 256) fail("bounces must be 256 at most");
    if (s.batches < AJAR_REFERENCE_MIN_BATCHES) fail("batches must be 4 or more");
    if (!(s.time_limit >= 0.0f)) fail("time_limit must be 0 or more seconds");
    if (s.choice > AJAR_CHOICE_TEXEL) fail("choice has an unknown value");
    if (s.threads > 1024) fail("threads must be 1024 at most");
    ReferenceSettings out;
    out.points = s.points;
    out.bounces = s.bounces;
    out.batches = s.batches;
    out.time_limit = s.time_limit;
    out.seed = s.seed;
    out.point_seed = s.point_seed;
    out.by_texel = s.choice == AJAR_CHOICE_TEXEL;
    out.whole_texels = s.texel_mean != 0;
    out.normal = checked_normal(s.normal);
    out.weights = checked_weights(s, scene);
    out.door_bounces = s.door_bounces;
    return out;
}

ajar_reference_point point_of(const ReferenceValue& v, const Snapshot& scene) {
    const Triangle& t = scene.triangles[v.point.place.triangle];
    return {v.point.page,    v.point.x,       v.point.y,       t.instance,
            t.source,        v.point.place.u, v.point.place.v, {v.irradiance.x, v.irradiance.y, v.irradiance.z},
            v.standard_error};
}

} // namespace

extern "C" {

AJAR_API ajar_result ajar_reference_start(ajar_scene scene, const ajar_reference_settings* settings,
                                          ajar_reference* out) {
    return guarded([&] {
        check_cpu();
        const auto builder = scenes().get(scene);
        ajar_reference& handle = required(out);
        if (!builder->committed()) throw Error(AJAR_ERROR_STATE, "commit the scene before tracing it");
        const auto snapshot = builder->snapshot();
        ReferenceSettings s = checked_settings(settings, *snapshot);
        handle = static_cast<ajar_reference>(
            references().add(std::make_shared<ReferenceJob>(snapshot, std::move(s), settings->threads)));
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_reference_poll(ajar_reference reference, ajar_progress* out) {
    return guarded([&] {
        const auto r = references().get(reference);
        checked(out);
        r->task().poll(*out);
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_reference_cancel(ajar_reference reference) {
    return guarded([&] {
        references().get(reference)->task().cancel();
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_reference_wait(ajar_reference reference, double timeout) {
    return guarded([&]() -> ajar_result {
        const auto r = references().get(reference);
        const ajar_result result = r->task().wait(timeout == timeout ? timeout : 0.0);
        if (result >= 0) return result;
        const Warning why = r->task().failure();
        return remember(result, why.text.c_str(), why.culprit.c_str());
    });
}

AJAR_API ajar_result ajar_reference_error(ajar_reference reference, char* text, uint64_t text_size, char* culprit,
                                          uint64_t culprit_size) {
    return guarded([&] {
        const Warning why = references().get(reference)->task().failure();
        copy_text(why.text, text, text_size);
        copy_text(why.culprit, culprit, culprit_size);
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_reference_release(ajar_reference* reference) {
    return guarded([&] {
        const auto r = references().take(required(reference));
        *reference = nullptr;
        r->task().cancel();
        r->task().wait(-1.0);
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_reference_read(ajar_reference reference, ajar_reference_point* points, uint64_t point_count,
                                         uint32_t* out_batches) {
    return guarded([&] {
        const auto r = references().get(reference);
        const ReferenceResult& result = r->result();
        if (points == nullptr || point_count < result.values.size())
            throw Error(AJAR_ERROR_BUFFER, "the buffer holds fewer points than the reference");
        for (size_t i = 0; i < result.values.size(); ++i) points[i] = point_of(result.values[i], r->scene());
        required(out_batches) = result.batches;
        return AJAR_OK;
    });
}

} // extern "C"
