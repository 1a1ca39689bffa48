// SPDX-License-Identifier: GPL-3.0-or-later
// gather/<scene>/<pass>: rays per second of gather_tile against Embree alone on the same rays. Each
// tile is gathered and replayed in turn, so a machine that changes its speed changes both.
#include <bit>
#include <ctime>

#include "base/hash.h"
#include "bench_suites.h"
#include "embree_recorder.h"

namespace bench {

namespace {

constexpr size_t kTiles = 48;
constexpr uint32_t kSeed = 1, kDirectSamples = 64;

/// What a gather of the bake asks for.
struct GatherPass {
    const char* name;
    uint32_t samples;
    float share;
    bool emission;
};
constexpr GatherPass kPasses[] = {{"final", 256, 0.5f, true}, {"bounce", 16, 1.0f, false}};

double thread_seconds() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// One tile, ready to be gathered as a bake would, and the rays that this takes.
struct Work {
    Tile tile;
    DirectGroups direct;
    EmbreeRecorder rays;
};

class GatherBench {
public:
    GatherBench(const BenchScene& scene, const GatherPass& pass)
        : scene_(scene), pass_(pass), sums_(std::make_unique<TileSums>()) {
        for (const Tile& tile : scene.spread_tiles(kTiles)) prepare(tile);
    }
    void run(benchmark::State& state);

private:
    void prepare(const Tile& tile);
    void gather(const Work& work);
    void digest(float value) { digest_ = hash_combine(digest_, std::bit_cast<uint32_t>(value)); }
    /// Processor seconds of a call: time that other programs take does not count.
    template <class Call>
    static double time(Call&& call) {
        const double begin = thread_seconds();
        call();
        return thread_seconds() - begin;
    }

    const BenchScene& scene_;
    const GatherPass& pass_;
    std::unique_ptr<TileSums> sums_;
    std::vector<Work> works_;
    bool replay_first_ = false;
    uint32_t digest_ = 0; ///< of all results: tells whether two builds compute the same
};

void GatherBench::prepare(const Tile& tile) {
    Work& work = works_.emplace_back(Work{tile, {scene_.emitters(), LightRoles::stored, {}}, {}});
    work.direct.begin(scene_.tracer(), scene_.receivers(), tile, kDirectSamples, kDirectSamples, kSeed);
    work.rays.start();
    gather(work);
    work.rays.stop();
    for (uint32_t lane = 0; lane < tile.count; ++lane) {
        for (const auto& channel : sums_->irradiance) digest(channel[lane]);
        for (const auto& coefficient : sums_->sh) digest(coefficient[lane]);
        digest(sums_->pairs[lane]);
    }
}

void GatherBench::gather(const Work& work) {
    GatherOptions o;
    o.samples = pass_.samples;
    o.share = pass_.share;
    o.emission = pass_.emission;
    o.unmapped_direct = true;
    o.direct = pass_.emission ? &work.direct : nullptr;
    o.seed = kSeed;
    sums_->clear(false);
    benchmark::DoNotOptimize(gather_tile(scene_.gather(), work.tile, o, scene_.radiance(), *sums_));
}

void GatherBench::run(benchmark::State& state) {
    double gather_seconds = 0.0, embree_seconds = 0.0;
    uint64_t rays = 0, packet_rays = 0;
    for (auto _ : state) {
        double here = 0.0;
        for (const Work& work : works_) {
            RayCount seen;
            const auto replay = [&] { embree_seconds += time([&] { seen = work.rays.replay(); }); };
            if (replay_first_) replay();
            here += time([&] { gather(work); });
            if (!replay_first_) replay();
            replay_first_ = !replay_first_;
            const RayCount recorded = work.rays.recorded();
            if (seen.rays == 0 || seen.hits != recorded.hits)
                return state.SkipWithError("the replay does not meet what the gather met");
            rays += recorded.rays;
            packet_rays += uint64_t{work.tile.count} * pass_.samples;
        }
        state.SetIterationTime(here);
        gather_seconds += here;
    }
    state.counters["rays_per_second"] = static_cast<double>(rays) / gather_seconds;
    state.counters["embree_rays_per_second"] = static_cast<double>(rays) / embree_seconds;
    state.counters["digest"] = digest_;
    state.counters["ratio"] = embree_seconds / gather_seconds;
    state.counters["further_rays"] = static_cast<double>(rays) / static_cast<double>(packet_rays) - 1.0;
}

} // namespace

void add_gather(const BenchScene& scene) {
    for (const GatherPass& pass : kPasses) {
        const std::string name = "gather/" + scene.name() + "/" + pass.name;
        const auto run = [&scene, &pass, bench = std::shared_ptr<GatherBench>()](benchmark::State& state) mutable {
            if (!bench) bench = std::make_shared<GatherBench>(scene, pass);
            bench->run(state);
        };
        benchmark::RegisterBenchmark(name.c_str(), run)->UseManualTime()->Unit(benchmark::kMillisecond);
    }
}

} // namespace bench
