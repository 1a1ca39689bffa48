// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench_scene.h"

namespace bench {

namespace {

constexpr uint32_t kPositions = 4;

LightmapReceivers receivers_of(const Snapshot& scene, const Tracer& tracer, const Coverage& coverage, ThreadPool& pool,
                               Progress& progress) {
    std::vector<Warning> ignored;
    return make_receivers(scene, tracer, coverage, find_solids(scene, tracer), kPositions, pool, progress, ignored);
}

} // namespace

BenchScene::BenchScene(std::string name, std::shared_ptr<const Snapshot> snapshot)
    : name_(std::move(name)),
      snapshot_(std::move(snapshot)),
      tracer_(*snapshot_),
      coverage_(rasterize(*snapshot_, pool_, progress_)),
      receivers_(receivers_of(*snapshot_, tracer_, coverage_, pool_, progress_)),
      surfaces_(*snapshot_, find_solids(*snapshot_, tracer_)),
      emitters_(*snapshot_, pool_, progress_),
      radiance_(snapshot_->texel_count(), Vec4(0.0f)) {
    for (uint32_t r = 0; r < receivers_.count(); ++r)
        radiance_[receivers_.texel[r]] = Vec4(receivers_.albedo[r], receivers_.cut[r] != 0 ? float{kTexelCut} : 0.0f);
}

std::vector<Tile> BenchScene::spread_tiles(size_t count) const {
    const size_t all = receivers_.tiles.size();
    count = std::min(count, all);
    std::vector<Tile> tiles;
    for (size_t i = 0; i < count; ++i) tiles.push_back(receivers_.tiles[i * all / count]);
    return tiles;
}

} // namespace bench
