// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "transport/gather.h"

namespace bench {

using namespace ajar;

/// A scene with everything that a bake prepares before its first ray, built by all threads.
class BenchScene {
public:
    BenchScene(std::string name, std::shared_ptr<const Snapshot> snapshot);

    /// For benchmark names.
    const std::string& name() const { return name_; }
    const Snapshot& snapshot() const { return *snapshot_; }
    std::shared_ptr<const Snapshot> shared() const { return snapshot_; }
    const Tracer& tracer() const { return tracer_; }
    const Coverage& coverage() const { return coverage_; }
    const LightmapReceivers& receivers() const { return receivers_; }
    const EmitterSet& emitters() const { return emitters_; }
    GatherScene gather() const { return {*snapshot_, tracer_, surfaces_, emitters_, receivers_, progress_}; }
    /// Stand-in for baked light: every surface sends its albedo.
    const Vec4* radiance() const { return radiance_.data(); }
    /// count tiles spread evenly over all of them, or all if there are fewer.
    std::vector<Tile> spread_tiles(size_t count) const;

private:
    std::string name_;
    std::shared_ptr<const Snapshot> snapshot_;
    ThreadPool pool_{0};
    Progress progress_;
    Tracer tracer_;
    Coverage coverage_;
    LightmapReceivers receivers_;
    SurfaceTable surfaces_;
    EmitterSet emitters_;
    std::vector<Vec4> radiance_;
};

} // namespace bench
