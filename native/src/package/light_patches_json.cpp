// SPDX-License-Identifier: GPL-3.0-or-later
#include <nlohmann/json.hpp>

#include "package/light_patches.h"

namespace ajar {
namespace {

using Json = nlohmann::ordered_json;

Json name_or_null(const PackageContent& content, uint32_t element) {
    return element == LightPatches::kNone ? Json(nullptr) : Json(content.elements[element].name);
}

/// Rows count from the top in files.
Json patch_json(const PackageContent& content, const LightPatches& all, const LightPatch& p) {
    const uint32_t page_height = content.pages[p.page].height, atlas_height = all.atlases[p.place.atlas].height;
    return {{"page", p.page},
            {"page_x", p.x},
            {"page_y", page_height - p.y - p.size.height},
            {"width", p.size.width},
            {"height", p.size.height},
            {"atlas", p.place.atlas},
            {"channel", p.place.channel},
            {"atlas_x", p.place.x},
            {"atlas_y", atlas_height - p.place.y - p.size.height},
            {"plane", p.plane}};
}

Json map_json(const PackageContent& content, const LightPatches& all, const LightMap& map) {
    Json json = {{"light", name_or_null(content, map.light)},
                 {"object", name_or_null(content, map.object)},
                 {"planes", map.planes},
                 {"scale", map.scale},
                 {"color", map.color},
                 {"patches", Json::array()}};
    for (const LightPatch& p : map.patches) json["patches"].push_back(patch_json(content, all, p));
    return json;
}

/// Elements by kind; an object is in its place where a toggle is present or a door closed.
void add_elements(Json& json, const PackageContent& content) {
    json["lights"] = json["objects"] = Json::array();
    for (const PackageElement& e : content.elements) {
        if (e.kind == "light_set")
            json["lights"].push_back({{"name", e.name}, {"intensity", e.weight}});
        else
            json["objects"].push_back(
                {{"name", e.name}, {"kind", e.kind}, {"presence", e.kind == "door" ? 1.0f - e.weight : e.weight}});
    }
}

} // namespace

std::string light_patches_json(const PackageContent& content, const LightPatches& patches) {
    Json json = {{"version", 1}, {"minVersion", 1}};
    json["atlases"] = json["pages"] = Json::array();
    for (const PackagePage& p : content.pages) json["pages"].push_back({{"width", p.width}, {"height", p.height}});
    for (size_t a = 0; a < patches.atlases.size(); ++a)
        json["atlases"].push_back(
            {{"file", atlas_file(a)}, {"width", patches.atlases[a].width}, {"height", patches.atlases[a].height}});
    add_elements(json, content);
    json["maps"] = Json::array();
    for (const LightMap& map : patches.maps) json["maps"].push_back(map_json(content, patches, map));
    json["dropped_terms"] = patches.dropped_terms;
    return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n"; // names as in the manifest
}

} // namespace ajar
