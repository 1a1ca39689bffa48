// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ajar_runtime.h"
#include "kernel.h"
#include "page.h"
#include "terms_file.h"
#include "texel.h"

namespace ajar::runtime {

/// An element and what hangs on it.
struct ElementState {
    std::string name;
    terms::Kind kind = terms::Kind::light_set;
    float start_weight = 1.0f, weight = 1.0f;
    Rgb color{1.0f, 1.0f, 1.0f};
    bool changed = true;              ///< since the last update
    std::vector<uint32_t> terms;      ///< that it is part of
    std::vector<uint32_t> dispatches; ///< that hold one of these terms
    uint64_t texels = 0;              ///< receivers of these dispatches
};

/// An open package: weights in, pages out. Nothing is allocated after construction, but for
/// plan_update's first call.
class Runtime {
public:
    /// Throws Error.
    explicit Runtime(const std::string& directory);

    const std::vector<ElementState>& elements() const { return elements_; }
    /// Both throw Error(AJAR_RUNTIME_ERROR_ARGUMENT) for values out of range.
    void set_weight(uint32_t element, float weight);
    void set_color(uint32_t element, const Rgb& color);

    /// Brings the pages up to the weights.
    ajar_runtime_stats update();
    /// Says what update would run, and counts it as done.
    ajar_runtime_work plan_update();
    ajar_runtime_buffers buffers() const;

    std::vector<Page>& pages() { return pages_; }
    const ajar_runtime_rect& dirty(uint32_t page) const { return dirty_.at(page); }

private:
    void open_pages(const std::string& directory);
    void link_terms();
    void link_elements();
    void element_range(uint32_t element) const;
    TermWeight weigh(const terms::Term& term) const;
    /// Renews the weights of terms and lists the dispatches that hold one that changed.
    void collect_changes();
    ajar_runtime_stats mark_dirty();

    std::optional<TermsFile> file_;
    std::vector<Page> pages_;
    std::vector<ElementState> elements_;
    std::vector<TermWeight> weights_;                    ///< of terms, as last applied
    std::vector<std::vector<uint32_t>> term_dispatches_; ///< dispatches that hold each term
    std::vector<uint8_t> is_listed_;                     ///< dispatches in changes_
    std::vector<uint32_t> changes_;
    std::vector<uint32_t> groups_;
    std::vector<ajar_runtime_rect> dirty_;
};

} // namespace ajar::runtime
