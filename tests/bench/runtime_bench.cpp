// SPDX-License-Identifier: GPL-3.0-or-later
// What changes of weights cost a game: ajar_runtime_bench PACKAGE NAME [Google Benchmark's flags];
// or, by the number of terms at a texel: ajar_runtime_bench overlap [flags].
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "ajar_runtime.h"
#include "overlap_bench.h"

namespace {

constexpr size_t kTexelBytes = 8;

struct Element {
    uint32_t index;
    uint64_t texels;
};

/// Light sets by the texels that a change of each updates, fewest first.
std::vector<Element> light_sets(ajar_runtime runtime) {
    uint32_t count = 0;
    ajar_runtime_element_count(runtime, &count);
    std::vector<Element> sets;
    for (uint32_t e = 0; e < count; ++e) {
        ajar_runtime_element element;
        ajar_runtime_element_init(&element);
        ajar_runtime_get_element(runtime, e, &element);
        if (element.kind == AJAR_RUNTIME_LIGHT_SET && element.texels > 0) sets.push_back({e, element.texels});
    }
    std::sort(sets.begin(), sets.end(), [](const Element& a, const Element& b) { return a.texels < b.texels; });
    return sets;
}

/// Changes the weights of all given sets and updates, over and over.
void change(benchmark::State& state, ajar_runtime runtime, const std::vector<Element>& sets) {
    float weight = 0.25f;
    ajar_runtime_stats stats;
    ajar_runtime_stats_init(&stats);
    uint64_t texels = 0;
    for (auto _ : state) {
        weight = 1.25f - weight;
        for (const Element& s : sets) ajar_runtime_set_weight(runtime, s.index, weight);
        if (ajar_runtime_update(runtime, &stats) != AJAR_RUNTIME_OK)
            return state.SkipWithError(ajar_runtime_error_message());
        texels += stats.texels;
    }
    state.SetItemsProcessed(static_cast<int64_t>(texels));
}

/// What copying as many texels costs, to hold the update against.
void copy(benchmark::State& state, uint64_t texels) {
    std::vector<char> from(texels * kTexelBytes, 1), to(texels * kTexelBytes);
    for (auto _ : state) {
        std::memcpy(to.data(), from.data(), to.size());
        benchmark::DoNotOptimize(to.data());
        benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(texels));
}

void open(benchmark::State& state, const char* package) {
    for (auto _ : state) {
        ajar_runtime runtime = nullptr;
        if (ajar_runtime_open(package, &runtime) != AJAR_RUNTIME_OK)
            return state.SkipWithError(ajar_runtime_error_message());
        ajar_runtime_release(&runtime);
    }
    state.SetItemsProcessed(state.iterations());
}

template <class Run>
void add(const std::string& name, Run run) {
    benchmark::RegisterBenchmark(name.c_str(), run)->Unit(benchmark::kMillisecond);
}

} // namespace

int main(int argc, char** argv) {
    if (argc >= 2 && std::strcmp(argv[1], "overlap") == 0) {
        add_overlap_benches();
        int count = argc - 1;
        benchmark::Initialize(&count, argv + 1);
        benchmark::RunSpecifiedBenchmarks();
        return 0;
    }
    ajar_runtime runtime = nullptr;
    if (argc < 3 || ajar_runtime_open(argv[1], &runtime) != AJAR_RUNTIME_OK) {
        std::fprintf(stderr, "usage: %s PACKAGE NAME [flags]: %s\n", argv[0], ajar_runtime_error_message());
        return 1;
    }
    const char* package = argv[1];
    const std::string suite = std::string("runtime/") + argv[2] + "/";
    const std::vector<Element> sets = light_sets(runtime);
    add(suite + "open", [=](benchmark::State& state) { open(state, package); });
    if (!sets.empty()) {
        const Element median = sets[sets.size() / 2], largest = sets.back();
        add(suite + "median_set", [=](benchmark::State& state) { change(state, runtime, {median}); });
        add(suite + "largest_set", [=](benchmark::State& state) { change(state, runtime, {largest}); });
        add(suite + "all_sets", [=](benchmark::State& state) { change(state, runtime, sets); });
        add(suite + "memcpy_of_largest", [=](benchmark::State& state) { copy(state, largest.texels); });
    }
    int count = argc - 2;
    benchmark::Initialize(&count, argv + 2);
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    ajar_runtime_release(&runtime);
    return 0;
}
