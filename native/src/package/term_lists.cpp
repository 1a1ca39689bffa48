// SPDX-License-Identifier: GPL-3.0-or-later
#include "package/term_lists.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/error.h"
#include "encode/ahd.h"
#include "runtime/terms_format.h"

namespace ajar {
namespace {

Vec3 irradiance_of(const PackageTerm& term, size_t i) {
    return {term.irradiance[3 * i], term.irradiance[3 * i + 1], term.irradiance[3 * i + 2]};
}

uint64_t texel_count(const PackageContent& content) {
    uint64_t count = 0;
    for (const PackagePage& page : content.pages) count += uint64_t{page.width} * page.height;
    return count;
}

bool strictly_ascending(const auto& values) {
    return std::adjacent_find(values.begin(), values.end(), std::greater_equal<>()) == values.end();
}

void check_term(const PackageContent& content, const PackageTerm& term, size_t index) {
    const auto refuse = [&](const char* why) {
        throw Error(AJAR_ERROR_ARGUMENT, "Term " + std::to_string(index) + " of the package " + why);
    };
    if (term.elements.empty() || term.elements.size() > terms::kMaxElements) refuse("has no or too many elements");
    if (!strictly_ascending(term.elements)) refuse("names its elements out of order");
    if (term.elements.back() >= content.elements.size()) refuse("names an element that is not there");
    const size_t count = term.texel.size();
    if (term.irradiance.size() != 3 * count || term.direction.size() != count) refuse("has arrays of different length");
    if (!strictly_ascending(term.texel)) refuse("names its texels out of order");
    if (count > 0 && term.texel.back() >= texel_count(content)) refuse("names a texel outside the pages");
    for (const float v : term.irradiance)
        if (!std::isfinite(v)) refuse("holds light that is not finite");
}

void check_element(const PackageElement& element) {
    const bool in_range = element.weight >= 0.0f && std::isfinite(element.weight) &&
                          (element.kind == "light_set" || element.weight <= 1.0f);
    if (!in_range)
        throw Error(AJAR_ERROR_ARGUMENT, "The weight of element \"" + element.name + "\" is out of range",
                    element.name);
}

StoredTerm make_stored(const PackageTerm& term) {
    StoredTerm s;
    s.is_signed = term.is_signed;
    float largest = 0.0f;
    for (const float v : term.irradiance) {
        largest = std::max(largest, std::fabs(v));
        s.is_signed |= v < 0.0f;
    }
    s.scale = storage_scale(largest);
    return s;
}

bool is_black(const PackageTerm& term, const StoredTerm& stored, size_t index) {
    const auto words = entry_words(term, stored, index, stored.is_signed);
    return stored.is_signed ? ((words[0] & 0x7fff7fffu) | (words[1] & 0x7fffu)) == 0 : words[0] == 0;
}

void count_entries(const PackageContent& content, TermLists& lists) {
    lists.first.assign(texel_count(content) + 1, 0);
    for (size_t t = 0; t < content.terms.size(); ++t)
        for (size_t i = 0; i < content.terms[t].texel.size(); ++i)
            lists.first[content.terms[t].texel[i] + 1] += !is_black(content.terms[t], lists.terms[t], i);
    uint64_t total = 0;
    for (uint32_t& first : lists.first) {
        total += first;
        if (total > 0xffffffffull) throw Error(AJAR_ERROR_ARGUMENT, "The package's terms have too many texels");
        first = static_cast<uint32_t>(total);
    }
}

void fill_entries(const PackageContent& content, TermLists& lists) {
    lists.term.resize(lists.first.back());
    lists.source.resize(lists.first.back());
    std::vector<uint32_t> next(lists.first.begin(), lists.first.end() - 1);
    for (size_t t = 0; t < content.terms.size(); ++t)
        for (size_t i = 0; i < content.terms[t].texel.size(); ++i) {
            if (is_black(content.terms[t], lists.terms[t], i)) continue;
            const uint32_t entry = next[content.terms[t].texel[i]]++;
            lists.term[entry] = static_cast<uint16_t>(t);
            lists.source[entry] = static_cast<uint32_t>(i);
        }
}

} // namespace

void check_content(const PackageContent& content) {
    if (texel_count(content) > 0xffffffffull) throw Error(AJAR_ERROR_ARGUMENT, "The package has too many texels");
    if (content.terms.size() > 65536) throw Error(AJAR_ERROR_ARGUMENT, "The package has too many terms");
    for (const PackagePage& page : content.pages)
        if (std::max(page.width, page.height) > 65536)
            throw Error(AJAR_ERROR_ARGUMENT, "A page with terms is wider or higher than 65536 texels");
    for (const PackageElement& element : content.elements) check_element(element);
    for (size_t i = 0; i < content.terms.size(); ++i) check_term(content, content.terms[i], i);
}

float storage_scale(float largest) {
    int exponent = 0;
    std::frexp(largest, &exponent); // largest = m * 2^exponent, m in [0.5, 1)
    return largest > 0.0f ? std::ldexp(1.0f, std::clamp(exponent - 15, -126, 127)) : 1.0f;
}

std::array<uint32_t, 3> entry_words(const PackageTerm& term, const StoredTerm& stored, size_t index,
                                    bool signed_layout) {
    Vec3 e = irradiance_of(term, index) / stored.scale;
    const uint32_t packed = stored.is_signed ? 0 : pack_r11g11b10f(e);
    if (!signed_layout) return {packed, term.direction[index], 0};
    if (!stored.is_signed) e = unpack_r11g11b10f(packed); // exact in half floats
    return {pack_half(e.x) | (pack_half(e.y) << 16), pack_half(e.z), term.direction[index]};
}

TermLists collect_terms(const PackageContent& content) {
    check_content(content);
    TermLists lists;
    for (const PackageTerm& term : content.terms) lists.terms.push_back(make_stored(term));
    count_entries(content, lists);
    fill_entries(content, lists);
    for (const uint16_t term : lists.term) lists.terms[term].texels++;
    return lists;
}

} // namespace ajar
