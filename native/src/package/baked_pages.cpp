// SPDX-License-Identifier: GPL-3.0-or-later
#include "package/baked_pages.h"

#include "package/baked_terms.h"
#include "package/exposure.h"
#include "package/fill_terms.h"
#include "post/dilate.h"
#include "post/stitch.h"

namespace ajar {

namespace {

constexpr uint32_t kFillRadius = 8; ///< texels around charts that get a copy of the nearest one

enum : uint8_t { kUncovered = 0, kInvalid = 1, kRing = 2, kValid = 3 };

struct Assembler {
    const Snapshot& scene;
    const LightmapReceivers& receivers;
    const BakeResult& result;
    BakedPages out;
    std::vector<uint8_t> state, usable;
    std::unique_ptr<SeamSolver> solver;

    void scatter();
    void stitch();
    void collect_terms(ThreadPool& pool, Progress& progress);
    void expose();
    void encode(ThreadPool& pool, Progress& progress);
    void fill();
};

void Assembler::scatter() {
    const size_t texels = scene.texel_count();
    for (auto* v : {&out.irradiance, &out.albedo}) v->assign(texels, Vec3(0.0f));
    for (auto* v : {&out.standard_error, &out.samples, &out.validity}) v->assign(texels, 0.0f);
    out.bounces.assign(result.bounces.size(), std::vector<Vec3>(texels, Vec3(0.0f)));
    out.sh_rgb.assign(result.sh_rgb.empty() ? 0 : texels * 27, 0.0f);
    state.assign(texels, kUncovered);
    for (uint32_t r = 0; r < receivers.count(); ++r) {
        const uint32_t t = receivers.texel[r];
        const bool inside = result.inside[r] > kInsideShare;
        state[t] = inside ? kInvalid : receivers.ring[r] ? kRing : kValid;
        out.invalid_texels += inside;
        out.irradiance[t] = result.irradiance[r];
        out.albedo[t] = receivers.albedo[r];
        out.standard_error[t] = result.standard_error[r];
        out.samples[t] = result.samples[r];
        for (size_t b = 0; b < out.bounces.size(); ++b) out.bounces[b][t] = result.bounces[b][r];
        for (size_t c = 0; c < (out.sh_rgb.empty() ? 0 : 27); ++c)
            out.sh_rgb[size_t{t} * 27 + c] = result.sh_rgb[size_t{r} * 27 + c];
    }
    usable.resize(state.size());
    for (size_t i = 0; i < state.size(); ++i) usable[i] = state[i] >= kRing;
}

void Assembler::stitch() {
    solver = std::make_unique<SeamSolver>(find_seams(scene), usable);
    out.seam_points = solver->points();
    if (out.seam_points != 0) solver->solve(out.irradiance);
}

void Assembler::collect_terms(ThreadPool& pool, Progress& progress) {
    if (result.terms.terms.empty()) return;
    const Working here(bookkeeping_effect(scene.elements));
    out.discarded = result.terms.all_discarded;
    out.terms = make_terms(receivers, result.terms, usable, solver.get(), pool, progress);
}

/// The unit of packed irradiance, and what does not fit into it.
void Assembler::expose() {
    std::vector<float> brightest = brightest_light(scene, out);
    for (size_t t = 0; t < brightest.size(); ++t)
        if (usable[t] == 0) brightest[t] = 0.0f;
    out.scale = choose_scale(scene, brightest);
    out.warnings = exposure_warnings(scene, receivers, brightest, out.scale);
}

void Assembler::encode(ThreadPool& pool, Progress& progress) {
    out.packed_irradiance.assign(state.size(), 0);
    out.packed_direction.assign(state.size(), pack_direction({}));
    std::vector<uint64_t> clamped(receivers.tiles.size(), 0);
    pool.for_each(receivers.tiles.size(), progress, [&](size_t i) {
        for (uint32_t r = receivers.tiles[i].first; r < receivers.tiles[i].first + receivers.tiles[i].count; ++r) {
            const uint32_t t = receivers.texel[r];
            // The shape is that of the gathered light: stitching changes the brightness, not the directions.
            Ahd ahd = fit_ahd(result.irradiance[r], &result.sh[size_t{r} * kShCount]);
            ahd.irradiance = out.irradiance[t];
            out.packed_irradiance[t] = pack_r11g11b10f(ahd.irradiance / out.scale);
            out.packed_direction[t] = pack_direction(ahd);
            clamped[i] += max_component(ahd.irradiance) > kLargestPacked * out.scale;
        }
    });
    for (const uint64_t c : clamped) out.clamped_texels += c;
}

void Assembler::fill() {
    const std::vector<uint32_t> source = nearest_known(scene.pages, usable, kFillRadius);
    for (size_t i = 0; i < source.size(); ++i) {
        out.validity[i] = state[i] == kValid ? 1.0f : state[i] == kRing ? 0.75f : state[i] == kInvalid ? 0.5f : 0.0f;
        if (source[i] == i) continue;
        out.irradiance[i] = out.irradiance[source[i]];
        out.packed_irradiance[i] = out.packed_irradiance[source[i]];
        out.packed_direction[i] = out.packed_direction[source[i]];
        for (size_t c = 0; c < (out.sh_rgb.empty() ? 0 : 27); ++c)
            out.sh_rgb[i * 27 + c] = out.sh_rgb[size_t{source[i]} * 27 + c];
    }
    fill_terms(source, out.terms);
}

std::span<const float> floats_of(const std::vector<Vec3>& v, const Page& p) {
    return {&v[p.first_texel].x, size_t{3} * p.width * p.height};
}

template <class T>
std::span<const T> part_of(const std::vector<T>& v, const Page& p, size_t channels = 1) {
    return v.empty() ? std::span<const T>{}
                     : std::span<const T>{&v[p.first_texel * channels], channels * p.width * p.height};
}

const char* kind_name(ElementKind kind) {
    return kind == ElementKind::light_set ? "light_set" : kind == ElementKind::door ? "door" : "toggle";
}

} // namespace

BakedPages make_pages(const Snapshot& scene, const LightmapReceivers& receivers, const BakeResult& result,
                      const ajar_settings& settings, ThreadPool& pool, Progress& progress) {
    Assembler a{scene, receivers, result, {}, {}, {}, {}};
    a.scatter();
    if (settings.stitch_seams != 0) a.stitch();
    progress.begin_stage(AJAR_STAGE_ENCODE, 1.0f);
    a.collect_terms(pool, progress);
    a.expose();
    a.encode(pool, progress);
    a.fill();
    return std::move(a.out);
}

PackageContent package_content(const Snapshot& scene, const BakedPages& baked, const ajar_settings& settings) {
    PackageContent c;
    c.name = scene.name;
    c.scale = baked.scale;
    for (const Page& p : scene.pages) {
        PackagePage page;
        page.width = p.width;
        page.height = p.height;
        page.irradiance = floats_of(baked.irradiance, p);
        page.stderr_ = part_of(baked.standard_error, p);
        page.samples = part_of(baked.samples, p);
        page.validity = part_of(baked.validity, p);
        page.sh = part_of(baked.sh_rgb, p, 27);
        page.packed_irradiance = part_of(baked.packed_irradiance, p);
        page.packed_direction = part_of(baked.packed_direction, p);
        c.pages.push_back(page);
    }
    for (const Instance& i : scene.instances)
        if (i.lightmapped)
            c.instances.push_back({i.name,
                                   i.page,
                                   {i.uv_scale.x, i.uv_scale.y},
                                   {i.uv_offset.x, i.uv_offset.y},
                                   "AjarLightmap",
                                   i.bake_back});
    for (const Element& e : scene.elements) c.elements.push_back({e.name, kind_name(e.kind), e.weight});
    for (const Light& l : scene.lights)
        c.lights.push_back({l.name, l.primary ? "primary" : "static",
                            l.light_set == kNoElement ? "" : scene.elements[l.light_set].name});
    for (const BakedTerm& t : baked.terms)
        c.terms.push_back({t.elements,
                           t.is_signed,
                           t.relative_error,
                           t.discarded,
                           t.texel,
                           {t.irradiance.empty() ? nullptr : &t.irradiance[0].x, 3 * t.irradiance.size()},
                           t.packed_direction});
    c.discarded = baked.discarded;
    c.light_patches = static_cast<LightPatchPlanes>(settings.light_patches);
    c.overlap_pictures = settings.overlap_pictures != 0;
    return c;
}

} // namespace ajar
