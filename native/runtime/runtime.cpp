// SPDX-License-Identifier: Apache-2.0
#include "runtime.h"

#include <algorithm>
#include <cstring>

#include "error.h"

namespace ajar::runtime {
namespace {

/// Factors of terms whose magnitude is beyond these bounds are taken as 0, or as the bound: sums of terms then
/// neither overflow nor need the numbers that some processors flush to zero.
constexpr double kFaintest = 1e-24, kBrightest = 1e30, kProductLimit = 1e60;

float bounded(double factor) {
    return std::fabs(factor) < kFaintest ? 0.0f : static_cast<float>(std::clamp(factor, -kBrightest, kBrightest));
}

bool same_bits(const TermWeight& a, const TermWeight& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

ajar_runtime_rect rect_of(const terms::Dispatch& d) {
    const uint32_t x0 = d.rect_min & 0xffffu, y0 = d.rect_min >> 16;
    return {x0, y0, (d.rect_max & 0xffffu) - x0 + 1, (d.rect_max >> 16) - y0 + 1};
}

ajar_runtime_rect united(const ajar_runtime_rect& a, const ajar_runtime_rect& b) {
    if (a.width == 0) return b;
    const uint32_t x0 = std::min(a.x, b.x), x1 = std::max(a.x + a.width, b.x + b.width);
    const uint32_t y0 = std::min(a.y, b.y), y1 = std::max(a.y + a.height, b.y + b.height);
    return {x0, y0, x1 - x0, y1 - y0};
}

} // namespace

Runtime::Runtime(const std::string& directory) {
    const std::string path = directory + "/" + terms::kFileName;
    if (file_exists(path)) file_.emplace(path);
    open_pages(directory);
    dirty_.resize(pages_.size());
    if (!file_) return;
    file_->check_dispatches();
    link_terms();
    link_elements();
}

void Runtime::open_pages(const std::string& directory) {
    if (!file_) { // no elements, and no list of pages
        while (file_exists(Page::irradiance_path(directory, pages_.size())))
            pages_.emplace_back(directory, pages_.size());
        if (pages_.empty()) throw Error(AJAR_RUNTIME_ERROR_IO, "there is no Ajar package in \"" + directory + "\"");
        return;
    }
    for (const terms::Page& known : file_->pages()) {
        const Page& page = pages_.emplace_back(directory, pages_.size());
        if (page.width() != known.width || page.height() != known.height ||
            !page.matches(known.irradiance_checksum, known.direction_checksum))
            throw Error(AJAR_RUNTIME_ERROR_DATA, "page " + std::to_string(pages_.size() - 1) + " in \"" + directory +
                                                     "\" is damaged or from another bake. Bake or copy it again.");
    }
}

void Runtime::link_terms() {
    weights_.assign(file_->terms().size(), {});
    term_dispatches_.resize(file_->terms().size());
    for (uint32_t d = 0; d < file_->dispatches().size(); ++d)
        for (const uint16_t term : file_->palette(file_->dispatches()[d])) term_dispatches_[term].push_back(d);
    is_listed_.assign(file_->dispatches().size(), 0);
    changes_.reserve(file_->dispatches().size());
}

void Runtime::link_elements() {
    for (size_t i = 0; i < file_->elements().size(); ++i) {
        const terms::Element& e = file_->elements()[i];
        ElementState& state = elements_.emplace_back();
        state.name = file_->element_name(i);
        state.kind = static_cast<terms::Kind>(e.kind);
        state.start_weight = state.weight = e.weight;
    }
    for (uint32_t t = 0; t < file_->terms().size(); ++t) {
        const terms::Term& term = file_->terms()[t];
        for (uint32_t i = 0; i < term.element_count; ++i) {
            ElementState& state = elements_[term.elements[i]];
            state.terms.push_back(t);
            state.dispatches.insert(state.dispatches.end(), term_dispatches_[t].begin(), term_dispatches_[t].end());
        }
    }
    for (ElementState& state : elements_) {
        std::sort(state.dispatches.begin(), state.dispatches.end());
        state.dispatches.erase(std::unique(state.dispatches.begin(), state.dispatches.end()), state.dispatches.end());
        for (const uint32_t d : state.dispatches) state.texels += file_->dispatches()[d].receivers;
    }
}

void Runtime::element_range(uint32_t element) const {
    if (element >= elements_.size())
        throw Error(AJAR_RUNTIME_ERROR_ARGUMENT, "there is no element " + std::to_string(element));
}

void Runtime::set_weight(uint32_t element, float weight) {
    element_range(element);
    ElementState& state = elements_[element];
    const bool in_range =
        weight >= 0.0f && std::isfinite(weight) && (state.kind == terms::Kind::light_set || weight <= 1.0f);
    if (!in_range)
        throw Error(AJAR_RUNTIME_ERROR_ARGUMENT,
                    "weight " + std::to_string(weight) + " of \"" + state.name + "\" is out of range");
    state.weight = weight;
    state.changed = true;
}

void Runtime::set_color(uint32_t element, const Rgb& color) {
    element_range(element);
    ElementState& state = elements_[element];
    if (state.kind != terms::Kind::light_set)
        throw Error(AJAR_RUNTIME_ERROR_ARGUMENT, "\"" + state.name + "\" is no light set and has no colour");
    for (const float c : {color.r, color.g, color.b})
        if (!(c >= 0.0f) || !std::isfinite(c))
            throw Error(AJAR_RUNTIME_ERROR_ARGUMENT, "the colour of \"" + state.name + "\" is negative or not finite");
    state.color = color;
    state.changed = true;
}

/// Zero wherever a factor is zero, whatever the others are.
TermWeight Runtime::weigh(const terms::Term& term) const {
    double r = term.scale, g = term.scale, b = term.scale;
    const auto limited = [](double factor) { return std::clamp(factor, -kProductLimit, kProductLimit); };
    for (uint32_t i = 0; i < term.element_count; ++i) {
        const ElementState& state = elements_[term.elements[i]];
        const double x = terms::element_variable(file_->elements()[term.elements[i]], state.weight);
        if (x == 0.0) return {};
        r = state.color.r == 0.0f ? 0.0 : limited(r * x * state.color.r);
        g = state.color.g == 0.0f ? 0.0 : limited(g * x * state.color.g);
        b = state.color.b == 0.0f ? 0.0 : limited(b * x * state.color.b);
    }
    const TermWeight out{bounded(r), bounded(g), bounded(b), 0.0f};
    return {out.r, out.g, out.b, out.r != 0.0f || out.g != 0.0f || out.b != 0.0f ? 1.0f : 0.0f};
}

void Runtime::collect_changes() {
    changes_.clear();
    for (ElementState& state : elements_) {
        if (!state.changed) continue;
        state.changed = false;
        for (const uint32_t t : state.terms) {
            const TermWeight weight = weigh(file_->terms()[t]);
            if (same_bits(weight, weights_[t])) continue;
            weights_[t] = weight;
            for (const uint32_t d : term_dispatches_[t]) {
                if (is_listed_[d] == 0) changes_.push_back(d);
                is_listed_[d] = 1;
            }
        }
    }
    for (const uint32_t d : changes_) is_listed_[d] = 0;
    std::sort(changes_.begin(), changes_.end()); // one page after the other
}

ajar_runtime_stats Runtime::mark_dirty() {
    ajar_runtime_stats stats;
    ajar_runtime_stats_init(&stats);
    stats.dispatches = static_cast<uint32_t>(changes_.size());
    std::fill(dirty_.begin(), dirty_.end(), ajar_runtime_rect{});
    for (const uint32_t index : changes_) {
        const terms::Dispatch& d = file_->dispatches()[index];
        stats.texels += d.receivers;
        dirty_[d.page] = united(dirty_[d.page], rect_of(d));
    }
    for (const ajar_runtime_rect& rect : dirty_) stats.pages += rect.width > 0;
    return stats;
}

ajar_runtime_stats Runtime::update() {
    collect_changes();
    for (const uint32_t index : changes_) {
        const terms::Dispatch& d = file_->dispatches()[index];
        Page& page = pages_[d.page];
        const auto run = static_cast<terms::Class>(d.kind) == terms::Class::b ? run_block_dispatch : run_dispatch;
        run(d, file_->data().data(), file_->palette(d).data(), weights_.data(),
            {page.width(), page.irradiance(), page.direction()});
    }
    return mark_dirty();
}

ajar_runtime_work Runtime::plan_update() {
    ajar_runtime_work work;
    ajar_runtime_work_init(&work);
    if (file_ && groups_.capacity() == 0) {
        size_t groups = 0;
        for (const terms::Dispatch& d : file_->dispatches())
            groups += (d.receivers + AJAR_RUNTIME_GROUP_SIZE - 1) / AJAR_RUNTIME_GROUP_SIZE;
        groups_.reserve(2 * groups);
    }
    collect_changes();
    groups_.clear();
    for (const uint32_t d : changes_)
        for (uint32_t first = 0; first < file_->dispatches()[d].receivers; first += AJAR_RUNTIME_GROUP_SIZE) {
            groups_.push_back(d);
            groups_.push_back(first);
        }
    work.group_count = static_cast<uint32_t>(groups_.size() / 2);
    work.groups = groups_.data();
    static_assert(sizeof(TermWeight) == 4 * sizeof(float));
    work.term_weights = weights_.empty() ? nullptr : &weights_[0].r;
    work.stats = mark_dirty();
    return work;
}

ajar_runtime_buffers Runtime::buffers() const {
    ajar_runtime_buffers out;
    ajar_runtime_buffers_init(&out);
    if (!file_) return out;
    out.dispatch_count = static_cast<uint32_t>(file_->dispatches().size());
    out.term_count = static_cast<uint32_t>(file_->terms().size());
    out.dispatches = reinterpret_cast<const uint32_t*>(file_->dispatches().data());
    out.palette = reinterpret_cast<const uint32_t*>(file_->palettes().data());
    out.data = file_->data().data();
    out.palette_words = file_->palettes().size() / 2;
    out.data_words = file_->data().size();
    return out;
}

} // namespace ajar::runtime
