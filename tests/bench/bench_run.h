// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ajar/ajar.h"

/// Runs the benchmarks that the command line of Google Benchmark selects, on the built-in room and,
/// where level is not null, on that committed scene too; name stands for it in `suite/case/size`.
/// Own flag: --threads=N for whole bakes, 0 for all. Returns the exit code.
extern "C" AJAR_API int ajar_bench_run(int argc, char** argv, ajar_scene level, const char* name);
