// SPDX-License-Identifier: GPL-3.0-or-later
#include "api/self_check.h"

#include <cstdio>
#include <new>

#include "reference/reference.h"

namespace ajar {

namespace {

constexpr uint32_t kBatches = 8;      ///< of paths per point
constexpr uint32_t kPointSeed = 7919; ///< differs from what chooses the paths of accuracy measurements
constexpr double kSigmas = 4.0;
constexpr double kFarOff = 0.1;    ///< of a texel's light
constexpr double kMostBias = 0.05; ///< of all light
constexpr double kMostFar = 0.1;   ///< share of points
constexpr double kMostGain = 1.0;  ///< of light from one bounce to the next: no surface reflects more

/// Light with every weight at 1.
Vec3 all_on(const Snapshot& scene, const BakedPages& pages, uint32_t texel) {
    Vec3 sum = pages.irradiance[texel];
    for (const BakedTerm& t : pages.terms) {
        const auto at = std::lower_bound(t.texel.begin(), t.texel.end(), texel);
        if (at == t.texel.end() || *at != texel) continue;
        float factor = 1.0f;
        for (const uint32_t e : t.elements) factor *= scene.elements[e].variable(1.0f);
        sum += factor * t.irradiance[static_cast<size_t>(at - t.texel.begin())];
    }
    return sum;
}

/// The truth at random texels.
ReferenceResult trace_points(const Snapshot& scene, const Tracer& tracer, const ajar_settings& settings,
                             ThreadPool& pool, Progress& progress) {
    ReferenceSettings s;
    s.points = settings.check_points;
    s.bounces = settings.bounces;
    s.batches = kBatches;
    s.seed = settings.seed;
    s.point_seed = kPointSeed;
    s.by_texel = s.whole_texels = true;
    s.weights.assign(scene.elements.size(), 1.0f);
    return trace_reference(scene, tracer, s, pool, progress);
}

std::string percent(double share) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1f %%", 100.0 * share);
    return text;
}

} // namespace

void compare_points(const std::vector<CheckPoint>& points, SelfCheck& check) {
    double baked = 0.0, reference = 0.0, variance = 0.0;
    size_t far = 0;
    for (const CheckPoint& p : points) {
        const double both = double(p.baked_error) * p.baked_error + double(p.reference_error) * p.reference_error;
        baked += p.baked, reference += p.reference, variance += both;
        const double apart = std::abs(double(p.baked) - p.reference);
        far += apart > kFarOff * p.reference && apart > kSigmas * std::sqrt(both);
    }
    check.points = static_cast<uint32_t>(points.size());
    if (points.empty() || !(reference > 0.0)) return;
    check.ratio = baked / reference;
    check.ratio_error = std::sqrt(variance) / reference;
    check.far_share = static_cast<double>(far) / static_cast<double>(points.size());
}

BounceGain largest_gain(const std::vector<BounceGain>& steps) {
    BounceGain worst;
    const auto least = [](const BounceGain& g) { return g.gain - kSigmas * g.error; };
    // The first step may grow: direct light can fall where no lightmap is.
    for (size_t b = 1; b < steps.size(); ++b)
        if (b == 1 || least(steps[b]) > least(worst)) worst = steps[b];
    return worst;
}

std::string why_not(const std::function<void()>& work) {
    try {
        work();
        return {};
    } catch (const std::bad_alloc&) {
        return "not enough memory";
    } catch (const std::exception& e) {
        return e.what();
    }
}

SelfCheck check_bake(const Snapshot& scene, const Tracer& tracer, const LightmapReceivers& receivers,
                     const BakeResult& bake, const BakedPages& pages, const ajar_settings& settings, ThreadPool& pool,
                     Progress& progress) {
    SelfCheck check;
    const double start = progress.elapsed();
    check.bounce_gain = largest_gain(bake.growth.steps);
    check.not_checked = why_not([&] {
        std::vector<CheckPoint> points;
        for (const ReferenceValue& v : trace_points(scene, tracer, settings, pool, progress).values) {
            const Page& page = scene.pages[v.point.page];
            const auto texel = static_cast<uint32_t>(page.first_texel + uint64_t{v.point.y} * page.width + v.point.x);
            if (pages.validity[texel] != 1.0f) continue;
            const float error = bake.all_on_error()[receivers.of_texel[texel]];
            points.push_back({luminance(all_on(scene, pages, texel)), error, luminance(v.irradiance), v.standard_error});
        }
        if (points.empty()) throw Error(AJAR_ERROR_INPUT, "found no valid texel in the open");
        compare_points(points, check);
    });
    check.seconds = progress.elapsed() - start;
    return check;
}

double try_check(const Snapshot& scene, const Tracer& tracer, const ajar_settings& settings, ThreadPool& pool,
                 Progress& progress) {
    const double start = progress.elapsed();
    why_not([&] { trace_points(scene, tracer, settings, pool, progress); });
    return progress.elapsed() - start;
}

std::vector<Warning> check_warnings(const SelfCheck& c, const std::string& scene_name) {
    std::vector<Warning> out;
    if (!c.not_checked.empty())
        out.push_back({scene_name, "self-check: the finished bake was not checked: " + c.not_checked});
    if (std::abs(c.ratio - 1.0) > kMostBias && std::abs(c.ratio - 1.0) > kSigmas * c.ratio_error)
        out.push_back({scene_name, "self-check: the baked light is " + percent(c.ratio) +
                                       " of what brute force finds at random texels; bake with combinations "
                                       "or a finer preset, or measure with `./dev accuracy`"});
    if (c.far_share > kMostFar)
        out.push_back({scene_name, "self-check: " + percent(c.far_share) +
                                       " of random texels are more than a tenth off what brute force finds; more "
                                       "texels per metre show finer shadows"});
    if (c.bounce_gain.gain - kSigmas * c.bounce_gain.error > kMostGain)
        out.push_back({scene_name, "self-check: light grows from bounce to bounce, to " + percent(c.bounce_gain.gain) +
                                       " of the bounce before; no surface does that, so do not trust its brightness"});
    return out;
}

} // namespace ajar
