// SPDX-License-Identifier: GPL-3.0-or-later
#include "overlap_bench.h"

#include <benchmark/benchmark.h>

#include <memory>
#include <string>

#include "runtime_kit.h"

namespace {

constexpr uint32_t kSize = 128; ///< edge of the page

/// A page of texels with `overlap` terms each. mixed: lists that differ, a fifth of a block's terms not at each texel.
void fill(kit::TermScene& scene, uint32_t overlap, bool mixed) {
    scene.add_page(kSize, kSize);
    const uint32_t sets = mixed ? overlap + (overlap + 3) / 4 : overlap;
    std::vector<std::vector<uint32_t>> texels_of(sets);
    std::vector<uint32_t> order = kit::texel_range(0, sets);
    for (uint32_t texel = 0; texel < kSize * kSize; ++texel) {
        if (mixed) std::shuffle(order.begin(), order.end(), scene.random());
        for (uint32_t i = 0; i < overlap; ++i) texels_of[order[i]].push_back(texel);
    }
    for (uint32_t t = 0; t < sets; ++t)
        scene.add_term({scene.add_element("set", "light_set")}, std::move(texels_of[t]));
}

struct Opened {
    explicit Opened(const kit::TermScene& scene) : folder(scene), runtime(folder.path()) {}
    kit::PackageFolder folder;
    kit::Runtime runtime;
};

/// Updates with all sets on, or with one and the others off. Items are receivers.
void update(benchmark::State& state, kit::Runtime& runtime, bool all) {
    runtime.set_all(all ? 1.0f : 0.0f);
    float weight = 0.25f;
    uint64_t texels = 0;
    for (auto _ : state) {
        runtime.set_weight(0, weight = 1.25f - weight);
        texels += runtime.update().texels;
    }
    state.SetItemsProcessed(static_cast<int64_t>(texels));
}

} // namespace

void add_overlap_benches() {
    for (const bool mixed : {false, true})
        for (const uint32_t overlap : {1u, 4u, 8u, 16u, 24u, 40u, 100u, 300u}) {
            kit::TermScene scene;
            fill(scene, overlap, mixed);
            const auto opened = std::make_shared<Opened>(scene);
            for (const bool all : {true, false}) {
                const std::string name = std::string("overlap/") + (mixed ? "mixed" : "same") +
                                         (all ? "/all_on/" : "/one_on/") + std::to_string(overlap);
                benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
                    update(state, opened->runtime, all);
                })->Unit(benchmark::kMillisecond);
            }
        }
}
