// SPDX-License-Identifier: GPL-3.0-or-later
// ajar_job_*: check, guard, forward.
#include <bit>

#include "api/check_report.h"
#include "api/guard.h"
#include "api/tables.h"
#include "package/package_writer.h"

using namespace ajar;

namespace {

ajar_settings checked_settings(const ajar_settings* settings) {
    const ajar_settings s = checked(settings);
    const auto fail = [](const char* text) { throw Error(AJAR_ERROR_ARGUMENT, text, "settings"); };
    if (!(s.noise_target >= 0.0f) || s.noise_target > 10.0f) fail("noise_target must lie in 0..10");
    if (!(s.time_limit >= 0.0f)) fail("time_limit must be 0 or more seconds");
    if (s.bounces > 256) fail("bounces must be 256 at most");
    if (!std::has_single_bit(s.samples) || s.samples > (1u << 20)) fail("samples must be a power of two up to 1048576");
    if (!std::has_single_bit(s.bounce_samples) || s.bounce_samples > (1u << 16))
        fail("bounce_samples must be a power of two up to 65536");
    if (s.direct_samples == 0 || s.direct_samples > (1u << 20)) fail("direct_samples must lie in 1..1048576");
    if (s.positions_per_texel == 0 || s.positions_per_texel > 16) fail("positions_per_texel must lie in 1..16");
    if (s.combinations > AJAR_COMBINATIONS_ALL) fail("combinations has an unknown value");
    if (s.light_patches > AJAR_LIGHT_PATCHES_RGB) fail("light_patches has an unknown value");
    if (s.trial > 1) fail("trial must be 0 or 1");
    if (!(s.term_threshold >= 0.0f) || s.term_threshold > 1.0f) fail("term_threshold must lie in 0..1");
    if (!(s.door_rays >= 0.0f) || s.door_rays > 1.0f) fail("door_rays must lie in 0..1");
    if (!(s.memory_limit >= 0.0f) || s.memory_limit > 1e6f) fail("memory_limit must lie in 0..1000000 GB");
    if (s.check_points > (1u << 20)) fail("check_points must be 1048576 at most");
    if (s.threads > 1024) fail("threads must be 1024 at most");
    return s;
}

struct Layer {
    const float* data;
    uint32_t channels;
};

Layer find_layer(const BakedPages& b, uint32_t layer) {
    switch (layer) {
        case AJAR_LAYER_IRRADIANCE:
            return {&b.irradiance.data()->x, 3};
        case AJAR_LAYER_STDERR:
            return {b.standard_error.data(), 1};
        case AJAR_LAYER_SAMPLES:
            return {b.samples.data(), 1};
        case AJAR_LAYER_VALIDITY:
            return {b.validity.data(), 1};
        case AJAR_LAYER_ALBEDO:
            return {&b.albedo.data()->x, 3};
        case AJAR_LAYER_AHD:
            return {nullptr, 2};
        case AJAR_LAYER_SH:
            if (!b.sh_rgb.empty()) return {b.sh_rgb.data(), 27};
            throw Error(AJAR_ERROR_ARGUMENT, "the bake did not keep spherical harmonics; set keep_sh");
        default:
            break;
    }
    if (layer < AJAR_LAYER_BOUNCE || layer - AJAR_LAYER_BOUNCE >= b.bounces.size())
        throw Error(AJAR_ERROR_ARGUMENT, "the bake has no such layer");
    return {&b.bounces[layer - AJAR_LAYER_BOUNCE].data()->x, 3};
}

const Page& find_page(const Job& job, uint32_t page) {
    if (page >= job.scene().pages.size()) throw Error(AJAR_ERROR_ARGUMENT, "the bake has no such page");
    return job.scene().pages[page];
}

void copy_packed(const BakedPages& b, const Page& page, float* out) {
    const size_t texels = size_t{page.width} * page.height;
    for (size_t i = 0; i < texels; ++i) {
        std::memcpy(out + 2 * i, &b.packed_irradiance[page.first_texel + i], sizeof(float));
        std::memcpy(out + 2 * i + 1, &b.packed_direction[page.first_texel + i], sizeof(float));
    }
}

const WeightTerm& find_term(const Job& job, uint32_t index) {
    const auto& terms = job.output().weight_terms;
    if (index >= terms.size()) throw Error(AJAR_ERROR_ARGUMENT, "the bake has no such term");
    return terms[index];
}

/// Of the term with the same elements; a product that the weights alone bring about has no noise of its own.
void fill_term(const Job& job, uint32_t index, ajar_term_info& out) {
    const WeightTerm& term = find_term(job, index);
    init_struct(&out);
    out.element_count = static_cast<uint32_t>(term.elements.size());
    std::copy(term.elements.begin(), term.elements.end(), out.elements);
    std::vector<uint32_t> texels, sum;
    for (const WeightTerm::Part& part : term.parts) {
        if (part.term == WeightTerm::kBase) continue;
        const BakedTerm& t = job.output().pages.terms[part.term];
        sum.clear();
        std::set_union(texels.begin(), texels.end(), t.texel.begin(), t.texel.end(), std::back_inserter(sum));
        texels.swap(sum);
        out.is_signed |= t.is_signed || part.factor < 0.0f;
        if (t.elements == term.elements) out.relative_error = t.relative_error, out.discarded = t.discarded;
    }
    out.texel_count = index == 0 ? job.output().receivers.count() : texels.size();
    if (index == 0) out.is_signed = 0;
}

/// Adds what a part of a term brings to a page.
void add_part(const BakedPages& pages, const WeightTerm::Part& part, const Page& page, float* out) {
    const uint64_t texels = uint64_t{page.width} * page.height;
    const auto add = [&](uint64_t local, const Vec3& e) {
        for (int c = 0; c < 3; ++c) out[3 * local + static_cast<uint64_t>(c)] += part.factor * e[c];
    };
    if (part.term == WeightTerm::kBase) {
        for (uint64_t i = 0; i < texels; ++i) add(i, pages.irradiance[page.first_texel + i]);
        return;
    }
    const BakedTerm& term = pages.terms[part.term];
    for (size_t i = 0; i < term.texel.size(); ++i)
        if (const uint64_t local = term.texel[i] - page.first_texel; local < texels) add(local, term.irradiance[i]);
}

} // namespace

extern "C" {

AJAR_API ajar_result ajar_job_start(ajar_scene scene, const ajar_settings* settings, ajar_job* out) {
    return guarded([&] {
        check_cpu();
        const auto builder = scenes().get(scene);
        const ajar_settings s = checked_settings(settings);
        ajar_job& handle = required(out);
        if (!builder->committed()) throw Error(AJAR_ERROR_STATE, "commit the scene before baking it");
        handle = static_cast<ajar_job>(jobs().add(std::make_shared<Job>(builder->snapshot(), s)));
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_job_poll(ajar_job job, ajar_progress* out) {
    return guarded([&] {
        const auto j = jobs().get(job);
        checked(out);
        j->task().poll(*out);
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_job_cancel(ajar_job job) {
    return guarded([&] {
        jobs().get(job)->task().cancel();
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_job_wait(ajar_job job, double timeout) {
    return guarded([&]() -> ajar_result {
        const auto j = jobs().get(job);
        const ajar_result result = j->task().wait(timeout == timeout ? timeout : 0.0);
        if (result >= 0) return result;
        const Warning why = j->task().failure();
        return remember(result, why.text.c_str(), why.culprit.c_str());
    });
}

AJAR_API ajar_result ajar_job_error(ajar_job job, char* text, uint64_t text_size, char* culprit,
                                    uint64_t culprit_size) {
    return guarded([&] {
        const Warning why = jobs().get(job)->task().failure();
        copy_text(why.text, text, text_size);
        copy_text(why.culprit, culprit, culprit_size);
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_job_release(ajar_job* job) {
    return guarded([&] {
        const auto j = jobs().take(required(job));
        *job = nullptr;
        // Another thread may wait for it and keep it alive: end it here all the same.
        j->task().cancel();
        j->task().wait(-1.0);
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_job_layer_size(ajar_job job, uint32_t page, uint32_t layer, uint32_t* width, uint32_t* height,
                                         uint32_t* channels) {
    return guarded([&] {
        const auto j = jobs().get(job);
        const JobOutput& output = j->output();
        const Page& p = find_page(*j, page);
        required(channels) = find_layer(output.pages, layer).channels;
        required(width) = p.width;
        required(height) = p.height;
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_job_read_layer(ajar_job job, uint32_t page, uint32_t layer, float* buffer,
                                         uint64_t float_count) {
    return guarded([&] {
        const auto j = jobs().get(job);
        const JobOutput& output = j->output();
        const Page& p = find_page(*j, page);
        const Layer l = find_layer(output.pages, layer);
        const uint64_t needed = uint64_t{l.channels} * p.width * p.height;
        if (buffer == nullptr || float_count < needed)
            throw Error(AJAR_ERROR_BUFFER, "the buffer holds fewer floats than the layer");
        if (l.data == nullptr)
            copy_packed(output.pages, p, buffer);
        else
            std::memcpy(buffer, l.data + p.first_texel * l.channels, needed * sizeof(float));
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_job_term_count(ajar_job job, uint32_t* out) {
    return guarded([&] {
        const auto j = jobs().get(job);
        required(out) = static_cast<uint32_t>(j->output().weight_terms.size());
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_job_term(ajar_job job, uint32_t term, ajar_term_info* out) {
    return guarded([&] {
        const auto j = jobs().get(job);
        checked(out);
        fill_term(*j, term, *out);
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_job_read_term(ajar_job job, uint32_t term, uint32_t page, float* buffer,
                                        uint64_t float_count) {
    return guarded([&] {
        const auto j = jobs().get(job);
        const WeightTerm& t = find_term(*j, term);
        const Page& p = find_page(*j, page);
        const uint64_t needed = uint64_t{3} * p.width * p.height;
        if (buffer == nullptr || float_count < needed)
            throw Error(AJAR_ERROR_BUFFER, "the buffer holds fewer floats than the page");
        std::fill(buffer, buffer + needed, 0.0f);
        for (const WeightTerm::Part& part : t.parts) add_part(j->output().pages, part, p, buffer);
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_job_report(ajar_job job, char* buffer, uint64_t* size) {
    return guarded([&] {
        const std::string report = jobs().get(job)->report();
        const uint64_t available = required(size);
        *size = report.size() + 1;
        if (buffer == nullptr) return AJAR_OK;
        if (available < report.size() + 1) throw Error(AJAR_ERROR_BUFFER, "the buffer is smaller than the report");
        std::memcpy(buffer, report.c_str(), report.size() + 1);
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_job_write_package(ajar_job job, const char* directory, const char* extras) {
    return guarded([&] {
        const auto j = jobs().get(job);
        if (directory == nullptr || *directory == 0) throw Error(AJAR_ERROR_ARGUMENT, "the package needs a directory");
        PackageContent content = package_content(j->scene(), j->output().pages, j->settings());
        if (extras != nullptr)
            content.extras =
                *extras != 0 ? extras : throw Error(AJAR_ERROR_ARGUMENT, "the package's extras are not a JSON object");
        if (j->settings().check_points != 0) content.self_check = check_json(j->output().check).dump();
        const std::optional<TermsFile>& terms_file = j->output().check.terms_file;
        write_package(content, directory, terms_file ? &*terms_file : nullptr);
        return AJAR_OK;
    });
}

} // extern "C"
