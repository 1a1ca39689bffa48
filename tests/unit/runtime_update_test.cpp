// SPDX-License-Identifier: GPL-3.0-or-later
// What an update makes of weights: base + sum of weight * term, whatever came before.
#include <gtest/gtest.h>
#include <immintrin.h>

#include <cmath>

#include "encode/ahd.h"
#include "runtime_kit.h"

namespace {

using namespace ajar;

/// Linear state of a texel in double precision (algorithms.md 1.7).
struct State {
    double e[3] = {}, a = 0, dx = 0, dy = 0;
    double size = 0; ///< of all that was added, whatever its sign: rounding in floats goes with it

    double luminance() const { return 0.2126 * e[0] + 0.7152 * e[1] + 0.0722 * e[2]; }
    void add(const double (&light)[3], uint32_t direction) {
        const auto channel = [&](int i) { return double((direction >> (8 * i)) & 0xff) / 255.0; };
        State t;
        for (int c = 0; c < 3; ++c) e[c] += t.e[c] = light[c], size += std::fabs(light[c]);
        const double r = channel(3), z = std::max(channel(2) * 2 - 1, 0.1), highlight = (1 - r) * t.luminance();
        a += r * t.luminance();
        dx += highlight * (channel(0) * 2 - 1) / z;
        dy += highlight * (channel(1) * 2 - 1) / z;
    }
};

void expect_code(double value, uint32_t word, int shift, const char* what) {
    EXPECT_NEAR(value * 255.0, double((word >> shift) & 0xff), 0.501) << what; // a rounded code, and float's last bits
}

/// The packed texel against the state: half a step of each format.
void expect_packed(const State& s, uint32_t irradiance, uint32_t direction) {
    const Vec3 e = unpack_r11g11b10f(irradiance);
    State clamped = s;
    for (int c = 0; c < 3; ++c) {
        clamped.e[c] = std::max(s.e[c], 0.0);
        const double limit = c == 2 ? 64512 : 65024, bits = c == 2 ? 5 : 6;
        const double half_step =
            std::exp2(-bits - 1) * std::max(clamped.e[c], std::exp2(-14)); // denormals have even steps
        EXPECT_NEAR(std::min(clamped.e[c], limit), e[c], half_step + 1e-6 * s.size) << c;
    }
    const double total = clamped.luminance();
    if (total < 1e-2 * s.size) return; // what is left of a cancellation, or nothing
    const double ambient = std::clamp(s.a, 0.0, total), ratio = ambient / total;
    expect_code(ratio, direction, 24, "ratio");
    if (ratio > 0.997) return; // may count as all ambient
    double x = s.dx / (total - ambient), y = s.dy / (total - ambient);
    const double steep = std::sqrt((x * x + y * y) / 24.0);
    if (steep > 1) x /= steep, y /= steep;
    const double z = 1 / std::sqrt(1 + x * x + y * y);
    expect_code(x * z * 0.5 + 0.5, direction, 0, "x");
    expect_code(y * z * 0.5 + 0.5, direction, 8, "y");
    expect_code(z * 0.5 + 0.5, direction, 16, "z");
}

/// A scene with everything, its package, and its terms as a plain reader finds them.
class RuntimeUpdate : public ::testing::Test {
protected:
    explicit RuntimeUpdate(void (*fill)(kit::TermScene&) = kit::fill_everything) {
        fill(scene_);
        folder_.emplace(scene_);
        terms_ = kit::decode_terms(folder_->read("terms.bin"));
    }

    /// Index into a page's words, which have their top row first, of a texel over all pages.
    std::pair<uint32_t, size_t> place(uint32_t texel) const {
        uint32_t page = 0;
        for (; texel >= terms_.pages[page].width * terms_.pages[page].height; ++page)
            texel -= terms_.pages[page].width * terms_.pages[page].height;
        const uint32_t w = terms_.pages[page].width;
        return {page, size_t{terms_.pages[page].height - 1 - texel / w} * w + texel % w};
    }
    double variable(uint32_t element, double weight) const {
        const terms::Element& e = terms_.elements[element];
        return kit::variable_of(e.kind == static_cast<uint32_t>(terms::Kind::light_set), e.weight, weight);
    }
    State expected(const kit::DecodedReceiver& r, const kit::Runtime& runtime) const {
        State s;
        const Vec3 base = unpack_r11g11b10f(r.irradiance);
        s.add({base.x, base.y, base.z}, r.direction);
        for (const kit::DecodedEntry& entry : r.entries) {
            double light[3] = {entry.irradiance.x, entry.irradiance.y, entry.irradiance.z};
            const terms::Term& term = terms_.terms[entry.term];
            for (uint32_t i = 0; i < term.element_count; ++i) {
                const ajar_runtime_element e = runtime.element(term.elements[i]);
                for (int c = 0; c < 3; ++c) light[c] *= variable(term.elements[i], e.weight) * double(e.color[c]);
            }
            s.add(light, entry.direction);
        }
        return s;
    }
    bool any_on(const kit::DecodedReceiver& r, const kit::Runtime& runtime) const {
        return std::any_of(r.entries.begin(), r.entries.end(), [&](const kit::DecodedEntry& entry) {
            const terms::Term& t = terms_.terms[entry.term];
            return std::all_of(t.elements, t.elements + t.element_count,
                               [&](uint32_t e) { return variable(e, runtime.element(e).weight) != 0.0; });
        });
    }
    void expect_sums(const kit::Runtime& runtime) const {
        const std::vector<kit::PageWords> pages = runtime.pages();
        for (const auto& [texel, r] : terms_.receivers) {
            const auto [page, i] = place(texel);
            if (any_on(r, runtime)) {
                expect_packed(expected(r, runtime), pages[page].irradiance[i], pages[page].direction[i]);
            } else {
                EXPECT_EQ(pages[page].irradiance[i], r.irradiance);
                EXPECT_EQ(pages[page].direction[i], r.direction);
            }
            if (HasFailure()) FAIL() << "texel " << texel << " with " << r.entries.size() << " terms";
        }
    }
    void randomise(kit::Runtime& runtime, kit::TermScene& random) const {
        for (uint32_t e = 0; e < runtime.element_count(); ++e) change(runtime, e, random);
    }
    void change(kit::Runtime& runtime, uint32_t e, kit::TermScene& random) const {
        const bool set = runtime.element(e).kind == AJAR_RUNTIME_LIGHT_SET;
        const uint32_t way = random.below(4);
        runtime.set_weight(e, way == 0 ? 0.0f : way == 1 ? 1.0f : random.uniform(0.0f, set ? 3.0f : 1.0f));
        if (set && random.below(3) == 0)
            runtime.set_color(e, random.uniform(), random.uniform(), random.uniform(0.0f, 2.0f));
    }

    kit::TermScene scene_;
    std::optional<kit::PackageFolder> folder_;
    kit::DecodedTerms terms_;
};

std::vector<kit::PageWords> base_pages(const kit::TermScene& scene) {
    std::vector<kit::PageWords> pages;
    for (const PackagePage& p : scene.content.pages) {
        kit::PageWords& words = pages.emplace_back();
        for (uint32_t y = p.height; y-- > 0;)
            for (uint32_t x = 0; x < p.width; ++x) {
                words.irradiance.push_back(p.packed_irradiance[size_t{y} * p.width + x]);
                words.direction.push_back(p.packed_direction[size_t{y} * p.width + x]);
            }
    }
    return pages;
}

TEST_F(RuntimeUpdate, OpensAtTheBaseAndStartsAtTheStartWeights) {
    kit::Runtime runtime(folder_->path());
    EXPECT_EQ(runtime.pages(), base_pages(scene_));
    ASSERT_EQ(runtime.element_count(), 20u);
    EXPECT_STREQ(runtime.element(3).name, "element 3");
    EXPECT_EQ(runtime.element(3).kind, uint32_t{AJAR_RUNTIME_TOGGLE});
    EXPECT_EQ(runtime.element(3).weight, 1.0f);
    EXPECT_EQ(runtime.element(4).weight, 0.0f);
    runtime.update();
    expect_sums(runtime);
}

TEST_F(RuntimeUpdate, PagesAreBasePlusWeightedTerms) {
    kit::Runtime runtime(folder_->path());
    kit::TermScene random(7);
    for (int round = 0; round < 10; ++round) {
        randomise(runtime, random);
        runtime.update();
        expect_sums(runtime);
    }
}

/// Up to 300 terms at a texel.
class RuntimeHundreds : public RuntimeUpdate {
protected:
    RuntimeHundreds() : RuntimeUpdate(kit::fill_hundreds) {}
};

TEST_F(RuntimeHundreds, PagesAreBasePlusWeightedTerms) {
    kit::Runtime runtime(folder_->path());
    kit::TermScene random(7);
    for (int round = 0; round < 5; ++round) {
        randomise(runtime, random);
        runtime.update();
        expect_sums(runtime);
    }
}

TEST_F(RuntimeHundreds, EachSetAlone) {
    kit::Runtime runtime(folder_->path());
    runtime.set_all(0.0f);
    runtime.update();
    EXPECT_EQ(runtime.pages(), base_pages(scene_));
    for (uint32_t e = 0; e < runtime.element_count(); e += 13) {
        runtime.set_weight(e, 1.0f);
        runtime.update();
        expect_sums(runtime);
        runtime.set_weight(e, 0.0f);
    }
}

TEST_F(RuntimeUpdate, EachElementAlone) {
    kit::Runtime runtime(folder_->path());
    for (uint32_t e = 0; e < runtime.element_count(); ++e) {
        runtime.set_all(0.0f);
        runtime.set_weight(e, 1.0f);
        runtime.update();
        expect_sums(runtime);
    }
}

TEST_F(RuntimeUpdate, SetsOffAndTheRestAsAtTheStartIsTheBaseToTheBit) {
    kit::Runtime runtime(folder_->path());
    for (const float weight : {1.0f, 0.0f}) {
        runtime.set_all(weight);
        runtime.update();
        EXPECT_NE(runtime.pages(), base_pages(scene_));
    }
    for (uint32_t e = 0; e < runtime.element_count(); ++e)
        runtime.set_weight(e, runtime.element(e).kind == AJAR_RUNTIME_LIGHT_SET ? 0.0f : terms_.elements[e].weight);
    runtime.update();
    EXPECT_EQ(runtime.pages(), base_pages(scene_));
}

TEST_F(RuntimeUpdate, TenThousandSwitchesLeaveNoTrace) {
    kit::Runtime runtime(folder_->path());
    kit::TermScene random(11);
    for (int i = 0; i < 10000; ++i) {
        change(runtime, random.below(20), random);
        if (random.below(3) != 0) runtime.update();
    }
    runtime.update();
    kit::Runtime fresh(folder_->path());
    for (uint32_t e = 0; e < 20; ++e) {
        const ajar_runtime_element state = runtime.element(e);
        fresh.set_weight(e, state.weight);
        if (state.kind == AJAR_RUNTIME_LIGHT_SET) fresh.set_color(e, state.color[0], state.color[1], state.color[2]);
    }
    fresh.update();
    EXPECT_EQ(runtime.pages(), fresh.pages());
}

TEST_F(RuntimeUpdate, ExtremeWeightsStayFinite) {
    kit::Runtime runtime(folder_->path());
    for (const float weight : {1e-45f, 1e-30f, 1e-8f, 1e4f, 1e30f, 3.4e38f}) {
        for (uint32_t e = 0; e < 20; ++e) {
            const bool set = runtime.element(e).kind == AJAR_RUNTIME_LIGHT_SET;
            runtime.set_weight(e, set ? weight : std::min(weight, 1.0f));
            if (set) runtime.set_color(e, weight, 1.0f, 0.0f);
        }
        runtime.update();
        for (const kit::PageWords& page : runtime.pages())
            for (const uint32_t word : page.irradiance) { // the exponent of infinity and NaN is never written
                ASSERT_NE((word >> 6) & 0x1f, 0x1fu);
                ASSERT_NE((word >> 17) & 0x1f, 0x1fu);
                ASSERT_NE((word >> 27) & 0x1f, 0x1fu);
            }
    }
}

TEST_F(RuntimeUpdate, FaintAndStrongWeightsAddUp) {
    kit::Runtime runtime(folder_->path());
    for (const float weight : {1e-8f, 1e4f}) {
        runtime.set_all(0.0f);
        for (uint32_t e = 0; e < 20; ++e)
            if (runtime.element(e).kind == AJAR_RUNTIME_LIGHT_SET) runtime.set_weight(e, weight);
        runtime.update();
        expect_sums(runtime);
    }
}

TEST_F(RuntimeUpdate, ProcessorsThatFlushDenormalsGetTheSameBits) {
    kit::Runtime plain(folder_->path()), flushed(folder_->path());
    kit::TermScene random(5);
    for (uint32_t e = 0; e < 20; ++e) {
        change(plain, e, random);
        flushed.set_weight(e, plain.element(e).weight);
        if (plain.element(e).kind == AJAR_RUNTIME_LIGHT_SET) {
            const ajar_runtime_element state = plain.element(e);
            flushed.set_color(e, state.color[0], state.color[1], state.color[2]);
        }
    }
    plain.update();
    const unsigned before = _mm_getcsr();
    _mm_setcsr(before | 0x8040u); // flush to zero, denormals are zero
    flushed.update();
    _mm_setcsr(before);
    EXPECT_EQ(plain.pages(), flushed.pages());
}

TEST_F(RuntimeUpdate, OnlyWhatAChangeReachesRuns) {
    kit::Runtime runtime(folder_->path());
    runtime.update();
    EXPECT_EQ(runtime.update().dispatches, 0u);
    for (uint32_t e = 0; e < 20; ++e) {
        runtime.set_weight(e, runtime.element(e).weight); // no change
        const ajar_runtime_stats none = runtime.update();
        EXPECT_EQ(none.dispatches + none.texels + none.pages, 0u);
        for (uint32_t other = 0; other < 20; ++other) // products are on
            runtime.set_weight(other, variable(other, 1.0) != 0.0 ? 1.0f : 0.0f);
        runtime.update();
        const std::vector<kit::PageWords> before = runtime.pages();
        runtime.set_weight(e, 0.75f);
        const ajar_runtime_stats stats = runtime.update();
        EXPECT_EQ(stats.dispatches, runtime.element(e).dispatches);
        EXPECT_EQ(stats.texels, runtime.element(e).texels);
        uint32_t pages = 0;
        for (uint32_t p = 0; p < 2; ++p) {
            ajar_runtime_rect rect;
            ASSERT_EQ(ajar_runtime_page_dirty(runtime.handle(), p, &rect), AJAR_RUNTIME_OK);
            pages += rect.width > 0;
            const kit::PageWords after = runtime.page(p);
            for (uint32_t i = 0; i < after.irradiance.size(); ++i) {
                const uint32_t x = i % terms_.pages[p].width, y = i / terms_.pages[p].width;
                const bool inside = x - rect.x < rect.width && y - rect.y < rect.height;
                ASSERT_TRUE(inside || after.irradiance[i] == before[p].irradiance[i]);
            }
        }
        EXPECT_EQ(stats.pages, pages);
    }
}

TEST_F(RuntimeUpdate, PlannedWorkIsWhatAnUpdateRuns) {
    kit::Runtime runtime(folder_->path()), planned(folder_->path());
    kit::TermScene random(3);
    for (int round = 0; round < 20; ++round) {
        const uint32_t e = random.below(20);
        const float weight = random.uniform();
        runtime.set_weight(e, weight);
        planned.set_weight(e, weight);
        const ajar_runtime_stats stats = runtime.update();
        ajar_runtime_work work;
        ajar_runtime_work_init(&work);
        ASSERT_EQ(ajar_runtime_plan_update(planned.handle(), &work), AJAR_RUNTIME_OK);
        EXPECT_EQ(work.stats.dispatches, stats.dispatches);
        EXPECT_EQ(work.stats.texels, stats.texels);
        uint64_t texels = 0;
        for (uint32_t g = 0; g < work.group_count; ++g) {
            const uint32_t receivers = terms_.dispatches.at(work.groups[2 * g]).receivers;
            ASSERT_LT(work.groups[2 * g + 1], receivers);
            texels += std::min(AJAR_RUNTIME_GROUP_SIZE, receivers - work.groups[2 * g + 1]);
        }
        EXPECT_EQ(texels, stats.texels);
    }
    EXPECT_EQ(planned.pages(), base_pages(scene_));
}

TEST(RuntimeLight, TakenAwayBelowZeroIsBlack) {
    kit::TermScene scene;
    scene.add_page(4, 4);
    scene.add_element("toggle", "toggle", 1.0f);
    scene.add_term({0}, kit::texel_range(0, 16), std::vector<float>(48, -100.0f),
                   std::vector<uint32_t>(16, pack_direction({})), true);
    kit::PackageFolder folder(scene);
    kit::Runtime runtime(folder.path());
    runtime.set_weight(0, 0.0f);
    runtime.update();
    EXPECT_EQ(runtime.page(0).irradiance, std::vector<uint32_t>(16, 0));
    EXPECT_EQ(runtime.page(0).direction, std::vector<uint32_t>(16, pack_direction({})));
}

TEST(RuntimeLight, ColourScalesEachChannel) {
    kit::TermScene scene;
    scene.add_page(2, 2);
    std::vector<uint32_t> black(4, 0), plain(4, pack_direction({}));
    scene.content.pages[0].packed_irradiance = black;
    scene.content.pages[0].packed_direction = plain;
    scene.add_element("lamp", "light_set", 1.0f);
    const uint32_t side = pack_direction({Vec3(1.0f), 0.25f, Vec3(0.6f, 0.0f, 0.8f)});
    scene.add_term({0}, {0}, {1.0f, 2.0f, 4.0f}, {side}, false);
    kit::PackageFolder folder(scene);
    kit::Runtime runtime(folder.path());
    runtime.set_color(0, 0.5f, 0.0f, 2.0f);
    runtime.set_weight(0, 2.0f);
    runtime.update();
    EXPECT_EQ(unpack_r11g11b10f(runtime.page(0).irradiance[2]), Vec3(1.0f, 0.0f, 16.0f)); // texel 0 is in the last row
    const Ahd ahd = unpack_direction(runtime.page(0).direction[2], Vec3(1.0f));
    EXPECT_NEAR(ahd.ratio, 0.25f, 0.002f); // colour turns neither ratio nor direction
    EXPECT_NEAR(ahd.direction.x / ahd.direction.z, 0.75f, 0.02f);
}

TEST(RuntimeLight, IrradianceIsReadBottomRowFirst) {
    kit::TermScene scene;
    scene.add_page(3, 2);
    kit::PackageFolder folder(scene);
    kit::Runtime runtime(folder.path()); // no elements: no terms.bin
    EXPECT_EQ(runtime.element_count(), 0u);
    EXPECT_EQ(runtime.update().pages, 0u);
    std::vector<float> rgb(18), rgba(24);
    ASSERT_EQ(ajar_runtime_read_irradiance(runtime.handle(), 0, 3, rgb.data(), 18), AJAR_RUNTIME_OK);
    ASSERT_EQ(ajar_runtime_read_irradiance(runtime.handle(), 0, 4, rgba.data(), 24), AJAR_RUNTIME_OK);
    for (size_t i = 0; i < 6; ++i) {
        const Vec3 e = unpack_r11g11b10f(scene.content.pages[0].packed_irradiance[i]);
        for (int c = 0; c < 3; ++c) {
            EXPECT_EQ(rgb[3 * i + size_t(c)], e[c]);
            EXPECT_EQ(rgba[4 * i + size_t(c)], e[c]);
        }
        EXPECT_EQ(rgba[4 * i + 3], 1.0f);
    }
}

TEST(RuntimeLight, PagesInAnotherUnitAddUpInWatts) {
    constexpr float kScale = 0x1p-24f; // what all of this light needs: without it, it would be black
    kit::TermScene scene;
    scene.add_page(2, 2);
    std::vector<uint32_t> base(4, pack_r11g11b10f(Vec3(1e-8f, 2e-8f, 3e-8f) / kScale)), plain(4, pack_direction({}));
    scene.content.pages[0].packed_irradiance = base;
    scene.content.pages[0].packed_direction = plain;
    scene.content.scale = kScale;
    scene.add_element("lamp", "light_set", 0.5f);
    scene.add_term({0}, {0, 1}, {4e-8f, 0, 0, 0, 4e-8f, 0}, {plain[0], plain[0]}, false);
    kit::PackageFolder folder(scene);
    kit::Runtime runtime(folder.path());
    runtime.update();
    float scale = 0.0f, rgb[12];
    ASSERT_EQ(ajar_runtime_page_scale(runtime.handle(), 0, &scale), AJAR_RUNTIME_OK);
    EXPECT_EQ(scale, kScale);
    ASSERT_EQ(ajar_runtime_read_irradiance(runtime.handle(), 0, 3, rgb, 12), AJAR_RUNTIME_OK);
    const float expected[12] = {3e-8f, 2e-8f, 3e-8f, 1e-8f, 4e-8f, 3e-8f, 1e-8f, 2e-8f, 3e-8f, 1e-8f, 2e-8f, 3e-8f};
    for (int i = 0; i < 12; ++i) EXPECT_NEAR(rgb[i] / expected[i], 1.0f, 0x1p-5f) << i;
}

/// Share of a diffuse, infinitely high opening's light that passes a leaf of the opening's width,
/// hinged at its edge, by counting rays.
double passing_share(double angle) {
    const double tip_x = std::cos(angle), tip_y = std::sin(angle);
    const int n = 400;
    int passed = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) { // from (x, 0), hinge at 0; Lambert: even in the sine
            const double x = (i + 0.5) / n, s = (j + 0.5) / n * 2 - 1, up = std::sqrt(1 - s * s);
            const double hinge = -x * up, tip = (tip_x - x) * up - tip_y * s; // sides of the ray
            passed += !(hinge < 0 && tip > 0); // the leaf's ends lie on both sides: blocked
        }
    return double(passed) / (double(n) * n);
}

TEST(RuntimeDoor, OpennessIsTheViewFactorOfTheGap) {
    const float half_turn = 3.14159265f;
    for (const float angle : {0.1f, 0.5f, 1.0f, 1.5f, 2.5f}) {
        const double full = passing_share(angle);
        EXPECT_NEAR(ajar_runtime_door_openness(angle, half_turn), full, 0.01) << angle;
        EXPECT_FLOAT_EQ(ajar_runtime_door_openness(-angle, half_turn), ajar_runtime_door_openness(angle, half_turn));
        EXPECT_FLOAT_EQ(ajar_runtime_door_openness(angle, angle), 1.0f);
        EXPECT_FLOAT_EQ(ajar_runtime_door_openness(2.0f * angle, -angle), 1.0f);
    }
    EXPECT_EQ(ajar_runtime_door_openness(0.0f, 1.5f), 0.0f);
    EXPECT_EQ(ajar_runtime_door_openness(1.0f, 0.0f), 0.0f);
    EXPECT_EQ(ajar_runtime_door_openness(NAN, 1.5f), 0.0f);
    EXPECT_EQ(ajar_runtime_door_openness(1.0f, NAN), 0.0f);
}

} // namespace
