// SPDX-License-Identifier: GPL-3.0-or-later
// What surrounds the gather, one benchmark a stage; items per second are what each name says.
#include <numeric>
#include <random>

#include "api/job.h"
#include "bench_suites.h"
#include "encode/ahd.h"
#include "post/stitch.h"
#include "sampling/warp.h"

namespace bench {

namespace {

constexpr uint32_t kSeed = 1, kPositions = 4;

std::string name_of(const char* suite, const BenchScene& scene, const char* what) {
    return std::string(suite) + "/" + scene.name() + "/" + what;
}

void count_items(benchmark::State& state, size_t per_iteration) {
    state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(per_iteration));
}

/// Light of a few random directions over the hemisphere, as a gather would sum it.
struct Texel {
    Vec3 irradiance{0.0f};
    float sh[kShCount] = {};
};

std::vector<Texel> random_texels(size_t count) {
    std::mt19937 random(kSeed);
    const auto uniform = [&] { return static_cast<float>(random() >> 8) * 0x1p-24f; };
    std::vector<Texel> texels(count);
    for (Texel& t : texels)
        for (int light = 0; light < 4; ++light) {
            const Vec3 w = sample_hemisphere({uniform(), uniform()}, 0.5f),
                       facing = Vec3(uniform(), uniform(), uniform());
            float y[kShCount];
            sh_basis(w.x, w.y, w.z, y);
            t.irradiance += facing * w.z;
            for (int i = 0; i < kShCount; ++i) t.sh[i] += y[i] * luminance(facing);
        }
    return texels;
}

void build_receivers(benchmark::State& state, const BenchScene& scene) {
    ThreadPool pool(1);
    Progress progress;
    std::vector<Warning> warnings;
    const std::vector<Behind> behind = find_solids(scene.snapshot(), scene.tracer());
    for (auto _ : state)
        benchmark::DoNotOptimize(make_receivers(scene.snapshot(), scene.tracer(), scene.coverage(), behind, kPositions,
                                                pool, progress, warnings));
    count_items(state, scene.receivers().count());
}

void cover_texels(benchmark::State& state, const BenchScene& scene) {
    ThreadPool pool(1);
    Progress progress;
    for (auto _ : state) benchmark::DoNotOptimize(rasterize(scene.snapshot(), pool, progress));
    count_items(state, scene.receivers().count());
}

void prepare_choice(benchmark::State& state, const BenchScene& scene) {
    const std::vector<Tile> tiles = scene.spread_tiles(64);
    LightChoice choice(scene.emitters(), LightRoles::stored, scene.emitters().of_set(kNoElement));
    for (auto _ : state)
        for (const Tile& tile : tiles)
            benchmark::DoNotOptimize(choice.begin(scene.tracer(), scene.receivers(), tile, kSeed));
    count_items(state, tiles.size());
}

void pick_emitters(benchmark::State& state, const BenchScene& scene) {
    constexpr uint32_t kPicks = 64;
    const Tile tile = scene.spread_tiles(1).front();
    LightChoice choice(scene.emitters(), LightRoles::stored, scene.emitters().of_set(kNoElement));
    choice.begin(scene.tracer(), scene.receivers(), tile, kSeed);
    if (choice.empty()) return state.SkipWithError("no emitter lights this scene");
    for (auto _ : state)
        for (uint32_t local = 0; local < tile.count; ++local)
            for (uint32_t k = 0; k < kPicks; ++k) {
                float u = (static_cast<float>(k) + 0.5f) / kPicks, chance = 0.0f;
                benchmark::DoNotOptimize(choice.pick(local, u, chance));
            }
    count_items(state, size_t{tile.count} * kPicks);
}

void stitch(benchmark::State& state, const BenchScene& scene, const std::vector<SeamPoint>& seams) {
    const size_t texels = scene.snapshot().texel_count();
    std::vector<uint8_t> usable(texels, 0);
    std::vector<Vec3> start(texels, Vec3(0.0f));
    std::mt19937 random(kSeed);
    for (const uint32_t t : scene.receivers().texel)
        usable[t] = 1, start[t] = Vec3(static_cast<float>(random() >> 8) * 0x1p-24f);
    for (auto _ : state) {
        std::vector<Vec3> value = start;
        benchmark::DoNotOptimize(stitch_seams(seams, usable, value));
    }
    count_items(state, seams.size());
}

void bake(benchmark::State& state, const BenchScene& scene, uint32_t threads) {
    ajar_settings settings;
    ajar_settings_init(&settings);
    settings.threads = threads;
    settings.noise_target = 0.1f;
    uint64_t rays = 0;
    for (auto _ : state) {
        Job job(scene.shared(), settings);
        if (job.task().wait(-1.0) != AJAR_OK) return state.SkipWithError(job.task().failure().text.c_str());
        ajar_progress progress;
        job.task().poll(progress);
        rays += progress.rays;
    }
    state.counters["rays_per_second"] = benchmark::Counter(static_cast<double>(rays), benchmark::Counter::kIsRate);
    state.counters["texels"] = static_cast<double>(scene.receivers().count());
}

template <class Run>
benchmark::internal::Benchmark* add(const std::string& name, Run run) {
    return benchmark::RegisterBenchmark(name.c_str(), run)->Unit(benchmark::kMillisecond);
}

} // namespace

void add_receivers(const BenchScene& scene) {
    add(name_of("receivers", scene, "cover_texels"), [&scene](benchmark::State& state) { cover_texels(state, scene); });
    add(name_of("receivers", scene, "build_texels"),
        [&scene](benchmark::State& state) { build_receivers(state, scene); });
}

void add_emitters(const BenchScene& scene) {
    add(name_of("emitters", scene, "prepare_tiles"),
        [&scene](benchmark::State& state) { prepare_choice(state, scene); });
    add(name_of("emitters", scene, "picks"), [&scene](benchmark::State& state) { pick_emitters(state, scene); });
}

void add_stitch(const BenchScene& scene) {
    add(name_of("seams", scene, "find_points"), [&scene](benchmark::State& state) {
        size_t count = 0;
        for (auto _ : state) count = find_seams(scene.snapshot()).size();
        count_items(state, count);
    });
    add(name_of("seams", scene, "stitch_points"),
        [&scene, seams = std::vector<SeamPoint>()](benchmark::State& state) mutable {
            if (seams.empty()) seams = find_seams(scene.snapshot());
            stitch(state, scene, seams);
        });
}

void add_bake(const BenchScene& scene, uint32_t threads) {
    add(name_of("bake", scene, "noise_10_percent"),
        [&scene, threads](benchmark::State& state) { bake(state, scene, threads); })
        ->UseRealTime()
        ->MeasureProcessCPUTime();
}

void add_encode() {
    add("encode/ahd/texels", [texels = random_texels(4096)](benchmark::State& state) {
        for (auto _ : state)
            for (const Texel& t : texels) {
                const Ahd ahd = fit_ahd(t.irradiance, t.sh);
                benchmark::DoNotOptimize(pack_r11g11b10f(ahd.irradiance) ^ pack_direction(ahd));
            }
        count_items(state, texels.size());
    });
}

} // namespace bench
