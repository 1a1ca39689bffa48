// SPDX-License-Identifier: Apache-2.0
#include "terms_file.h"

#include <utility>

#include "error.h"
#include "terms_check.h"

namespace ajar::runtime {
namespace {

template <class T>
bool take_section(std::span<const uint8_t> file, const terms::Header& header, terms::Section section,
                  std::span<const T>& out) {
    const terms::SectionPlace place = header.sections[section];
    if (place.offset % terms::kSectionAlignment != 0 || place.size % sizeof(T) != 0) return false;
    if (place.offset > file.size() || place.size > file.size() - place.offset) return false;
    out = {reinterpret_cast<const T*>(file.data() + place.offset), static_cast<size_t>(place.size / sizeof(T))};
    return true;
}

const char* find_header_fault(std::span<const uint8_t> file) {
    terms::Header header;
    if (file.size() < sizeof header) return "it is cut short";
    std::memcpy(&header, file.data(), sizeof header);
    if (std::memcmp(header.magic, terms::kMagic, sizeof header.magic) != 0) return "it is another kind of file";
    if (header.version != terms::kVersion) return "it is of a version that this library does not know";
    if (header.file_size != file.size()) return "it is cut short or has grown";
    if (header.section_count != terms::kSectionCount) return "it has a wrong number of sections";
    if (header.checksum != terms::terms_checksum(file)) return "its checksum is wrong";
    return nullptr;
}

} // namespace

void TermsFile::refuse(const char* fault) const {
    throw Error(AJAR_RUNTIME_ERROR_DATA, "\"" + path_ + "\" cannot be used: " + fault + ". Bake or copy it again.");
}

TermsFile::TermsFile(const std::string& path) : path_(path), file_(path) {
    const std::span<const uint8_t> bytes = std::as_const(file_).bytes();
    if (const char* fault = find_header_fault(bytes)) refuse(fault);
    const auto& header = *reinterpret_cast<const terms::Header*>(bytes.data());
    const bool in_place =
        take_section(bytes, header, terms::kStrings, strings_) &&
        take_section(bytes, header, terms::kElements, elements_) &&
        take_section(bytes, header, terms::kPages, pages_) && take_section(bytes, header, terms::kTerms, terms_) &&
        take_section(bytes, header, terms::kDispatches, dispatches_) &&
        take_section(bytes, header, terms::kPalette, palette_) && take_section(bytes, header, terms::kData, data_);
    if (!in_place || palette_.size() % 2 != 0) refuse("a section is out of place");
    if (const char* fault = find_table_fault(*this, strings_.size())) refuse(fault);
}

void TermsFile::check_dispatches() const {
    if (const char* fault = find_dispatch_fault(*this)) refuse(fault);
}

std::string TermsFile::element_name(size_t element) const {
    const terms::Element& e = elements_[element];
    return {strings_.data() + e.name_offset, e.name_size};
}

} // namespace ajar::runtime
