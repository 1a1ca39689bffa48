// SPDX-License-Identifier: GPL-3.0-or-later
// terms.bin against a plain reader of the format: what goes in comes out, in every class.
#include "package/terms_file.h"

#include <gtest/gtest.h>

#include <glm/gtc/packing.hpp>
#include <numeric>

#include "base/error.h"
#include "encode/ahd.h"
#include "terms_kit.h"

namespace ajar {
namespace {

using kit::TermScene;
using kit::texel_range;
using terms::Class;

struct Written {
    TermsFile file;
    kit::DecodedTerms decoded;
};

Written write(const TermScene& scene) {
    const std::vector<PageChecksums> sums(scene.content.pages.size());
    Written w{make_terms_file(scene.content, sums), {}};
    w.decoded = kit::decode_terms(w.file.bytes);
    return w;
}

/// The terms of each texel as they were given, in order.
std::map<uint32_t, std::vector<std::pair<uint32_t, size_t>>> given_lists(const PackageContent& content) {
    std::map<uint32_t, std::vector<std::pair<uint32_t, size_t>>> lists;
    for (uint32_t t = 0; t < content.terms.size(); ++t)
        for (size_t i = 0; i < content.terms[t].texel.size(); ++i) lists[content.terms[t].texel[i]].emplace_back(t, i);
    return lists;
}

/// Largest error of storing v: half a step of the format, for normal and denormal values.
float tolerance(float v, int mantissa, float scale) {
    return std::max(std::ldexp(std::fabs(v), -mantissa - 1), scale * std::ldexp(0.5f, -14 - mantissa));
}

/// What a door or toggle alone takes from a base of light e is scaled as the base was rounded, to stored; what takes
/// all of it takes a thousandth more.
float scaled_as_base(float v, float e, float stored) {
    if (!(v < 0.0f) || !(e > 0.0f)) return v;
    return -v < e * (1.0f - 0x1p-10f) ? v * (stored / e) : std::min(v, -stored * (1.0f + 0x1p-10f));
}

void expect_entry(const PackageTerm& term, size_t i, bool takes_base, const Vec3& base, const Vec3& stored,
                  const kit::DecodedEntry& entry, float scale) {
    EXPECT_EQ(entry.direction, term.direction[i]);
    for (int c = 0; c < 3; ++c) {
        const float given = term.irradiance[3 * i + size_t(c)],
                    v = takes_base ? scaled_as_base(given, base[c], stored[c]) : given;
        EXPECT_NEAR(entry.irradiance[c], v, tolerance(v, term.is_signed ? 10 : c == 2 ? 5 : 6, scale));
    }
}

void expect_round_trip(const TermScene& scene, const Written& w) {
    const auto given = given_lists(scene.content);
    ASSERT_EQ(w.decoded.receivers.size(), given.size());
    uint32_t first = 0, page = 0;
    for (const auto& [texel, list] : given) {
        while (texel >= first + scene.content.pages[page].packed_irradiance.size())
            first += uint32_t(scene.content.pages[page++].packed_irradiance.size());
        const kit::DecodedReceiver& r = w.decoded.receivers.at(texel);
        EXPECT_EQ(r.irradiance, scene.content.pages[page].packed_irradiance[texel - first]);
        EXPECT_EQ(r.direction, scene.content.pages[page].packed_direction[texel - first]);
        ASSERT_EQ(r.entries.size(), list.size());
        for (size_t s = 0; s < list.size(); ++s) {
            ASSERT_EQ(r.entries[s].term, list[s].first);
            const PackageTerm& term = scene.content.terms[list[s].first];
            const bool takes_base =
                term.elements.size() == 1 && scene.content.elements[term.elements[0]].kind != "light_set";
            const float* e = &scene.content.pages[page].irradiance[3 * size_t{texel - first}];
            expect_entry(term, list[s].second, takes_base, {e[0], e[1], e[2]}, unpack_r11g11b10f(r.irradiance),
                         r.entries[s], w.decoded.terms[list[s].first].scale);
        }
    }
}

/// Texels first..first+counts.size() with counts[i] terms each, of as many light sets as needed.
void add_overlaps(TermScene& scene, uint32_t first, const std::vector<uint32_t>& counts) {
    const uint32_t most = *std::max_element(counts.begin(), counts.end());
    for (uint32_t e = uint32_t(scene.content.elements.size()); e < most; ++e) scene.add_element("set", "light_set");
    for (uint32_t t = 0; t < most; ++t) {
        std::vector<uint32_t> texels;
        for (uint32_t i = 0; i < counts.size(); ++i)
            if (t < counts[i]) texels.push_back(first + i);
        scene.add_term({t}, texels);
    }
}

std::vector<uint64_t> receivers_by_class(const Written& w) {
    std::vector<uint64_t> n(terms::kClassCount);
    for (const terms::Dispatch& d : w.decoded.dispatches) n[d.kind] += d.receivers;
    return n;
}

TEST(TermsFile, EverythingComesBack) {
    TermScene scene;
    kit::fill_everything(scene);
    const Written w = write(scene);
    const std::vector<uint64_t> classes = receivers_by_class(w);
    for (const uint64_t n : classes) EXPECT_GT(n, 0u);
    expect_round_trip(scene, w);
    EXPECT_EQ(w.decoded.names[7], "element 7");
}

TEST(TermsFile, RandomOverlapsComeBack) {
    for (uint32_t seed = 1; seed <= 20; ++seed) {
        TermScene scene(seed);
        scene.add_page(37, 23);
        std::vector<uint32_t> counts(37 * 23);
        for (uint32_t& c : counts) c = scene.below(17);
        add_overlaps(scene, 0, counts);
        expect_round_trip(scene, write(scene));
    }
}

TEST(TermsFile, ClassesFollowOverlapAndCount) {
    const auto classes = [](uint32_t terms, uint32_t texels) {
        TermScene scene;
        scene.add_page(20, 20);
        add_overlaps(scene, 5, std::vector<uint32_t>(texels, terms));
        return receivers_by_class(write(scene));
    };
    EXPECT_EQ(classes(1, 129), (std::vector<uint64_t>{129, 0, 0, 0, 0}));
    EXPECT_EQ(classes(8, 129), (std::vector<uint64_t>{129, 0, 0, 0, 0}));
    EXPECT_EQ(classes(1, 128), (std::vector<uint64_t>{0, 128, 0, 0, 0}));
    EXPECT_EQ(classes(4, 1), (std::vector<uint64_t>{0, 1, 0, 0, 0}));
    EXPECT_EQ(classes(5, 128), (std::vector<uint64_t>{0, 0, 128, 0, 0}));
    EXPECT_EQ(classes(8, 1), (std::vector<uint64_t>{0, 0, 1, 0, 0}));
    EXPECT_EQ(classes(9, 300), (std::vector<uint64_t>{0, 0, 0, 300, 0}));
    EXPECT_EQ(classes(16, 1), (std::vector<uint64_t>{0, 0, 0, 1, 0}));
    EXPECT_EQ(classes(17, 1), (std::vector<uint64_t>{0, 0, 0, 0, 1}));
    EXPECT_EQ(classes(300, 300), (std::vector<uint64_t>{0, 0, 0, 0, 300}));
}

TEST(TermsFile, StaticTexelsAreInNoDispatch) {
    TermScene scene;
    scene.add_page(16, 16);
    scene.add_element("lamp", "light_set");
    scene.add_term({0}, {3, 200});
    const Written w = write(scene);
    EXPECT_EQ(w.decoded.receivers.size(), 2u);
    EXPECT_EQ(w.file.summary.elements[0].texels, 2u);
}

TEST(TermsFile, LargeDispatchesAreSplit) {
    TermScene scene;
    scene.add_page(400, 300);
    add_overlaps(scene, 0, std::vector<uint32_t>(120000, 2));
    const Written w = write(scene);
    ASSERT_EQ(w.decoded.dispatches.size(), 4u); // 240000 entries
    for (const terms::Dispatch& d : w.decoded.dispatches) EXPECT_LE(d.entries, terms::kMaxEntries);
    expect_round_trip(scene, w);
}

TEST(TermsFile, SixteenOverlapsFillADispatchToTheLastStart) {
    TermScene scene;
    scene.add_page(128, 64);
    add_overlaps(scene, 0, std::vector<uint32_t>(8192, 16));
    const Written w = write(scene);
    for (const terms::Dispatch& d : w.decoded.dispatches) EXPECT_EQ(d.entries, terms::kMaxEntries);
    expect_round_trip(scene, w);
}

TEST(TermsFile, ReceiversLieInMortonOrder) {
    TermScene scene;
    scene.add_page(32, 32);
    add_overlaps(scene, 0, std::vector<uint32_t>(1024, 1));
    const std::vector<uint32_t> order = write(scene).decoded.order.at(0);
    for (uint32_t quarter = 0; quarter < 4; ++quarter) // the first 256 fill a quarter of the page, and so on
        for (uint32_t i = 0; i < 256; ++i) {
            const uint32_t texel = order[256 * quarter + i];
            EXPECT_EQ(texel % 32 / 16, quarter % 2);
            EXPECT_EQ(texel / 32 / 16, quarter / 2);
        }
}

TEST(TermsFile, ListsOfAnyLengthComeBack) {
    for (uint32_t seed = 1; seed <= 3; ++seed) {
        TermScene scene(seed);
        kit::fill_hundreds(scene);
        const Written w = write(scene);
        expect_round_trip(scene, w);
        EXPECT_GT(receivers_by_class(w)[4], 700u);
        EXPECT_EQ(w.decoded.receivers.at(0).entries.size(), 300u);
        EXPECT_EQ(w.file.summary.texels.most_terms, 300u);
    }
}

TEST(TermsFile, AsManyTermsAsAPackageHolds) {
    TermScene scene; // 65536 of them, 4096 at each of 16 texels
    scene.add_page(4, 4);
    for (uint32_t t = 0; t < 65536; ++t) {
        scene.add_element("set", "light_set");
        scene.add_term({t}, {t % 16});
    }
    const Written w = write(scene);
    expect_round_trip(scene, w);
    EXPECT_EQ(w.file.summary.texels.most_terms, 4096u);
    scene.add_element("set", "light_set");
    scene.add_term({65536}, {0});
    EXPECT_THROW(write(scene), Error);
}

TEST(TermsFile, WeakTermsStayBesideStrongOnes) {
    TermScene scene;
    scene.add_page(4, 4);
    const uint32_t d = pack_direction({});
    for (uint32_t t = 0; t < 40; ++t) {
        scene.add_element("set", "light_set");
        const float v = std::exp2(-float((t * 7) % 40)); // in a scattered order
        scene.add_term({t}, {5}, {v, v, v}, {d}, false);
    }
    const Written w = write(scene);
    ASSERT_EQ(w.decoded.receivers.at(5).entries.size(), 40u);
    expect_round_trip(scene, w);
}

TEST(TermsFile, TermsBeyondSixteenTakeTheirWordsAndLittleMore) {
    const auto bytes_per_entry = [](TermScene& scene) {
        const ClassSummary c = write(scene).file.summary.classes[4];
        return double(c.bytes) / double(c.entries);
    };
    TermScene same, unlike;
    same.add_page(64, 64);
    add_overlaps(same, 0, std::vector<uint32_t>(4096, 100));
    EXPECT_LT(bytes_per_entry(same),
              8.4); // 8 are the entry's own: slots of 16 receivers take 4 / 16, receivers 12 / 100
    unlike.add_page(64, 64);
    kit::add_random_lists(unlike, 4096, 2000, 200); // a slot holds 1.3 of 16 receivers; of the terms some are signed
    EXPECT_LT(bytes_per_entry(unlike), 12.0 + 4.0 + 0.5);
}

TEST(TermsFile, AnyIntensityKeepsItsPrecision) {
    for (const float strength : {1e-20f, 1e-6f, 1.0f, 1e6f, 1e20f}) {
        TermScene scene;
        scene.add_page(16, 16);
        scene.add_element("lamp", "light_set");
        scene.add_element("door", "door");
        scene.add_term({0}, texel_range(0, 200), false, strength);
        scene.add_term({1}, texel_range(100, 100), true, strength);
        expect_round_trip(scene, write(scene));
    }
}

TEST(TermsFile, NegativeLightMakesATermSigned) {
    TermScene scene;
    scene.add_page(4, 4);
    scene.add_element("lamp", "light_set");
    scene.add_term({0}, {2}, {0.5f, -0.25f, 0.0f}, {pack_direction({})}, false); // not marked by its maker
    const Written w = write(scene);
    EXPECT_TRUE(w.file.summary.terms[0].is_signed);
    EXPECT_EQ(w.decoded.receivers.at(2).entries[0].irradiance, Vec3(0.5f, -0.25f, 0.0f));
}

TEST(TermsFile, UnsignedTermsHoldTheSameValuesBesideSignedOnes) {
    TermScene alone, beside;
    for (TermScene* scene : {&alone, &beside}) {
        scene->add_page(8, 8);
        scene->add_element("lamp", "light_set");
        scene->add_element("toggle", "toggle");
        scene->add_term({0}, texel_range(0, 64));
    }
    beside.add_term({1}, texel_range(0, 64), true);
    const Written a = write(alone), b = write(beside);
    for (uint32_t texel = 0; texel < 64; ++texel)
        EXPECT_EQ(a.decoded.receivers.at(texel).entries[0].irradiance,
                  b.decoded.receivers.at(texel).entries[0].irradiance);
    EXPECT_FALSE(b.file.summary.terms[0].is_signed);
}

TEST(TermsFile, BlackEntriesAreLeftOut) {
    TermScene scene;
    scene.add_page(4, 4);
    scene.add_element("lamp", "light_set");
    const uint32_t d = pack_direction({});
    scene.add_term({0}, {1, 2, 3}, {1, 1, 1, 0, 0, 0, 1e-12f, 0, 0}, {d, d, d}, false);
    const Written w = write(scene);
    EXPECT_EQ(w.decoded.receivers.size(), 1u);
    EXPECT_EQ(w.file.summary.terms[0].texels, 1u);
}

TEST(TermsFile, HalfFloatsAgreeWithGlm) {
    for (uint32_t h = 0; h < 65536; ++h) {
        if ((h & 0x7c00u) == 0x7c00u) continue; // infinite or NaN: never written
        const float v = glm::unpackHalf1x16(static_cast<uint16_t>(h));
        ASSERT_EQ(unpack_half(h), v);
        ASSERT_EQ(pack_half(v), v == 0.0f ? 0u : h);
        if (v > 0.0f && v < 65504.0f) { // between two halves, to the nearest
            const float next = glm::unpackHalf1x16(static_cast<uint16_t>(h + 1));
            ASSERT_EQ(pack_half(v + 0.49f * (next - v)), h);
            ASSERT_EQ(pack_half(v + 0.51f * (next - v)), h + 1);
        }
    }
    EXPECT_EQ(pack_half(1e30f), 0x7bffu);
    EXPECT_EQ(pack_half(-1e30f), 0xfbffu);
    EXPECT_EQ(pack_half(NAN), 0u);
}

TEST(TermsFile, PackedCountsOfOneBatchExhaustively) {
    // 3 bit fields: all 2^24 batches of 8.
    for (uint32_t fields = 0; fields < (1u << 24); ++fields) {
        uint32_t before = 0;
        for (uint32_t t = 0; t < 8; ++t) {
            if (entries_before(fields, terms::kV16Packing, t) != before) FAIL() << fields << " " << t;
            before += 9 + ((fields >> (3 * t)) & 7);
            if (field_count(fields, terms::kV16Packing, t) != 9 + ((fields >> (3 * t)) & 7))
                FAIL() << fields << " " << t;
        }
    }
    // 2 bit fields: all settings of either half of a batch of 16, beside fixed settings of the other.
    for (const uint32_t other : {0u, 0x1b2du, 0xffffu})
        for (uint32_t half = 0; half < (1u << 16); ++half)
            for (const uint32_t fields : {half | other << 16, half << 16 | other}) {
                uint32_t before = 0;
                for (uint32_t t = 0; t < 16; ++t) {
                    if (entries_before(fields, terms::kV8Packing, t) != before) FAIL() << fields << " " << t;
                    before += 5 + ((fields >> (2 * t)) & 3);
                }
            }
}

TEST(TermsFile, EveryBatchIsFoundAmongItsNeighbours) {
    TermScene scene;
    for (const auto& packing : {terms::kV8Packing, terms::kV16Packing}) {
        std::vector<uint32_t> fields, words(200, 0);
        for (uint32_t r = 0; r < 200 * 32 / packing.bits / packing.batch * packing.batch; ++r) {
            fields.push_back(scene.below(1u << packing.bits));
            for (uint32_t b = 0; b < packing.bits; ++b)
                words[(r * packing.bits + b) / 32] |= ((fields[r] >> b) & 1u) << ((r * packing.bits + b) % 32);
        }
        for (uint32_t r = 0; r < fields.size(); ++r)
            EXPECT_EQ(field_count(batch_fields(words.data(), packing, r / packing.batch), packing, r % packing.batch),
                      packing.least + fields[r]);
    }
}

TEST(TermsFile, ClusteringWastesLittleOnDisjointSets) {
    TermScene scene; // 40 lamps of 50 texels each, no overlap: an update of one need not touch the rest
    scene.add_page(64, 64);
    for (uint32_t e = 0; e < 40; ++e) {
        scene.add_element("lamp", "light_set");
        scene.add_term({e}, texel_range(100 * e, 50));
    }
    const TermsSummary s = write(scene).file.summary;
    EXPECT_LT(s.wasted_updates, 8.0); // all in one dispatch would be 40
    EXPECT_LT(s.classes[1].dispatches, 40u);
    EXPECT_EQ(s.classes[1].receivers, 2000u);
}

TEST(TermsFile, SummaryAddsUp) {
    TermScene scene;
    kit::fill_everything(scene);
    const Written w = write(scene);
    const TermsSummary& s = w.file.summary;
    uint64_t bytes = 0, entries = 0, texels = 0, run = 0, needed = 0, binned = 0;
    for (const ClassSummary& c : s.classes) bytes += c.bytes, entries += c.entries;
    for (const TermSummary& t : s.terms) texels += t.texels;
    EXPECT_EQ(entries, texels);
    EXPECT_EQ(s.texels.terms, entries);
    EXPECT_NEAR(s.texels.bytes, double(bytes), 1e-6 * double(bytes));
    EXPECT_EQ(s.texels.texels, w.decoded.receivers.size());
    for (const uint64_t n : s.texels.histogram) binned += n;
    EXPECT_EQ(binned, s.texels.texels);
    EXPECT_EQ(s.bytes, w.file.bytes.size());
    EXPECT_GT(s.bytes, bytes);
    EXPECT_LT(s.bytes, bytes + 8192); // header, names, tables of elements and terms
    for (uint32_t e = 0; e < scene.content.elements.size(); ++e) {
        const auto has = [&](uint32_t t) {
            const auto& el = scene.content.terms[t].elements;
            return std::find(el.begin(), el.end(), e) != el.end();
        };
        uint64_t reached = 0;
        for (const auto& [texel, r] : w.decoded.receivers)
            reached += std::any_of(r.entries.begin(), r.entries.end(), [&](const auto& x) { return has(x.term); });
        EXPECT_EQ(s.elements[e].texels, reached);
        needed += reached;
        for (size_t d = 0; d < w.decoded.dispatches.size(); ++d)
            if (std::any_of(w.decoded.palettes[d].begin(), w.decoded.palettes[d].end(), has))
                run += w.decoded.dispatches[d].receivers;
    }
    EXPECT_DOUBLE_EQ(s.wasted_updates, double(run) / double(needed));
}

TEST(TermsFile, TheSameContentGivesTheSameBytes) {
    TermScene a(3), b(3);
    kit::fill_everything(a);
    kit::fill_everything(b);
    EXPECT_EQ(write(a).file.bytes, write(b).file.bytes);
}

TEST(TermsFile, MalformedTermsAreRefused) {
    const auto refused = [](auto&& spoil) {
        TermScene scene;
        scene.add_page(4, 4);
        scene.add_element("lamp", "light_set");
        scene.add_element("door", "door");
        scene.add_term({0, 1}, {1, 2});
        write(scene);
        spoil(scene.content);
        EXPECT_THROW(write(scene), Error);
    };
    static const std::vector<uint32_t> backwards = {2, 1}, twice = {2, 2}, outside = {2, 16};
    static const std::vector<float> nan = {0, 0, NAN, 0, 0, 0};
    refused([](PackageContent& c) { c.terms[0].elements = {}; });
    refused([](PackageContent& c) { c.terms[0].elements = {1, 0}; });
    refused([](PackageContent& c) { c.terms[0].elements = {0, 2}; });
    refused([](PackageContent& c) { c.terms[0].texel = backwards; });
    refused([](PackageContent& c) { c.terms[0].texel = twice; });
    refused([](PackageContent& c) { c.terms[0].texel = outside; });
    refused([](PackageContent& c) { c.terms[0].irradiance = nan; });
    refused([](PackageContent& c) { c.terms[0].irradiance = c.terms[0].irradiance.first(3); });
    refused([](PackageContent& c) { c.terms[0].direction = c.terms[0].direction.first(1); });
    refused([](PackageContent& c) { c.elements[0].kind = "window"; });
    refused([](PackageContent& c) { c.elements[1].weight = 1.5f; });
    refused([](PackageContent& c) { c.elements[0].weight = -1.0f; });
}

} // namespace
} // namespace ajar
