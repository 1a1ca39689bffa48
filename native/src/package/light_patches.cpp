// SPDX-License-Identifier: GPL-3.0-or-later
#include "package/light_patches.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/math.h"
#include "encode/ahd.h"
#include "package/dispatch_plan.h"
#include "package/weight_polynomial.h"

namespace ajar {
namespace {

constexpr uint32_t kBlock = 64; ///< texels along an edge of the blocks that patches are cut from

/// Light at a texel, counted over all pages.
struct TexelLight {
    uint32_t texel;
    Vec3 e;
};
using MapLight = std::vector<TexelLight>; ///< ascending by texel, each once

/// Sorts, and adds up what is at the same texel, in the order in which it came.
void merge(MapLight& light) {
    std::stable_sort(light.begin(), light.end(), [](const auto& a, const auto& b) { return a.texel < b.texel; });
    size_t kept = 0;
    for (size_t i = 0; i < light.size(); ++i) {
        if (kept > 0 && light[kept - 1].texel == light[i].texel)
            light[kept - 1].e += light[i].e;
        else
            light[kept++] = light[i];
    }
    light.resize(kept);
}

struct MapKey {
    uint32_t light, object;
    auto operator<=>(const MapKey&) const = default;
};

/// The elements of a term by kind.
struct Parts {
    uint32_t light = LightPatches::kNone;
    std::vector<uint32_t> doors, toggles;
    Parts(const PackageContent& content, const std::vector<uint32_t>& elements) {
        for (const uint32_t e : elements) {
            if (content.elements[e].kind == "light_set")
                light = e;
            else
                (content.elements[e].kind == "door" ? doors : toggles).push_back(e);
        }
    }
};

class MapMaker {
public:
    explicit MapMaker(const PackageContent& content) : content_(content) {
        std::vector<std::vector<uint32_t>> products;
        for (const PackageTerm& term : content.terms) products.push_back(term.elements);
        for (const WeightTerm& term : in_weights(content.elements, products)) add_term(term);
        for (auto& [key, light] : maps) merge(light);
    }
    std::map<MapKey, MapLight> maps;
    uint64_t dropped_terms = 0;

private:
    void add_pages(MapLight& map, float factor) {
        uint32_t texel = 0;
        for (const PackagePage& page : content_.pages)
            for (size_t i = 0; i < page.irradiance.size(); i += 3, ++texel) {
                const Vec3 e(page.irradiance[i], page.irradiance[i + 1], page.irradiance[i + 2]);
                if (e != Vec3(0.0f)) map.push_back({texel, factor * e});
            }
    }
    /// With every door open and every toggle away, terms of doors alone are light that is there. A
    /// door that closes takes the terms that it is part of; a toggle that comes takes, negated, its
    /// own. Terms of two toggles have no place.
    void add_term(const WeightTerm& term) {
        const Parts parts(content_, term.elements);
        if (parts.toggles.empty()) {
            add(term, {parts.light, LightPatches::kNone}, 1.0f);
            for (const uint32_t door : parts.doors) add(term, {parts.light, door}, 1.0f);
        } else if (parts.toggles.size() == 1) {
            add(term, {parts.light, parts.toggles[0]}, -1.0f);
        }
        dropped_terms += parts.toggles.size() + parts.doors.size() > 1;
    }
    void add(const WeightTerm& light, MapKey key, float sign) {
        MapLight& map = maps[key];
        for (const WeightTerm::Part& part : light.parts) {
            if (part.term == WeightTerm::kBase) {
                add_pages(map, sign * part.factor);
                continue;
            }
            const PackageTerm& term = content_.terms[part.term];
            for (size_t i = 0; i < term.texel.size(); ++i)
                map.push_back({term.texel[i], sign * part.factor *
                                                  Vec3(term.irradiance[3 * i], term.irradiance[3 * i + 1],
                                                       term.irradiance[3 * i + 2])});
        }
    }
    const PackageContent& content_;
};

/// Mean colour of a light of luminance 1, from all that it adds.
std::array<float, 3> color_of(const MapLight& light) {
    double sum[3] = {};
    for (const auto& [texel, e] : light)
        for (int c = 0; c < 3; ++c) sum[c] += e[c];
    const double y = 0.2126 * sum[0] + 0.7152 * sum[1] + 0.0722 * sum[2];
    if (!(y > 0.0)) return {1.0f, 1.0f, 1.0f};
    return {float(sum[0] / y), float(sum[1] / y), float(sum[2] / y)};
}

float plane_value(const Vec3& e, uint32_t planes, uint32_t plane) {
    return planes == 1 ? luminance(e) : e[static_cast<int>(plane)];
}

float scale_of(const MapLight& light) {
    float largest = 0.0f;
    for (const auto& [texel, e] : light) largest = std::max({largest, std::fabs(e.x), std::fabs(e.y), std::fabs(e.z)});
    return storage_scale(largest);
}

struct Box {
    uint32_t x0 = 0xffffffffu, y0 = 0xffffffffu, x1 = 0, y1 = 0; ///< x1, y1 inside
    void add(uint32_t x, uint32_t y) {
        x0 = std::min(x0, x), y0 = std::min(y0, y);
        x1 = std::max(x1, x), y1 = std::max(y1, y);
    }
};

/// A patch and the light to write to it.
struct Job {
    size_t map, patch;
    const MapLight* light;
};

class Cutter {
public:
    Cutter(const PackageContent& content, LightPatches& out) : content_(content), out_(out) {}

    /// Adds the map with its patches; a black one only if it is the light that no set holds.
    void cut(LightMap map, const MapLight& light) {
        for (uint32_t plane = 0; plane < map.planes; ++plane) cut_plane(map, light, plane);
        const bool is_base = map.light == LightPatches::kNone && map.object == LightPatches::kNone;
        if (map.patches.empty() && !is_base) return;
        for (size_t p = 0; p < map.patches.size(); ++p) jobs.push_back({out_.maps.size(), p, &light});
        out_.maps.push_back(std::move(map));
    }
    std::vector<Job> jobs;

private:
    void cut_plane(LightMap& map, const MapLight& light, uint32_t plane) {
        std::map<std::array<uint32_t, 3>, Box> boxes; // of page, block row, block column
        for (const auto& [texel, e] : light) {
            if ((pack_half(plane_value(e, map.planes, plane) / map.scale) & 0x7fffu) == 0) continue;
            const TexelPlace p = place_of(content_.pages, texel);
            boxes[{p.page, p.y / kBlock, p.x / kBlock}].add(p.x, p.y);
        }
        for (const auto& [at, b] : boxes)
            map.patches.push_back({{}, {b.x1 - b.x0 + 1, b.y1 - b.y0 + 1}, at[0], b.x0, b.y0, plane});
    }
    const PackageContent& content_;
    LightPatches& out_;
};

uint32_t first_texel(const PackageContent& content, uint32_t page) {
    uint32_t first = 0;
    for (uint32_t p = 0; p < page; ++p) first += content.pages[p].width * content.pages[p].height;
    return first;
}

/// Copies the patch's part of its map into its channel of the atlas.
void write_patch(const PackageContent& content, const LightMap& map, const LightPatch& patch, const MapLight& light,
                 LightPatches& out) {
    const uint32_t stride = out.atlases[patch.place.atlas].width;
    std::vector<uint32_t>& words = out.texels[patch.place.atlas];
    const uint32_t shift = 16 * (patch.place.channel & 1), half = patch.place.channel / 2;
    const uint32_t first = first_texel(content, patch.page);
    for (uint32_t y = 0; y < patch.size.height; ++y) {
        const uint32_t row = first + (patch.y + y) * content.pages[patch.page].width + patch.x;
        const auto begin =
            std::partition_point(light.begin(), light.end(), [&](const TexelLight& l) { return l.texel < row; });
        for (auto it = begin; it != light.end() && it->texel < row + patch.size.width; ++it) {
            const size_t at = size_t{patch.place.y + y} * stride + patch.place.x + (it->texel - row);
            words[2 * at + half] |= pack_half(plane_value(it->e, map.planes, patch.plane) / map.scale) << shift;
        }
    }
}

void pack(const PackageContent& content, const std::vector<Job>& jobs, LightPatches& out) {
    std::vector<PatchSize> sizes;
    for (const Job& job : jobs) sizes.push_back(out.maps[job.map].patches[job.patch].size);
    AtlasPlan plan = plan_atlases(sizes);
    out.atlases = std::move(plan.atlases);
    for (const PatchSize& size : out.atlases) out.texels.emplace_back(size_t{2} * size.width * size.height, 0u);
    for (size_t j = 0; j < jobs.size(); ++j) {
        LightMap& map = out.maps[jobs[j].map];
        map.patches[jobs[j].patch].place = plan.places[j];
        write_patch(content, map, map.patches[jobs[j].patch], *jobs[j].light, out);
    }
}

} // namespace

std::string atlas_file(size_t atlas) { return "patches_" + std::to_string(atlas) + ".dds"; }

LightPatches make_light_patches(const PackageContent& content, LightPatchPlanes planes) {
    const MapMaker maker(content);
    LightPatches out;
    out.dropped_terms = maker.dropped_terms;
    Cutter cutter(content, out);
    for (const auto& [key, light] : maker.maps) {
        LightMap map{key.light, key.object, scale_of(light), {1.0f, 1.0f, 1.0f}, 3, {}};
        const auto whole = maker.maps.find({key.light, LightPatches::kNone});
        if (key.light != LightPatches::kNone && planes == LightPatchPlanes::one) {
            map.planes = 1;
            if (whole != maker.maps.end()) map.color = color_of(whole->second);
        }
        cutter.cut(std::move(map), light);
    }
    pack(content, cutter.jobs, out);
    return out;
}

} // namespace ajar
