// SPDX-License-Identifier: GPL-3.0-or-later
#include "package/rounded_base.h"

#include <algorithm>

#include "encode/ahd.h"
#include "package/dispatch_plan.h"

namespace ajar {

namespace {

/// Twice the rounding of a half float: what leaves less of a base than that takes all.
constexpr float kAll = 0x1p-10f;

/// One channel of a term that takes light from a base.
float taken(float term, float base, float stored) {
    if (!(term < 0.0f) || !(base > 0.0f)) return term;
    return -term >= (1.0f - kAll) * base ? std::min(term, -stored * (1.0f + kAll)) : term * (stored / base);
}

} // namespace

RoundedContent::RoundedContent(const PackageContent& content) : content_(content) {
    for (PackageTerm& term : content_.terms) {
        if (term.elements.size() != 1 || content.elements[term.elements[0]].kind == "light_set") continue;
        if (std::none_of(term.irradiance.begin(), term.irradiance.end(), [](float v) { return v < 0.0f; })) continue;
        std::vector<float>& out = irradiance_.emplace_back(term.irradiance.begin(), term.irradiance.end());
        for (size_t i = 0; i < term.texel.size(); ++i) {
            const TexelPlace place = place_of(content.pages, term.texel[i]);
            const PackagePage& page = content.pages[place.page];
            const size_t local = size_t{place.y} * page.width + place.x;
            const Vec3 stored = unpack_r11g11b10f(page.packed_irradiance[local]) * content.scale;
            for (size_t c = 0; c < 3; ++c)
                out[3 * i + c] =
                    taken(out[3 * i + c], page.irradiance[3 * local + c], stored[static_cast<glm::length_t>(c)]);
        }
        term.irradiance = out;
    }
}

} // namespace ajar
