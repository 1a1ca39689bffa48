// SPDX-License-Identifier: GPL-3.0-or-later
#include "api/cut_report.h"

#include <cstdio>

#include "ajar/ajar.h"

namespace ajar {

namespace {

constexpr double kTold = 0.01; ///< of the light: as much as terms may leave out unsaid
constexpr size_t kNamed = 5;   ///< elements in a warning

/// Elements and their light, most first.
std::vector<std::pair<uint32_t, double>> by_light(const CutLight& cut) {
    std::vector<std::pair<uint32_t, double>> out(cut.of_element.begin(), cut.of_element.end());
    std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
    return out;
}

} // namespace

nlohmann::ordered_json cut_json(const Snapshot& scene, const CutLight& cut) {
    nlohmann::ordered_json elements = nlohmann::ordered_json::array();
    for (const auto& [element, light] : by_light(cut))
        elements.push_back({{"name", scene.elements[element].name}, {"share", cut.share_of(light)}});
    return {{"share", cut.share()}, {"most_elements", cut.most_elements}, {"elements", elements}};
}

std::vector<Warning> cut_warnings(const Snapshot& scene, const CutLight& cut, uint32_t combinations) {
    if (cut.share() <= kTold) return {};
    const auto elements = by_light(cut);
    std::string names;
    for (size_t i = 0; i < std::min(elements.size(), kNamed); ++i)
        names += (i > 0 ? ", " : "") + ("\"" + scene.elements[elements[i].first].name + "\"");
    if (elements.size() > kNamed) names += " and " + std::to_string(elements.size() - kNamed) + " more";
    char share[32];
    std::snprintf(share, sizeof share, "%.1f %%", 100.0 * std::min(cut.share(), 1.0));
    const char* remedy = combinations == AJAR_COMBINATIONS_NONE
                             ? "set Combinations to Auto"
                             : "mark doors and toggles that change together as one, or fewer of them";
    return {{scene.elements[elements[0].first].name,
             std::string("where several doors and toggles stand between a lamp and a surface, ") + share +
                 " of the light stays as it is at the start where more than " + std::to_string(cut.most_elements) +
                 " elements decide on it, a light set that is on being one (the start itself is exact): " + names +
                 "; " + remedy}};
}

} // namespace ajar
