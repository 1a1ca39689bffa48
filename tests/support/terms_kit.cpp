// SPDX-License-Identifier: GPL-3.0-or-later
#include "terms_kit.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <stdexcept>

#include "encode/ahd.h"

namespace kit {

using namespace ajar;

uint32_t TermScene::random_direction() {
    const float phi = uniform(0.0f, 2.0f * kPi), z = uniform(kAhdMinHeight, 1.0f), flat = std::sqrt(1.0f - z * z);
    return pack_direction({Vec3(1.0f), uniform(), Vec3(flat * std::cos(phi), flat * std::sin(phi), z)});
}

void TermScene::add_page(uint32_t width, uint32_t height) {
    const size_t texels = size_t{width} * height;
    auto &irradiance = floats_.emplace_back(3 * texels), &plane = floats_.emplace_back(texels, 1.0f);
    auto &packed = words_.emplace_back(texels), &direction = words_.emplace_back(texels);
    for (size_t i = 0; i < texels; ++i) {
        const Vec3 e = Vec3(uniform(), uniform(), uniform()) * std::exp2(uniform(-6.0f, 4.0f)) * float(below(8) != 0);
        std::memcpy(&irradiance[3 * i], &e, sizeof e);
        packed[i] = pack_r11g11b10f(e);
        direction[i] = random_direction();
    }
    content.pages.push_back({width, height, irradiance, plane, plane, plane, {}, packed, direction});
}

uint32_t TermScene::add_element(const std::string& name, const std::string& kind, float weight) {
    content.elements.push_back({name, kind, weight});
    return static_cast<uint32_t>(content.elements.size() - 1);
}

void TermScene::add_term(std::vector<uint32_t> elements, std::vector<uint32_t> texels, bool is_signed, float strength) {
    std::vector<float> irradiance(3 * texels.size());
    std::vector<uint32_t> direction(texels.size());
    for (float& v : irradiance) v = uniform(is_signed ? -strength : 0.01f * strength, strength);
    for (uint32_t& d : direction) d = random_direction();
    add_term(std::move(elements), std::move(texels), std::move(irradiance), std::move(direction), is_signed);
}

void TermScene::add_term(std::vector<uint32_t> elements, std::vector<uint32_t> texels, std::vector<float> irradiance,
                         std::vector<uint32_t> direction, bool is_signed) {
    const auto& t = words_.emplace_back(std::move(texels));
    const auto& e = floats_.emplace_back(std::move(irradiance));
    const auto& d = words_.emplace_back(std::move(direction));
    content.terms.push_back({std::move(elements), is_signed, 0.01f, 0.0f, t, e, d});
}

std::vector<uint32_t> texel_range(uint32_t first, uint32_t count) {
    std::vector<uint32_t> texels(count);
    std::iota(texels.begin(), texels.end(), first);
    return texels;
}

void fill_everything(TermScene& scene) {
    scene.add_page(64, 48);
    scene.add_page(40, 30);
    const uint32_t texels = 64 * 48 + 40 * 30;
    const char* const kinds[] = {"light_set", "light_set", "door", "toggle"};
    for (uint32_t e = 0; e < 20; ++e)
        scene.add_element("element " + std::to_string(e), kinds[e % 4], e % 3 == 0 ? 1.0f : e == 10 ? 0.25f : 0.0f);
    scene.add_term({0}, texel_range(0, 3000)); // large lists of their own
    scene.add_term({2}, texel_range(500, 2500), true);
    scene.add_term({0, 2}, texel_range(1000, 1500), true, 0.2f);
    for (uint32_t t = 0; t < 58; ++t) { // small overlapping patches
        std::vector<uint32_t> patch;
        const uint32_t first = scene.below(texels), count = 20 + scene.below(180), stride = 1 + scene.below(4);
        for (uint32_t i = 0; i < count && first + i * stride < texels; ++i) patch.push_back(first + i * stride);
        const uint32_t a = scene.below(19), b = a + 1 + scene.below(19 - a);
        std::vector<uint32_t> elements = t % 5 == 0 ? std::vector{a, b} : std::vector{a};
        scene.add_term(elements, patch, t % 4 == 0, std::exp2(scene.uniform(-8.0f, 8.0f)));
    }
    for (uint32_t t = 0; t < 9; ++t) // more than 8 at some texels
        scene.add_term({t}, texel_range(3900 - 10 * t, 60 + 10 * t), t == 8);
    for (uint32_t t = 0; t < 30; ++t) // more than 16 at others, some signed, in lists that differ
        scene.add_term({t % 15, 15 + t % 5}, texel_range(3300 - 7 * t, 60 + 9 * t), t % 8 == 7);
    scene.add_term({1}, {});
}

void add_random_lists(TermScene& scene, uint32_t texels, uint32_t terms, uint32_t most) {
    std::vector<uint32_t> order = texel_range(0, terms);
    std::vector<std::vector<uint32_t>> texels_of(terms);
    for (uint32_t texel = 0; texel < texels; ++texel) {
        std::shuffle(order.begin(), order.end(), scene.random());
        const uint32_t count = texel == 0 ? most : scene.below(most + 1);
        for (uint32_t i = 0; i < count; ++i) texels_of[order[i]].push_back(texel);
    }
    for (uint32_t t = 0; t < terms; ++t) {
        const uint32_t set = scene.add_element("set " + std::to_string(t), "light_set");
        scene.add_term({set}, texels_of[t], t >= terms - terms / 8);
    }
}

void fill_hundreds(TermScene& scene) {
    scene.add_page(37, 23);
    add_random_lists(scene, 37 * 23, 340, 300);
}

namespace {

/// Bounds-checked reads of a section.
class Reader {
public:
    Reader(const std::vector<uint8_t>& bytes, terms::SectionPlace place) : bytes_(bytes), place_(place) {
        if (place.offset + place.size > bytes.size()) throw std::runtime_error("section outside the file");
    }
    template <class T>
    T at(uint64_t index) const {
        T value;
        if ((index + 1) * sizeof(T) > place_.size) throw std::runtime_error("read outside a section");
        std::memcpy(&value, bytes_.data() + place_.offset + index * sizeof(T), sizeof(T));
        return value;
    }
    template <class T>
    std::vector<T> all() const {
        std::vector<T> values;
        for (uint64_t i = 0; i < place_.size / sizeof(T); ++i) values.push_back(at<T>(i));
        return values;
    }

private:
    const std::vector<uint8_t>& bytes_;
    terms::SectionPlace place_;
};

/// Entries of each receiver, bit by bit as the format says; not for class B.
std::vector<uint32_t> counts_of(const Reader& data, const terms::Dispatch& d) {
    if (d.kind <= 1) return std::vector<uint32_t>(d.receivers, d.k);
    const uint32_t bits = d.kind == 2 ? 2 : 3, least = d.kind == 2 ? 5 : 9;
    std::vector<uint32_t> counts;
    for (uint64_t r = 0; r < d.receivers; ++r) {
        uint32_t field = 0;
        for (uint64_t b = 0; b < bits; ++b)
            field |= ((data.at<uint8_t>(4ull * d.counts + (r * bits + b) / 8) >> ((r * bits + b) % 8)) & 1u) << b;
        counts.push_back(least + field);
    }
    return counts;
}

struct Decoder {
    const std::vector<uint8_t>& bytes;
    DecodedTerms out;
    terms::Header header{};

    Reader section(terms::Section s) const { return {bytes, header.sections[s]}; }
    void tables();
    DecodedEntry entry(const terms::Dispatch& d, uint32_t index, uint32_t place) const;
    void add_receivers(uint32_t index);
    void add_lists(uint32_t index);
    void add_blocks(uint32_t index);
};

void Decoder::tables() {
    if (bytes.size() < sizeof header) throw std::runtime_error("no header");
    std::memcpy(&header, bytes.data(), sizeof header);
    out.elements = section(terms::kElements).all<terms::Element>();
    out.pages = section(terms::kPages).all<terms::Page>();
    out.terms = section(terms::kTerms).all<terms::Term>();
    out.dispatches = section(terms::kDispatches).all<terms::Dispatch>();
    const std::vector<char> strings = section(terms::kStrings).all<char>();
    for (const terms::Element& e : out.elements)
        out.names.emplace_back(strings.begin() + e.name_offset, strings.begin() + e.name_offset + e.name_size);
    const Reader palette = section(terms::kPalette);
    for (const terms::Dispatch& d : out.dispatches) {
        auto& terms = out.palettes.emplace_back();
        for (uint32_t i = 0; i < d.palette_count; ++i) terms.push_back(palette.at<uint16_t>(d.palette + i));
    }
}

DecodedEntry Decoder::entry(const terms::Dispatch& d, uint32_t index, uint32_t place) const {
    const Reader data = section(terms::kData);
    const uint32_t term = out.palettes[&d - out.dispatches.data()].at(place);
    const auto word = [&](uint32_t plane) {
        return data.at<uint32_t>(uint64_t{d.payload} + uint64_t{plane} * d.entries + index);
    };
    const Vec3 e = d.words == 2 ? unpack_r11g11b10f(word(0))
                                : Vec3(unpack_half(word(0) & 0xffff), unpack_half(word(0) >> 16), unpack_half(word(1)));
    return {term, e * out.terms.at(term).scale, word(d.words - 1)};
}

void Decoder::add_receivers(uint32_t index) {
    const terms::Dispatch& d = out.dispatches[index];
    const Reader data = section(terms::kData);
    uint32_t first = 0;
    for (uint32_t p = 0; p < d.page; ++p) first += out.pages.at(p).width * out.pages[p].height;
    auto& order = out.order.emplace_back();
    for (uint32_t r = 0; r < d.receivers; ++r) {
        const uint32_t address = data.at<uint32_t>(d.address + r), x = address & 0xffff, y = address >> 16;
        const uint32_t texel = first + (out.pages[d.page].height - 1 - y) * out.pages[d.page].width + x;
        DecodedReceiver receiver{index, data.at<uint32_t>(d.base + r), data.at<uint32_t>(d.base + d.receivers + r), {}};
        order.push_back(texel);
        if (!out.receivers.emplace(texel, std::move(receiver)).second)
            throw std::runtime_error("a texel is in two dispatches");
    }
}

void Decoder::add_lists(uint32_t index) {
    const terms::Dispatch& d = out.dispatches[index];
    const Reader data = section(terms::kData);
    const std::vector<uint32_t> counts = counts_of(data, d);
    uint32_t running = 0;
    for (uint32_t r = 0; r < d.receivers; ++r) {
        auto& entries = out.receivers.at(out.order[index][r]).entries;
        for (uint32_t s = 0; s < counts[r]; ++s) {
            const uint32_t at = d.kind <= 1 ? s * d.receivers + r : running + s;
            entries.push_back(entry(d, at, d.kind == 0 ? s : data.at<uint8_t>(4ull * d.index + at)));
        }
        running += counts[r];
    }
    if (d.kind > 1 && running != d.entries) throw std::runtime_error("counts and entries differ");
}

void Decoder::add_blocks(uint32_t index) {
    const terms::Dispatch& d = out.dispatches[index];
    const Reader data = section(terms::kData);
    uint32_t next = 0, slot = 0;
    for (uint32_t block = 0; 16 * block < d.receivers; ++block) {
        if (data.at<uint32_t>(d.starts + 2 * block) != slot || data.at<uint32_t>(d.starts + 2 * block + 1) != next)
            throw std::runtime_error("a block starts elsewhere");
        for (; slot < data.at<uint32_t>(d.starts + 2 * block + 2); ++slot)
            for (uint32_t i = 0; i < 16; ++i)
                if ((data.at<uint32_t>(d.index + slot) >> (16 + i)) % 2 == 1)
                    out.receivers.at(out.order[index].at(16 * block + i))
                        .entries.push_back(entry(d, next++, data.at<uint32_t>(d.index + slot) % 65536));
    }
    if (next != d.entries) throw std::runtime_error("slots and entries differ");
}

} // namespace

double variable_of(bool is_light_set, double start, double weight) {
    if (is_light_set) return weight;
    return start < 1.0 ? weight - start : start - weight;
}

DecodedTerms decode_terms(const std::vector<uint8_t>& bytes) {
    Decoder decoder{bytes, {}, {}};
    decoder.tables();
    for (uint32_t i = 0; i < decoder.out.dispatches.size(); ++i) {
        decoder.add_receivers(i);
        if (decoder.out.dispatches[i].kind == 4)
            decoder.add_blocks(i);
        else
            decoder.add_lists(i);
    }
    return std::move(decoder.out);
}

} // namespace kit
