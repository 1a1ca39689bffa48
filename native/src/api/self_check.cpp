// SPDX-License-Identifier: GPL-3.0-or-later
#include "api/self_check.h"

#include <algorithm>
#include <cstdio>
#include <new>

#include "api/stored_light.h"
#include "package/package_writer.h"
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
constexpr double kDark = 0.01;     ///< of the mean light of the brightest state: what terms may leave out

/// The truth at random texels in a state.
ReferenceResult trace_points(const Snapshot& scene, const Tracer& tracer, const ajar_settings& settings,
                             const std::vector<float>& weights, uint32_t points, ThreadPool& pool, Progress& progress) {
    ReferenceSettings s;
    s.points = points;
    s.bounces = settings.bounces;
    s.batches = kBatches;
    s.seed = settings.seed;
    s.point_seed = kPointSeed;
    s.by_texel = s.whole_texels = true;
    s.weights = weights;
    return trace_reference(scene, tracer, s, pool, progress);
}

std::string percent(double share) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1f %%", 100.0 * share);
    return text;
}

/// A bake and its package, held against the reference.
struct Judge {
    const Snapshot& scene;
    const Tracer& tracer;
    const LightmapReceivers& receivers;
    const BakeResult& bake;
    const BakedPages& pages;
    const ajar_settings& settings;
    ThreadPool& pool;
    Progress& progress;

    CheckPoint compare(const ReferenceValue& v, const StoredLight& stored, uint32_t receiver) const {
        const float baked = stored.light(v.point.page, v.point.x, v.point.y);
        // The bake knows its error with everything on; in other states it is taken for the same share of the light.
        const float all_on = bake.total.empty() ? luminance(bake.irradiance[receiver]) : bake.total[receiver];
        const float error = bake.all_on_error()[receiver] * (all_on > 0.0f ? baked / all_on : 1.0f);
        return {baked, error, luminance(v.irradiance), v.standard_error};
    }

    std::vector<CheckPoint> points_of(const CheckedState& state, uint32_t count, StoredLight& stored) const {
        stored.set_weights(state.weights);
        std::vector<CheckPoint> points;
        for (const ReferenceValue& v :
             trace_points(scene, tracer, settings, state.weights, count, pool, progress).values) {
            const Page& page = scene.pages[v.point.page];
            const auto texel = static_cast<uint32_t>(page.first_texel + uint64_t{v.point.y} * page.width + v.point.x);
            if (pages.validity[texel] == 1.0f) points.push_back(compare(v, stored, receivers.of_texel[texel]));
        }
        return points;
    }

    std::vector<StateCheck> judge(std::optional<TermsFile>& terms_file) const {
        const PackageContent content = package_content(scene, pages, settings);
        terms_file = encode_terms(content);
        StoredLight stored(content, terms_file ? &*terms_file : nullptr);
        const std::vector<CheckedState> states = states_to_check(scene.elements, settings.seed);
        const uint32_t count = points_of_state(settings.check_points, states.size());
        std::vector<std::vector<CheckPoint>> points;
        double brightest = 0.0;
        for (const CheckedState& state : states) {
            double light = 0.0;
            for (const CheckPoint& p : points.emplace_back(points_of(state, count, stored))) light += p.reference;
            brightest = std::max(brightest, light / std::max<double>(1.0, static_cast<double>(points.back().size())));
        }
        std::vector<StateCheck> out;
        for (size_t i = 0; i < states.size(); ++i) {
            if (points[i].empty()) continue;
            out.push_back(compare_points(points[i], kDark * brightest));
            out.back().state = states[i];
        }
        if (out.empty()) throw Error(AJAR_ERROR_INPUT, "found no valid texel in the open");
        return out;
    }
};

} // namespace

double StateCheck::excess() const {
    return std::max(std::abs(ratio - 1.0) / std::max(kMostBias, kSigmas * ratio_error), far_share / kMostFar);
}

const StateCheck& SelfCheck::worst() const {
    return *std::max_element(states.begin(), states.end(),
                             [](const StateCheck& a, const StateCheck& b) { return a.excess() < b.excess(); });
}

StateCheck compare_points(const std::vector<CheckPoint>& points, double dark) {
    StateCheck check;
    double baked = 0.0, reference = 0.0, variance = 0.0;
    size_t far = 0;
    for (const CheckPoint& p : points) {
        const double both = double(p.baked_error) * p.baked_error + double(p.reference_error) * p.reference_error;
        baked += p.baked, reference += p.reference, variance += both;
        const double apart = std::abs(double(p.baked) - p.reference);
        far += apart > kFarOff * std::max<double>(p.reference, dark) && apart > kSigmas * std::sqrt(both);
    }
    check.points = static_cast<uint32_t>(points.size());
    const double level = std::max(reference, dark * check.points);
    if (points.empty() || !(level > 0.0)) return check;
    check.ratio = 1.0 + (baked - reference) / level;
    check.ratio_error = std::sqrt(variance) / level;
    check.far_share = static_cast<double>(far) / static_cast<double>(points.size());
    return check;
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
    const Judge judge{scene, tracer, receivers, bake, pages, settings, pool, progress};
    check.not_checked = why_not([&] { check.states = judge.judge(check.terms_file); });
    check.seconds = progress.elapsed() - start;
    return check;
}

double try_check(const Snapshot& scene, const Tracer& tracer, const ajar_settings& settings, ThreadPool& pool,
                 Progress& progress) {
    const double start = progress.elapsed();
    const std::vector<CheckedState> states = states_to_check(scene.elements, settings.seed);
    why_not([&] {
        for (const CheckedState& state : states)
            trace_points(scene, tracer, settings, state.weights, points_of_state(settings.check_points, states.size()),
                         pool, progress);
    });
    return progress.elapsed() - start;
}

std::vector<Warning> check_warnings(const SelfCheck& c, const std::string& scene_name) {
    std::vector<Warning> out;
    if (!c.not_checked.empty())
        out.push_back({scene_name, "self-check: the finished bake was not checked: " + c.not_checked});
    if (c.bounce_gain.gain - kSigmas * c.bounce_gain.error > kMostGain)
        out.push_back({scene_name, "self-check: light grows from bounce to bounce, to " + percent(c.bounce_gain.gain) +
                                       " of the bounce before; no surface does that, so do not trust its brightness"});
    if (c.states.empty()) return out;
    const StateCheck& worst = c.worst();
    const std::string where = c.states.size() == 1 ? "" : " in state \"" + worst.state.name + "\" (see report.json)";
    if (std::abs(worst.ratio - 1.0) > std::max(kMostBias, kSigmas * worst.ratio_error))
        out.push_back({scene_name, "self-check: the stored light" + where + " is " + percent(worst.ratio) +
                                       " of what brute force finds at random texels; bake with combinations "
                                       "or a finer preset, or measure with `./dev accuracy`"});
    if (worst.far_share > kMostFar)
        out.push_back({scene_name, "self-check: " + percent(worst.far_share) + " of random texels" + where +
                                       " are more than a tenth off what brute force finds; more "
                                       "texels per metre show finer shadows"});
    return out;
}

} // namespace ajar
