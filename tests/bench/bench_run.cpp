// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench_run.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "api/tables.h"
#include "bench_room.h"
#include "bench_suites.h"

namespace bench {

namespace {

constexpr int kLamps = 12, kManyLamps = 500;

std::shared_ptr<const Snapshot> room(int lamps) {
    kit::Scene scene("room");
    fill_room(scene, lamps);
    return scenes().get(scene.handle())->snapshot();
}

/// Takes --threads=N out of the arguments; 0 if it is not there.
uint32_t take_threads(int& argc, char** argv) {
    uint32_t threads = 0;
    int kept = 0;
    for (int i = 0; i < argc; ++i) {
        if (std::strncmp(argv[i], "--threads=", 10) == 0)
            threads = static_cast<uint32_t>(std::strtoul(argv[i] + 10, nullptr, 10));
        else
            argv[kept++] = argv[i];
    }
    argc = kept;
    return threads;
}

void add_scene(const BenchScene& scene, uint32_t threads) {
    add_gather(scene);
    add_receivers(scene);
    add_emitters(scene);
    add_stitch(scene);
    add_bake(scene, threads);
}

int run(int argc, char** argv, ajar_scene level, const char* name) {
    const uint32_t threads = take_threads(argc, argv);
    std::vector<std::unique_ptr<BenchScene>> built;
    if (level != nullptr) {
        add_scene(*built.emplace_back(std::make_unique<BenchScene>(name, scenes().get(level)->snapshot())), threads);
    } else {
        add_scene(*built.emplace_back(std::make_unique<BenchScene>("room", room(kLamps))), threads);
        add_emitters(*built.emplace_back(
            std::make_unique<BenchScene>("room_" + std::to_string(kManyLamps) + "_lamps", room(kManyLamps))));
        add_encode();
        add_doors();
    }
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
}

} // namespace

} // namespace bench

int ajar_bench_run(int argc, char** argv, ajar_scene level, const char* name) {
    try {
        return bench::run(argc, argv, level, name);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "ajar_bench: %s\n", e.what());
        return 1;
    }
}
