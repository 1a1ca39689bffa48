# SPDX-License-Identifier: GPL-3.0-or-later
# timeout: 600
"""The brute-force reference, which judges every bake, against Cycles on the same texels of small scenes.

    python3 tests/blender/run.py --addon build/ajar_addon.zip --work /tmp/ajar bl_reference_cycles

Both know the standard error of each texel, by the spread of independent batches. Texels at borders of charts are left
out: what part of them counts is a matter of definition; so are those that an edge of light crosses. Names of scenes behind `--` run those alone.
"""
import argparse
import ctypes
import os
import sys
import tempfile
import time

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from support import reference_cases  # noqa: E402
from support.addon import load_addon  # noqa: E402

load_addon()
from ajar.accuracy import engine  # noqa: E402
from ajar.accuracy.bakes import LUMINANCE  # noqa: E402
from ajar.bridge import abi  # noqa: E402
from ajar.bridge.library import check, load_library  # noqa: E402
from support.cycles_texels import CyclesTexels, empty_file, export, student_quantile  # noqa: E402

FOLDER = os.environ.get("AJAR_TEST_DIR") or tempfile.mkdtemp(prefix="ajar-test-")
DENSITY = 6.0  # texels per metre
BOUNCES = 24  # Ajar counts those off lightmaps, Cycles all: with so many the difference is nothing
POINTS, BATCHES = 260, 16  # of 64 paths
CYCLES = argparse.Namespace(samples=288, repeats=12, seed=1, threads=0)
FALSE_ALARM = 1e-3  # chance of one in a whole run
SAME_MEAN, SAME_TEXEL = (
    0.005,
    0.03,
)  # relative difference that is allowed beside the noise: curvature within texels
DARK = 0.02  # of the mean light: what texels are measured against at least


def trace(library, folder):
    """(points of the reference in the state that the file starts in, what the snapshot says)."""
    settings, handle, batches = abi.ReferenceSettings(), abi.Handle(), ctypes.c_uint32()
    library.ajar_reference_settings_init(ctypes.byref(settings))
    settings.points, settings.bounces, settings.batches = POINTS, BOUNCES, BATCHES
    settings.choice, settings.texel_mean = 1, 1
    with engine.snapshot_scene(library, folder) as (scene, data):
        check(library, library.ajar_reference_start(scene, ctypes.byref(settings), ctypes.byref(handle)))
    try:
        check(library, engine.wait(library, "reference", handle, engine.never))
        points = (abi.ReferencePoint * POINTS)()
        check(library, library.ajar_reference_read(handle, points, POINTS, ctypes.byref(batches)))
    finally:
        library.ajar_reference_release(ctypes.byref(handle))
    return np.array(np.ctypeslib.as_array(points)), data


def judge(points, light, error, usable, tests):
    """(passed, text) of one scene."""
    keep = np.array([usable[p["page"]][p["y"], p["x"]] for p in points], bool)
    points = points[keep]
    pick = lambda arrays: np.array([arrays[p["page"]][p["y"], p["x"]] for p in points])  # noqa: E731
    cycles, own = pick(light), points["irradiance"].astype(float) @ LUMINANCE
    deviation = np.hypot(pick(error), points["standard_error"])
    level = cycles.mean()
    ratio, noise = own.sum() / cycles.sum(), np.sqrt((deviation**2).sum()) / cycles.sum()
    # Of each error the other side's degrees of freedom are not less than its own.
    bound = student_quantile(1.0 - (1.0 - FALSE_ALARM) ** (1.0 / tests), CYCLES.repeats - 1)
    far = np.abs(own - cycles) - SAME_TEXEL * np.maximum(cycles, DARK * level) - bound * deviation
    worst = int(np.argmax(far))
    passed = len(points) >= 100 and abs(ratio - 1.0) < SAME_MEAN + 4.0 * noise and far.max() <= 0.0
    return passed, (
        f"texels {len(points):3}  ratio {ratio:.4f} +- {noise:.4f}  rms {np.sqrt(np.mean((own - cycles) ** 2)) / level:.4f}"
        f"  noise {np.sqrt(np.mean(deviation**2)) / level:.4f}  far {(far > 0).sum()}"
        f"  worst {own[worst]:.4g} for {cycles[worst]:.4g} +- {deviation[worst]:.2g}"
    )


def run_case(library, builder, tests):
    """(passed, text) of one scene."""
    begin = time.monotonic()
    empty_file()
    hidden, dimmed = builder() or ([], [])
    bpy.context.view_layer.update()
    folder = os.path.join(FOLDER, builder.__name__)
    export(folder, {"preset": "DRAFT", "texels_per_meter": DENSITY})
    points, data = trace(library, folder)
    for obj in hidden:
        obj.hide_render = True
    for lamp, weight in dimmed:
        lamp.energy *= weight
    passed, text = judge(points, *CyclesTexels(data).bake(CYCLES, BOUNCES), tests)
    return passed, f"{text}  {time.monotonic() - begin:.1f} s"


def main():
    """Runs all scenes; fails at the end if one is off."""
    wanted = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    cases = [c for c in reference_cases.CASES if not wanted or c.__name__ in wanted]
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(FOLDER, "scenes.blend"), check_existing=False)
    library = load_library()
    bad = []
    for case in cases:
        passed, text = run_case(library, case, POINTS * len(cases))
        print(f"{'ok  ' if passed else 'FAIL'} {case.__name__:10} {text}", flush=True)
        bad += [] if passed else [case.__name__]
    assert not bad, f"the reference is not Cycles: {', '.join(bad)}"
    print(f"bl_reference_cycles: ok, {len(cases)} scenes")


main()
