// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench_run.h"

int main(int argc, char** argv) { return ajar_bench_run(argc, argv, nullptr, nullptr); }
