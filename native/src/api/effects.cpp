// SPDX-License-Identifier: GPL-3.0-or-later
#include "api/effects.h"

namespace ajar {

namespace {

using nlohmann::json;

std::string n(size_t v) { return std::to_string(v); }

/// share: of the time; negative: not known apart.
json effect(const char* name, bool used, const std::string& why, double share = -1.0) {
    json out = {{"name", name}, {"status", used ? "simulated" : "skipped"}, {"reason", why}};
    if (used && share >= 0.0) out["time_share"] = share;
    return out;
}

size_t count_of(const Snapshot& s, ElementKind kind) {
    return static_cast<size_t>(
        std::count_if(s.elements.begin(), s.elements.end(), [&](const Element& e) { return e.kind == kind; }));
}

json element_effect(const Snapshot& s, ElementKind kind, const char* name, double share) {
    const size_t count = count_of(s, kind);
    return effect(name, count != 0, count != 0 ? n(count) : "the scene has none", share);
}

json combinations_effect(const Job& job, const JobOutput& o) {
    constexpr const char* kName = "combinations of elements";
    const Snapshot& s = job.scene();
    if (job.settings().trial == 0) {
        const auto count = std::count_if(o.pages.terms.begin(), o.pages.terms.end(),
                                         [](const BakedTerm& t) { return t.elements.size() > 1; });
        return effect(kName, count != 0, n(static_cast<size_t>(count)) + " terms");
    }
    const bool possible = s.elements.size() > std::max<size_t>(count_of(s, ElementKind::light_set), 1);
    const bool asked = job.settings().combinations != AJAR_COMBINATIONS_NONE;
    return effect(kName, possible && asked,
                  !possible ? "nothing to combine"
                  : asked   ? "where they matter"
                            : "none asked");
}

json seams_effect(const Job& job, const JobOutput& o, double share) {
    const bool planned = job.settings().trial != 0, asked = job.settings().stitch_seams != 0;
    return effect("seam stitching", planned ? asked : o.pages.seam_points != 0,
                  !asked    ? "none asked"
                  : planned ? "where charts meet"
                            : n(o.pages.seam_points) + " seam points",
                  share);
}

} // namespace

json effects_json(const Job& job, const JobOutput& o, const std::array<double, AJAR_STAGE_COUNT>& seconds) {
    const Snapshot& s = job.scene();
    size_t primary = 0, transmissive = 0, unmapped = 0, lit = 0;
    for (const Light& l : s.lights) primary += l.primary && !l.dark(), lit += !l.dark();
    for (const Material& m : s.materials) transmissive += m.transmits;
    for (const Instance& i : s.instances) unmapped += !i.lightmapped;
    const std::array<double, kEffects> shares = time_shares(o.work, seconds);
    const auto share = [&](Effect e) { return shares[static_cast<size_t>(e)]; };
    const uint32_t bounces = job.settings().bounces;
    return {
        effect("primary lights", primary != 0, n(primary) + " lamps", share(Effect::primary_lights)),
        effect("static lights", lit != primary, n(lit - primary) + " lamps", share(Effect::static_lights)),
        effect("emissive surfaces", o.emissive_triangles != 0, n(o.emissive_triangles) + " triangles",
               share(Effect::emissive_surfaces)),
        effect("sky", s.sky.lit(),
               !s.sky.lit()    ? "no sky or black"
               : o.sky_sampled ? "image, importance sampled"
                               : "constant",
               share(Effect::sky)),
        effect("transparency", transmissive != 0, n(transmissive) + " materials", share(Effect::transparency)),
        effect("surfaces without lightmap", unmapped != 0, n(unmapped) + " objects", share(Effect::unmapped_surfaces)),
        effect("aiming at bright texels", o.bake.bright_texels != 0, n(o.bake.bright_texels) + " texels",
               share(Effect::bright_texels)),
        element_effect(s, ElementKind::light_set, "light sets", share(Effect::light_sets)),
        element_effect(s, ElementKind::door, "doors", share(Effect::doors)),
        element_effect(s, ElementKind::toggle, "toggles", share(Effect::toggles)),
        combinations_effect(job, o),
        effect("bounces", bounces != 0, n(bounces) + " bounces", share(Effect::bounces)),
        seams_effect(job, o, share(Effect::seams))};
}

} // namespace ajar
