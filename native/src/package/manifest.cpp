// SPDX-License-Identifier: GPL-3.0-or-later
#include "package/manifest.h"

#include <cmath>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "runtime/terms_format.h"

namespace ajar {
namespace {

using Json = nlohmann::ordered_json;

#ifdef AJAR_VERSION_TEXT
constexpr const char* kGenerator = "Ajar " AJAR_VERSION_TEXT;
#else
constexpr const char* kGenerator = "Ajar";
#endif

/// 64 bit hash of a sequence of values: xor, multiply, fold per 8 bytes (splitmix64's constants).
class Hash64 {
public:
    void add(uint64_t value) {
        state_ = (state_ ^ value) * 0xbf58476d1ce4e5b9ull;
        state_ ^= state_ >> 29;
    }
    void add_bytes(const void* data, size_t size) {
        add(size);
        const auto* bytes = static_cast<const uint8_t*>(data);
        for (; size >= 8; size -= 8, bytes += 8) {
            uint64_t word;
            std::memcpy(&word, bytes, 8);
            add(word);
        }
        uint64_t rest = 0;
        if (size > 0) std::memcpy(&rest, bytes, size);
        add(rest);
    }
    template <typename T>
    void add_array(std::span<const T> values) {
        add_bytes(values.data(), values.size_bytes());
    }
    uint64_t value() const {
        const uint64_t folded = (state_ ^ (state_ >> 30)) * 0x94d049bb133111ebull;
        return folded ^ (folded >> 31);
    }

private:
    uint64_t state_ = 0x9e3779b97f4a7c15ull;
};

Json page_json(const PackagePage& page, size_t index, float scale, bool overlap_pictures) {
    const PageFiles files(index);
    Json json;
    json["width"] = page.width;
    json["height"] = page.height;
    json["irradiance"] = files.irradiance;
    json["quality"] = files.quality;
    json["sh"] = page.sh.empty() ? Json(nullptr) : Json(files.sh);
    json["packed"] = {{"irradiance", files.packed_irradiance},
                      {"direction", files.packed_direction},
                      {"direction_png", files.direction_png},
                      {"layout", "ahd-r11g11b10f-rgba8"}};
    if (scale != 1.0f) json["packed"]["scale"] = scale;
    if (overlap_pictures) {
        json["overlap"] = files.overlap;
        json["bytes"] = files.bytes;
    }
    return json;
}

Json instance_json(const PackageInstance& instance) {
    Json json;
    json["name"] = instance.name;
    json["page"] = instance.page;
    json["uv_layer"] = instance.uv_layer;
    json["uv_scale"] = {instance.uv_scale[0], instance.uv_scale[1]};
    json["uv_offset"] = {instance.uv_offset[0], instance.uv_offset[1]};
    if (instance.back) json["side"] = "back";
    return json;
}

Json light_json(const PackageLight& light) {
    Json json = {{"name", light.name}, {"role", light.role}};
    if (!light.light_set.empty()) json["light_set"] = light.light_set;
    return json;
}

Json element_json(const PackageContent& content, const ElementSummary& summary, size_t index) {
    const PackageElement& element = content.elements[index];
    Json json;
    json["name"] = element.name;
    json["kind"] = element.kind;
    json["weight"] = element.weight;
    json["lights"] = Json::array();
    for (const PackageLight& light : content.lights)
        if (element.kind == "light_set" && light.light_set == element.name) json["lights"].push_back(light.name);
    json["texels"] = summary.texels;
    json["bytes"] = summary.bytes;
    return json;
}

/// NaN and infinity have no JSON; null says that the number is not known.
Json number_or_null(float value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json term_json(const PackageContent& content, const TermSummary& summary, size_t index) {
    const PackageTerm& term = content.terms[index];
    Json json;
    std::string name;
    json["elements"] = Json::array();
    for (const uint32_t e : term.elements) {
        json["elements"].push_back(content.elements[e].name);
        name += (name.empty() ? "" : " * ") + content.elements[e].name;
    }
    json["name"] = name;
    json["layout"] = summary.is_signed ? "signed-rgb16f-rgba8" : "unsigned-r11g11b10f-rgba8";
    json["scale"] = summary.scale;
    json["texels"] = summary.texels;
    json["bytes"] = summary.bytes;
    json["relative_error"] = number_or_null(term.relative_error);
    json["discarded"] = number_or_null(term.discarded);
    return json;
}

Json class_json(const ClassSummary& summary, const char* name) {
    return {{"class", name},
            {"dispatches", summary.dispatches},
            {"receivers", summary.receivers},
            {"entries", summary.entries},
            {"bytes", summary.bytes}};
}

Json terms_file_json(const TermsSummary& summary, double discarded) {
    return {
        {"file", terms::kFileName},
        {"version", terms::kVersion},
        {"bytes", summary.bytes},
        {"wasted_updates", summary.wasted_updates},
        {"discarded", discarded},
        {"overlap", overlap_json(summary.texels)},
        {"bytes_per_texel", {{"mean", summary.texels.mean(summary.texels.bytes)}, {"max", summary.texels.most_bytes}}}};
}

/// Elements, terms and dispatches; without elements the base alone.
void add_term_lists(Json& json, const PackageContent& content, const TermsSummary* summary) {
    for (const char* list : {"elements", "terms", "dispatches"}) json[list] = Json::array();
    json["terms"].push_back({{"elements", Json::array()}, {"name", "base"}});
    if (summary == nullptr) return;
    for (size_t i = 0; i < content.elements.size(); ++i)
        json["elements"].push_back(element_json(content, summary->elements[i], i));
    for (size_t i = 0; i < content.terms.size(); ++i) json["terms"].push_back(term_json(content, summary->terms[i], i));
    const char* const names[] = {"U", "Q", "V8", "V16", "B"};
    for (size_t i = 0; i < std::size(names); ++i)
        json["dispatches"].push_back(class_json(summary->classes[i], names[i]));
    json["terms_file"] = terms_file_json(*summary, content.discarded);
}

void hash_terms(Hash64& hash, const PackageContent& content) {
    for (const PackageElement& element : content.elements) {
        hash.add_bytes(element.name.data(), element.name.size());
        hash.add_bytes(element.kind.data(), element.kind.size());
        hash.add_bytes(&element.weight, sizeof element.weight);
    }
    for (const PackageTerm& term : content.terms) {
        hash.add_array(std::span<const uint32_t>(term.elements));
        hash.add(term.is_signed);
        hash.add_array(term.texel);
        hash.add_array(term.irradiance);
        hash.add_array(term.direction);
    }
}

Json parse_extras(const std::string& text) {
    if (text.empty()) return Json::object();
    Json extras = Json::parse(text, nullptr, false);
    if (!extras.is_object()) throw Error(AJAR_ERROR_ARGUMENT, "The package's extras are not a JSON object");
    return extras;
}

} // namespace

uint32_t element_kind(const PackageElement& element) {
    if (element.kind == "light_set") return static_cast<uint32_t>(terms::Kind::light_set);
    if (element.kind == "door") return static_cast<uint32_t>(terms::Kind::door);
    if (element.kind == "toggle") return static_cast<uint32_t>(terms::Kind::toggle);
    throw Error(AJAR_ERROR_ARGUMENT, "An element of the package is of unknown kind \"" + element.kind + "\"",
                element.name);
}

float PackageElement::variable(float w) const {
    return static_cast<float>(terms::element_variable({0, 0, element_kind(*this), weight}, w));
}

PageFiles::PageFiles(size_t page) {
    const std::string stem = "page_" + std::to_string(page);
    irradiance = stem + ".irradiance.exr";
    quality = stem + ".quality.exr";
    sh = stem + ".sh.exr";
    packed_irradiance = stem + ".irradiance.dds";
    packed_direction = stem + ".direction.dds";
    direction_png = stem + ".direction.png";
    overlap = stem + ".overlap.png";
    bytes = stem + ".bytes.png";
}

std::string content_hash(const PackageContent& content) {
    Hash64 hash;
    for (const PackagePage& page : content.pages) {
        hash.add(page.width);
        hash.add(page.height);
        for (const auto& layer : {page.irradiance, page.stderr_, page.samples, page.validity, page.sh})
            hash.add_array(layer);
        hash.add_array(page.packed_irradiance);
        hash.add_array(page.packed_direction);
    }
    for (const PackageInstance& instance : content.instances) {
        hash.add_bytes(instance.name.data(), instance.name.size());
        hash.add(instance.page);
        hash.add_bytes(instance.uv_scale, sizeof instance.uv_scale);
        hash.add_bytes(instance.uv_offset, sizeof instance.uv_offset);
        if (instance.back) hash.add(uint32_t{AJAR_SIDE_BACK});
    }
    hash_terms(hash, content);
    char text[32];
    std::snprintf(text, sizeof text, "ajar64:%016llx", static_cast<unsigned long long>(hash.value()));
    return text;
}

std::string manifest_json(const PackageContent& content, const TermsSummary* terms) {
    Json json;
    json["version"] = 1;
    json["minVersion"] = 1;
    json["generator"] = kGenerator;
    json["name"] = content.name;
    json["units"] = {{"length", "m"}, {"irradiance", "W/m^2"}, {"color", "scene-linear Rec.709"}};
    json["pages"] = Json::array();
    for (size_t i = 0; i < content.pages.size(); ++i)
        json["pages"].push_back(
            page_json(content.pages[i], i, content.scale, terms != nullptr && content.overlap_pictures));
    json["instances"] = Json::array();
    for (const PackageInstance& instance : content.instances) json["instances"].push_back(instance_json(instance));
    add_term_lists(json, content, terms);
    json["lights"] = Json::array();
    for (const PackageLight& light : content.lights) json["lights"].push_back(light_json(light));
    if (content.light_patches != LightPatchPlanes::none) json["light_patches"] = kLightPatchesFile;
    if (!content.self_check.empty()) json["self_check"] = Json::parse(content.self_check);
    json["content_hash"] = content_hash(content);
    json["extras"] = parse_extras(content.extras);
    // Names come from the scene as they are; bytes that are not UTF-8 are replaced, not fatal.
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

bool is_ajar_manifest(std::span<const uint8_t> text) {
    const Json json = Json::parse(text.begin(), text.end(), nullptr, false);
    if (!json.is_object() || !json.contains("generator") || !json["generator"].is_string()) return false;
    return json["generator"].get<std::string>().rfind("Ajar", 0) == 0 && json.contains("pages");
}

} // namespace ajar
