# SPDX-License-Identifier: GPL-3.0-or-later
# timeout: 900
"""Stored packages, read by the run-time library in several states, against Cycles on the same texels of small scenes.

    python3 tests/blender/run.py --addon build/ajar_addon.zip --work /tmp/ajar bl_bake_cycles

Texels at borders of charts and on edges of light are left out. Beginnings of names behind `--` run those cases alone;
without them, the long ones are left out.
"""
import argparse
import os
import sys
import tempfile
import time
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from support import bake_cases  # noqa: E402
from support.addon import load_addon  # noqa: E402

load_addon()
from ajar.accuracy.bakes import LUMINANCE  # noqa: E402
from ajar.bridge.client import WorkerClient  # noqa: E402
from ajar.bridge.runtime import Runtime  # noqa: E402
from ajar.bridge.snapshot_io import Reader  # noqa: E402
from support.cycles_texels import CyclesTexels, empty_file, export  # noqa: E402

FOLDER = os.environ.get("AJAR_TEST_DIR") or tempfile.mkdtemp(prefix="ajar-test-")
WISHES = {"preset": "PRODUCTION", "bounces": 24}


def bake(folder):
    """Package of a snapshot."""
    package = os.path.join(folder, "package")
    worker = WorkerClient.bake(folder, package, os.path.join(folder, "report.json"))
    try:
        for _ in worker.events():
            pass
        assert worker.outcome["event"] == "done", worker.outcome
    finally:
        worker.close()
    return package


def luminance(light, page):
    """Irradiance of a page as the run time has it, bottom row first."""
    width, height = light.page_size(page)
    values = np.frombuffer(light.page_irradiance(page, 3), np.float32)
    return values.reshape(height, width, 3).astype(float) @ LUMINANCE


def judge(own, light, error, usable, bound):
    """(passed, text) of one state."""
    pick = lambda pages: np.concatenate([p[u] for p, u in zip(pages, usable)])  # noqa: E731
    own, cycles, error = pick(own), pick(light), pick(error)
    ratio, noise = own.sum() / cycles.sum(), np.sqrt((error**2).sum()) / cycles.sum()
    level = cycles.mean()
    rms = np.sqrt(np.mean((own - cycles) ** 2)) / level
    passed = len(own) >= 50 and abs(ratio - 1.0) < bound + 4.0 * noise
    return passed, (
        f"texels {len(own):4}  ratio {ratio:.4f} +- {noise:.4f}  rms {rms:.4f}  noise of Cycles"
        f" {np.sqrt(np.mean(error**2)) / level:.4f}"
    )


def in_room(texel_map):
    """Texels that do not lie outside of the room: what its walls' outer faces get is no test."""
    low, high = np.array(bake_cases.ROOM) + [[-1e-3], [1e-3]]
    return ((texel_map.position >= low) & (texel_map.position <= high)).all(-1)


def run_case(case):
    """Names of the states that failed."""
    begin = time.monotonic()
    empty_file()
    states = case.build()
    bpy.context.view_layer.update()
    folder = os.path.join(FOLDER, case.name.replace(" ", "_"))
    export(folder, {**WISHES, "texels_per_meter": case.texels_per_meter})
    package = bake(folder)
    with Reader(Path(folder), "snapshot") as reader:
        scene = CyclesTexels(reader.data)
    print(f"     {case.name}: {time.monotonic() - begin:.1f} s", flush=True)
    bad = []
    with Runtime(package) as light:
        for state in states:
            for name, weight in state.weights.items():
                light.set_weight(name, weight)
            light.update()
            own = [luminance(light, page) for page in range(light.page_count())]
            for obj in state.hidden:
                obj.hide_render = True
            options = argparse.Namespace(samples=case.samples, repeats=8, seed=1, threads=0)
            cycles, error, usable = scene.bake(options, WISHES["bounces"])
            usable = [u & in_room(m) for u, m in zip(usable, scene.maps)]
            passed, text = judge(own, cycles, error, usable, state.bound)
            print(f"{'ok  ' if passed else 'FAIL'} {case.name:16} {state.name:8} {text}", flush=True)
            bad += [] if passed else [f"{case.name}, {state.name}"]
            for name in state.weights:
                light.set_weight(name, 1.0)
            for obj in state.hidden:
                obj.hide_render = False
    return bad


def main():
    """Runs all cases; fails at the end if one is off."""
    wanted = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(FOLDER, "scenes.blend"), check_existing=False)
    named = lambda case: any(case.name.startswith(w) for w in wanted)  # noqa: E731
    cases = [case for case in bake_cases.CASES if (named(case) if wanted else not case.is_long)]
    bad = [name for case in cases for name in run_case(case)]
    assert not bad, f"baked light is not that of Cycles: {'; '.join(bad)}"
    print(f"bl_bake_cycles: ok, {len(cases)} scenes")


main()
