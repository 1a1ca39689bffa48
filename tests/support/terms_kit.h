// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Packages with terms made of numbers, and a reader of terms.bin written from the format's
// description alone, value by value, to hold the engine and the run-time against.

#include <array>
#include <deque>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "base/math.h"
#include "package/manifest.h"
#include "runtime/terms_format.h"

namespace kit {

/// Content for write_package that owns its arrays. Texels count over all pages, bottom row first.
class TermScene {
public:
    explicit TermScene(uint32_t seed = 1) : random_(seed) {}

    /// A page of random light.
    void add_page(uint32_t width, uint32_t height);
    uint32_t add_element(const std::string& name, const std::string& kind, float weight = 1.0f);
    /// A term with random light of about the given strength at texels, which ascend.
    void add_term(std::vector<uint32_t> elements, std::vector<uint32_t> texels, bool is_signed = false,
                  float strength = 1.0f);
    /// A term with given light, 3 floats and a packed direction per texel.
    void add_term(std::vector<uint32_t> elements, std::vector<uint32_t> texels, std::vector<float> irradiance,
                  std::vector<uint32_t> direction, bool is_signed);

    ajar::PackageContent content{"terms", "", {}, {}, {}, {}, {}};
    float uniform(float low = 0.0f, float high = 1.0f) { return std::uniform_real_distribution(low, high)(random_); }
    uint32_t below(uint32_t count) { return std::uniform_int_distribution<uint32_t>(0, count - 1)(random_); }
    std::mt19937& random() { return random_; }
    uint32_t random_direction();

private:
    std::mt19937 random_;
    std::deque<std::vector<float>> floats_;
    std::deque<std::vector<uint32_t>> words_;
};

/// 0, 1, ... count - 1, shifted by first.
std::vector<uint32_t> texel_range(uint32_t first, uint32_t count);

/// Two pages, 20 elements of all kinds and some 60 terms that overlap in every way: all classes of
/// dispatches, unsigned and signed, products, a term of nothing.
void fill_everything(TermScene& scene);

/// Adds light sets, each with a term, and the last eighth of the terms signed. Each of the texels 0, 1, ... gets up to
/// `most` terms of them, no two the same list; the first texel gets that many.
void add_random_lists(TermScene& scene, uint32_t texels, uint32_t terms, uint32_t most);

/// A page of 37 x 23 texels with up to 300 terms each.
void fill_hundreds(TermScene& scene);

struct DecodedEntry {
    uint32_t term;
    ajar::Vec3 irradiance; ///< W/m^2
    uint32_t direction;
};

struct DecodedReceiver {
    uint32_t dispatch;
    uint32_t irradiance, direction; ///< base
    std::vector<DecodedEntry> entries;
};

/// terms.bin as plain lists.
struct DecodedTerms {
    std::vector<std::string> names;
    std::vector<ajar::terms::Element> elements;
    std::vector<ajar::terms::Page> pages;
    std::vector<ajar::terms::Term> terms;
    std::vector<ajar::terms::Dispatch> dispatches;
    std::vector<std::vector<uint32_t>> palettes;
    std::vector<std::vector<uint32_t>> order;      ///< texels of each dispatch as they are stored
    std::map<uint32_t, DecodedReceiver> receivers; ///< by texel over all pages, bottom row first
};

/// What a term's light is multiplied by for one of its elements, from the format's description: of a light set its
/// weight, of a door or toggle its distance from the start.
double variable_of(bool is_light_set, double start, double weight);

/// Throws std::runtime_error where two receivers have one address or the file is not whole.
DecodedTerms decode_terms(const std::vector<uint8_t>& bytes);

} // namespace kit
