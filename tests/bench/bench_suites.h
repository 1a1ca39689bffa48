// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <benchmark/benchmark.h>

#include "bench_scene.h"

namespace bench {

/// Each registers its suite for one scene; the scene must outlive the run.
void add_gather(const BenchScene& scene);
void add_receivers(const BenchScene& scene);
void add_emitters(const BenchScene& scene);
void add_stitch(const BenchScene& scene);
/// Whole bakes with all stages but writing files; threads 0 for all.
void add_bake(const BenchScene& scene, uint32_t threads);
void add_encode();
/// A small door far from the receivers, with rays aimed at it and without.
void add_doors();

} // namespace bench
