// SPDX-License-Identifier: GPL-3.0-or-later
// The layout of semi-dynamic light maps: what its patches add up to is what the terms say, object by object.
#include "package/light_patches.h"

#include <gtest/gtest.h>

#include "encode/ahd.h"
#include "terms_kit.h"

namespace ajar {
namespace {

constexpr uint32_t kNone = LightPatches::kNone;

/// Two pages, sets 0 and 1, door 2, toggles 3 and 4; terms of each, of pairs and of both toggles.
kit::TermScene make_scene() {
    kit::TermScene s(7);
    s.add_page(150, 90);
    s.add_page(40, 70);
    for (const auto& [name, kind] : std::initializer_list<std::pair<const char*, const char*>>{
             {"warm", "light_set"}, {"cold", "light_set"}, {"door", "door"}, {"A", "toggle"}, {"B", "toggle"}})
        s.add_element(name, kind);
    s.add_term({0}, kit::texel_range(100, 9000));
    s.add_term({1}, kit::texel_range(13000, 2000));
    s.add_term({2}, kit::texel_range(0, 700));
    s.add_term({0, 2}, kit::texel_range(4000, 400));
    s.add_term({3}, kit::texel_range(50, 60), true);
    s.add_term({0, 3}, kit::texel_range(8000, 300), true);
    s.add_term({0, 4}, kit::texel_range(8100, 300), true);
    s.add_term({0, 3, 4}, kit::texel_range(8100, 200), true);
    return s;
}

/// A map of three planes as its patches hold it, over all pages' texels.
std::vector<Vec3> read_map(const PackageContent& content, const LightPatches& patches, uint32_t light,
                           uint32_t object) {
    size_t texels = 0;
    std::vector<size_t> first;
    for (const PackagePage& p : content.pages) first.push_back(texels), texels += size_t{p.width} * p.height;
    std::vector<Vec3> out(texels, Vec3(0.0f));
    for (const LightMap& map : patches.maps) {
        if (map.light != light || map.object != object) continue;
        for (const LightPatch& p : map.patches)
            for (uint32_t y = 0; y < p.size.height; ++y)
                for (uint32_t x = 0; x < p.size.width; ++x) {
                    const size_t at = size_t{p.place.y + y} * patches.atlases[p.place.atlas].width + p.place.x + x;
                    const uint32_t word = patches.texels[p.place.atlas][2 * at + p.place.channel / 2];
                    const float v = unpack_half((word >> (16 * (p.place.channel & 1))) & 0xffffu) * map.scale;
                    Vec3& e = out[first[p.page] + size_t{p.y + y} * content.pages[p.page].width + p.x + x];
                    if (map.planes == 3)
                        e[int(p.plane)] += v;
                    else
                        e += v * Vec3(map.color[0], map.color[1], map.color[2]);
                }
    }
    return out;
}

/// Light of one set (or of none) straight from the terms in a state of the door and the toggles.
std::vector<Vec3> from_terms(const PackageContent& content, uint32_t light, const std::array<float, 5>& weight) {
    std::vector<Vec3> out;
    for (const PackagePage& p : content.pages)
        for (size_t i = 0; i < p.irradiance.size(); i += 3)
            out.push_back(light != kNone ? Vec3(0.0f)
                                         : Vec3(p.irradiance[i], p.irradiance[i + 1], p.irradiance[i + 2]));
    for (const PackageTerm& t : content.terms) {
        const uint32_t set = t.elements[0] < 2 ? t.elements[0] : kNone;
        float w = set == light ? 1.0f : 0.0f;
        for (const uint32_t e : t.elements)
            w *= e < 2 ? 1.0f : static_cast<float>(kit::variable_of(false, content.elements[e].weight, weight[e]));
        for (size_t i = 0; i < t.texel.size(); ++i)
            out[t.texel[i]] += w * Vec3(t.irradiance[3 * i], t.irradiance[3 * i + 1], t.irradiance[3 * i + 2]);
    }
    return out;
}

void expect_equal(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    ASSERT_EQ(a.size(), b.size());
    float worst = 0.0f, largest = 0.0f;
    for (size_t i = 0; i < a.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            worst = std::max(worst, std::fabs(a[i][c] - b[i][c]));
            largest = std::max(largest, std::fabs(b[i][c]));
        }
    EXPECT_GT(largest, 0.0f);
    EXPECT_LE(worst, 1e-3f * largest); // half floats, twice
}

TEST(LightPatches, MapsAreLightWithObjectsAwayAndWhatEachTakes) {
    const kit::TermScene scene = make_scene();
    const LightPatches patches = make_light_patches(scene.content, LightPatchPlanes::three);
    const std::array<float, 5> away{1, 1, 1, 0, 0};
    for (const uint32_t light : {kNone, 0u, 1u})
        expect_equal(read_map(scene.content, patches, light, kNone), from_terms(scene.content, light, away));
    for (const auto& [light, object] : {std::pair{kNone, 2u}, {kNone, 3u}, {0u, 2u}, {0u, 3u}, {0u, 4u}}) {
        std::array<float, 5> there = away;
        there[object] = object == 2 ? 0.0f : 1.0f;
        std::vector<Vec3> sum = read_map(scene.content, patches, light, kNone);
        const std::vector<Vec3> taken = read_map(scene.content, patches, light, object);
        for (size_t i = 0; i < sum.size(); ++i) sum[i] -= taken[i];
        expect_equal(sum, from_terms(scene.content, light, there));
    }
    EXPECT_EQ(patches.dropped_terms, 1u);
}

TEST(LightPatches, OnePlaneKeepsLuminance) {
    const kit::TermScene scene = make_scene();
    const LightPatches patches = make_light_patches(scene.content, LightPatchPlanes::one);
    std::vector<Vec3> got = read_map(scene.content, patches, 0, kNone);
    std::vector<Vec3> wanted = from_terms(scene.content, 0, {1, 1, 1, 0, 0});
    for (auto* map : {&got, &wanted})
        for (Vec3& e : *map) e = Vec3(luminance(e));
    expect_equal(got, wanted);
}

TEST(LightPatches, BlackPagesKeepTheMapOfNoSet) {
    kit::TermScene scene;
    scene.add_page(8, 8);
    const std::vector<float> black(3 * 64, 0.0f);
    scene.content.pages[0].irradiance = black;
    const LightPatches patches = make_light_patches(scene.content, LightPatchPlanes::one);
    ASSERT_EQ(patches.maps.size(), 1u);
    EXPECT_TRUE(patches.maps[0].patches.empty());
    EXPECT_TRUE(patches.atlases.empty());
}

TEST(LightPatches, NamesThatAreNotUtf8AreReplacedAsInTheManifest) {
    kit::TermScene scene;
    scene.add_page(8, 8);
    scene.add_element("lamp \xff", "light_set");
    const LightPatches patches = make_light_patches(scene.content, LightPatchPlanes::one);
    EXPECT_NE(light_patches_json(scene.content, patches).find("lamp \xef\xbf\xbd"), std::string::npos);
}

TEST(LightPatches, NoTexelOfAnAtlasBelongsToTwoPatches) {
    std::vector<PatchSize> sizes;
    kit::TermScene random(3);
    for (int i = 0; i < 700; ++i) sizes.push_back({1 + random.below(64), 1 + random.below(64)});
    const AtlasPlan plan = plan_atlases(sizes);
    std::vector<std::vector<uint8_t>> taken;
    size_t room = 0, used = 0;
    for (const PatchSize& a : plan.atlases) taken.emplace_back(4 * a.width * a.height), room += taken.back().size();
    for (size_t i = 0; i < sizes.size(); ++i) {
        const PatchPlace& p = plan.places[i];
        const PatchSize& a = plan.atlases[p.atlas];
        ASSERT_LE(p.x + sizes[i].width, a.width);
        ASSERT_LE(p.y + sizes[i].height, a.height);
        for (uint32_t y = p.y; y < p.y + sizes[i].height; ++y)
            for (uint32_t x = p.x; x < p.x + sizes[i].width; ++x, ++used)
                EXPECT_EQ(taken[p.atlas][4 * (y * a.width + x) + p.channel]++, 0);
    }
    EXPECT_GT(double(used), 0.6 * double(room));
}

} // namespace
} // namespace ajar
