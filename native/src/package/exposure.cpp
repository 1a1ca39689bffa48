// SPDX-License-Identifier: GPL-3.0-or-later
// R11G11B10F holds 2^-14 to 65024 with all its digits. Scenes dimmer or brighter than that as a whole are stored in
// another unit; terms have scales of their own, and are stored relative to it.
#include "package/exposure.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace ajar {

namespace {

/// W/m^2: where the brightest texel is dimmer, others a thousandth of it would lose digits.
constexpr float kDim = 0x1p-4f;
/// Share of lit texels that may be clamped before all are stored in another unit: spots beside a lamp should not
/// take the digits of the rest.
constexpr double kMayClamp = 1e-3;
/// A light set may be raised at run time: its light of 1 W/m^2 stays within the format.
constexpr int kSetExponent = 15;
/// Of the brightest light, or of the brightest but kMayClamp, where it is scaled: up to the format's 2^16 there is room
/// for light sets that are turned up, and a factor of 2 of it is left over bright ones.
constexpr int kDimTarget = -4, kBrightTarget = 15;

int exponent_of(float v) {
    int e = 0;
    std::frexp(v, &e); // v = m * 2^e, m in [0.5, 1)
    return e;
}

bool has_sets(const Snapshot& scene) {
    return std::any_of(scene.elements.begin(), scene.elements.end(), [](const Element& e) { return !e.is_switch(); });
}

float start_factor(const Snapshot& scene, const BakedTerm& term) {
    float factor = 1.0f;
    for (const uint32_t e : term.elements)
        if (!scene.elements[e].is_switch() && scene.elements[e].weight > 0.0f) factor *= scene.elements[e].weight;
    return factor;
}

} // namespace

std::vector<float> brightest_light(const Snapshot& scene, const BakedPages& pages) {
    std::vector<Vec3> sum = pages.irradiance;
    for (const BakedTerm& term : pages.terms) {
        const float factor = start_factor(scene, term);
        for (size_t i = 0; i < term.texel.size(); ++i)
            sum[term.texel[i]] += factor * glm::max(term.irradiance[i], Vec3(0.0f));
    }
    std::vector<float> out;
    out.reserve(sum.size());
    for (const Vec3& v : sum) out.push_back(max_component(v));
    return out;
}

float choose_scale(const Snapshot& scene, const std::vector<float>& brightest) {
    std::vector<float> lit;
    for (const float v : brightest)
        if (v > 0.0f && std::isfinite(v)) lit.push_back(v);
    if (lit.empty()) return 1.0f;
    const auto rank = static_cast<ptrdiff_t>(kMayClamp * static_cast<double>(lit.size()));
    std::nth_element(lit.begin(), lit.begin() + rank, lit.end(), std::greater<>());
    const float largest = *std::max_element(lit.begin(), lit.begin() + rank + 1), most = lit[rank];
    int exponent = 0;
    if (largest < kDim) exponent = exponent_of(largest) - kDimTarget;
    if (most > kLargestPacked) exponent = exponent_of(most) - kBrightTarget;
    if (has_sets(scene)) exponent = std::clamp(exponent, -kSetExponent, kSetExponent);
    return std::ldexp(1.0f, std::clamp(exponent, -120, 120));
}

std::vector<Warning> exposure_warnings(const Snapshot& scene, const LightmapReceivers& receivers,
                                       const std::vector<float>& brightest, float scale) {
    std::vector<Warning> out;
    char text[240];
    if (scale != 1.0f) {
        std::snprintf(
            text, sizeof text,
            "is so %s that the package stores irradiance in units of %g W/m^2: multiply what its DDS files hold "
            "by the scale of the page in manifest.json",
            scale < 1.0f ? "dim" : "bright", scale);
        out.push_back({scene.name, text});
    }
    std::vector<uint32_t> clamped(scene.instances.size(), 0);
    for (uint32_t r = 0; r < receivers.count(); ++r)
        clamped[scene.triangles[receivers.triangle[r]].instance] +=
            brightest[receivers.texel[r]] > kLargestPacked * scale;
    for (size_t i = 0; i < clamped.size(); ++i) {
        if (clamped[i] == 0) continue;
        std::snprintf(text, sizeof text,
                      "%u texels are brighter than the package can hold and are cut to %g W/m^2; move the lamp away "
                      "from it or make it weaker",
                      clamped[i], kLargestPacked * scale);
        out.push_back({scene.instances[i].name, text});
    }
    return out;
}

} // namespace ajar
