// SPDX-License-Identifier: GPL-3.0-or-later
// What aiming rays at doors gains: error and time of a bake with and without, one thread each.
#include "bench_suites.h"
#include "door_hall.h"

namespace bench {

namespace {

constexpr uint32_t kSamples = 256, kTruthSamples = 4096;

struct Measured {
    kit::DoorHall hall;
    std::vector<double> truth = hall.bake(kTruthSamples, 0.5f);
};

void bake(benchmark::State& state, float door_rays) {
    static const Measured measured;
    double squares = 0.0;
    for (auto _ : state) {
        const double error = kit::compare(measured.hall.bake(kSamples, door_rays), measured.truth).rms;
        squares += error * error;
    }
    state.SetItemsProcessed(state.iterations());
    state.counters["error"] = std::sqrt(squares / static_cast<double>(state.iterations()));
}

} // namespace

void add_doors() {
    for (const auto& [name, rays] : {std::pair("doors/far_door/guided", 0.25f), {"doors/far_door/unguided", 0.0f}})
        benchmark::RegisterBenchmark(name, [rays = rays](benchmark::State& state) {
            bake(state, rays);
        })->Unit(benchmark::kMillisecond);
}

} // namespace bench
