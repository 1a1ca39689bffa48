// SPDX-License-Identifier: GPL-3.0-or-later
// The compute shader of the run-time against its C++: the same words in every page.
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>

#include "compute_kit.h"
#include "runtime_kit.h"

namespace {

enum Binding : uint32_t { kDispatches, kPalette, kData, kGroups, kWeights, kPages, kIrradiance, kDirection };

std::string shader_source() {
    std::ifstream file(AJAR_TERMS_SHADER);
    std::stringstream text;
    text << file.rdbuf();
    // The licence line comes first, and #version must.
    return text.str().substr(text.str().find("#version"));
}

/// A package whose pages live in buffers of a graphics card.
class ShaderRuntime {
public:
    ShaderRuntime(kit::ComputeContext& gpu, const std::string& package) : gpu_(gpu), runtime_(package) {
        gpu_.use(shader_source());
        ajar_runtime_buffers b;
        ajar_runtime_buffers_init(&b);
        EXPECT_EQ(ajar_runtime_get_buffers(runtime_.handle(), &b), AJAR_RUNTIME_OK);
        gpu_.fill(kDispatches, b.dispatches, 16 * size_t{b.dispatch_count});
        gpu_.fill(kPalette, b.palette, b.palette_words);
        gpu_.fill(kData, b.data, b.data_words);
        terms_ = b.term_count;
        upload_pages();
    }
    kit::Runtime& weights() { return runtime_; }
    ajar_runtime_stats update() {
        ajar_runtime_work work;
        ajar_runtime_work_init(&work);
        EXPECT_EQ(ajar_runtime_plan_update(runtime_.handle(), &work), AJAR_RUNTIME_OK);
        gpu_.fill(kGroups, work.groups, 2 * size_t{work.group_count});
        gpu_.fill(kWeights, reinterpret_cast<const uint32_t*>(work.term_weights), 4 * size_t{terms_});
        gpu_.dispatch(work.group_count);
        return work.stats;
    }
    /// Words of all pages, one after the other.
    kit::PageWords words() const { return {gpu_.read(kIrradiance), gpu_.read(kDirection)}; }

private:
    void upload_pages() {
        std::vector<uint32_t> places;
        kit::PageWords all;
        uint32_t count = 0;
        EXPECT_EQ(ajar_runtime_page_count(runtime_.handle(), &count), AJAR_RUNTIME_OK);
        for (uint32_t i = 0; i < count; ++i) {
            uint32_t width = 0, height = 0;
            EXPECT_EQ(ajar_runtime_page_size(runtime_.handle(), i, &width, &height), AJAR_RUNTIME_OK);
            places.insert(places.end(), {static_cast<uint32_t>(all.irradiance.size()), width});
            const kit::PageWords page = runtime_.page(i);
            all.irradiance.insert(all.irradiance.end(), page.irradiance.begin(), page.irradiance.end());
            all.direction.insert(all.direction.end(), page.direction.begin(), page.direction.end());
        }
        gpu_.fill(kPages, places.data(), places.size());
        gpu_.fill(kIrradiance, all.irradiance.data(), all.irradiance.size());
        gpu_.fill(kDirection, all.direction.data(), all.direction.size());
    }

    kit::ComputeContext& gpu_;
    kit::Runtime runtime_;
    uint32_t terms_ = 0;
};

kit::PageWords joined(const std::vector<kit::PageWords>& pages) {
    kit::PageWords all;
    for (const kit::PageWords& p : pages) {
        all.irradiance.insert(all.irradiance.end(), p.irradiance.begin(), p.irradiance.end());
        all.direction.insert(all.direction.end(), p.direction.begin(), p.direction.end());
    }
    return all;
}

size_t differing(const std::vector<uint32_t>& a, const std::vector<uint32_t>& b) {
    EXPECT_EQ(a.size(), b.size());
    size_t count = 0;
    for (size_t i = 0; i < std::min(a.size(), b.size()); ++i) count += a[i] != b[i];
    return count;
}

/// Changes weights and colours of some elements, in both alike.
void change_some(kit::TermScene& random, kit::Runtime& library, kit::Runtime& shader, uint32_t changes) {
    for (uint32_t change = 0; change < changes; ++change) {
        const uint32_t e = random.below(library.element_count());
        const bool is_set = library.element(e).kind == AJAR_RUNTIME_LIGHT_SET;
        const float weight = random.below(4) == 0 ? 0.0f : random.uniform(0.0f, is_set ? 3.0f : 1.0f);
        const float r = random.uniform(), g = random.uniform(), b = random.uniform();
        for (kit::Runtime* runtime : {&library, &shader}) {
            runtime->set_weight(e, weight);
            if (is_set) runtime->set_color(e, r, g, b);
        }
    }
}

void expect_the_words_of_the_library(void (*fill)(kit::TermScene&), int rounds) {
    kit::ComputeContext gpu;
    if (!gpu.ok()) {
        std::printf("SKIPPED: %s; install libgl1-mesa-dri\n", gpu.why().c_str());
        GTEST_SKIP() << gpu.why();
    }
    std::printf("driver: %s\n", gpu.renderer().c_str());
    kit::TermScene scene;
    fill(scene);
    const kit::PackageFolder folder(scene);
    ShaderRuntime shader(gpu, folder.path());
    kit::Runtime library(folder.path());
    for (int round = 0; round < rounds; ++round) {
        change_some(scene, library, shader.weights(), 1 + static_cast<uint32_t>(round) % 5);
        const ajar_runtime_stats expected = library.update(), stats = shader.update();
        EXPECT_EQ(stats.texels, expected.texels);
        const kit::PageWords words = shader.words(), truth = joined(library.pages());
        ASSERT_EQ(differing(words.irradiance, truth.irradiance), 0u) << "round " << round;
        ASSERT_EQ(differing(words.direction, truth.direction), 0u) << "round " << round;
    }
}

TEST(RuntimeShader, WritesTheWordsOfTheLibrary) { expect_the_words_of_the_library(kit::fill_everything, 40); }

TEST(RuntimeShader, WritesThemForHundredsOfTerms) { expect_the_words_of_the_library(kit::fill_hundreds, 10); }

} // namespace
