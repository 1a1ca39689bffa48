# SPDX-License-Identifier: GPL-3.0-or-later
"""Run the benchmarks on a saved snapshot (see save_snapshot.py), built through the add-on's own bridge.

    python3 tests/bench/bench_level.py LIBRARY SNAPSHOT NAME [flags of Google Benchmark]
"""
import ctypes
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from blender_addon.accuracy import engine  # noqa: E402


def main():
    path, folder, name, *flags = sys.argv[1:]
    library = engine.load_library(path)
    run = library.ajar_bench_run
    run.argtypes = [ctypes.c_int, ctypes.POINTER(ctypes.c_char_p), ctypes.c_void_p, ctypes.c_char_p]
    arguments = [b"ajar_bench", *(flag.encode() for flag in flags)]
    with engine.snapshot_scene(library, folder) as (scene, _):
        return run(
            len(arguments), (ctypes.c_char_p * (len(arguments) + 1))(*arguments, None), scene, name.encode()
        )


if __name__ == "__main__":
    sys.exit(main())
