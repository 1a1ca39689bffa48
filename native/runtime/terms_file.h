// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "file_view.h"
#include "terms_format.h"

namespace ajar::runtime {

/// terms.bin in memory. Every offset, count and id in it is checked, so that whoever reads it need not.
class TermsFile {
public:
    /// Throws Error: AJAR_RUNTIME_ERROR_IO, or AJAR_RUNTIME_ERROR_DATA for a file that is damaged, cut short,
    /// contradicts itself or is of a version that this library does not know.
    explicit TermsFile(const std::string& path);
    /// The second half of the check, to be called once the pages' sizes are known to be right, before
    /// anything of the dispatches is used. Throws Error(AJAR_RUNTIME_ERROR_DATA).
    void check_dispatches() const;

    std::span<const terms::Element> elements() const { return elements_; }
    std::span<const terms::Page> pages() const { return pages_; }
    std::span<const terms::Term> terms() const { return terms_; }
    std::span<const terms::Dispatch> dispatches() const { return dispatches_; }
    /// Terms of a dispatch, ascending.
    std::span<const uint16_t> palette(const terms::Dispatch& d) const {
        return palette_.subspan(d.palette, d.palette_count);
    }
    std::span<const uint16_t> palettes() const { return palette_; }
    std::span<const uint32_t> data() const { return data_; }
    std::string element_name(size_t element) const;

private:
    [[noreturn]] void refuse(const char* fault) const;

    std::string path_;
    FileView file_;
    std::span<const char> strings_;
    std::span<const terms::Element> elements_;
    std::span<const terms::Page> pages_;
    std::span<const terms::Term> terms_;
    std::span<const terms::Dispatch> dispatches_;
    std::span<const uint16_t> palette_;
    std::span<const uint32_t> data_;
};

} // namespace ajar::runtime
