# SPDX-License-Identifier: GPL-3.0-or-later
# timeout: 600
"""Direct light of every light type and size on planes: the add-on's bake against Cycles' bake of the
same texels, as a table of ratios. `light_units.py` does the same with many more samples.

    python3 tests/blender/run.py --addon build/ajar_addon.zip --work /tmp/ajar bl_light_units
"""
import argparse
import json
import os
import sys
import tempfile
import time

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import compare_bake  # noqa: E402
import cycles_bake  # noqa: E402
import light_units  # noqa: E402
from support import light_cases, light_table, merge  # noqa: E402
from support.addon import load_addon  # noqa: E402

load_addon()
from ajar import job  # noqa: E402

FOLDER = os.environ.get("AJAR_TEST_DIR") or tempfile.mkdtemp(prefix="ajar-test-")
LIMIT = 0.005  # relative difference of means
SETTINGS = {
    "preset": "REFERENCE",
    "texels_per_meter": light_units.DENSITY,
    "bounces": 0,
    "samples": 1024,
    "direct_samples": 1024,
}
CYCLES = argparse.Namespace(samples=256, repeats=4, seed=1, threads=0)


def empty_file():
    """Removes what a case made; the add-on stays."""
    for kind in ("objects", "meshes", "lights", "materials", "images", "worlds"):
        collection = getattr(bpy.data, kind)
        bpy.data.batch_remove(
            [item for item in collection if item.name not in ("Render Result", "Viewer Node")]
        )


def bake(package):
    """Bakes the open scene."""
    task = job.Job(
        "Bake",
        bpy.context,
        job.bake_steps,
        package=package,
        report=package + ".json",
        overrides=SETTINGS,
        show=False,
    )
    job.manager.start(task)
    while job.manager.step():
        time.sleep(0.005)
    assert task.status.result == "done", task.status.message


def bake_reference(package):
    """What Cycles bakes to the same texels, as cycles_bake.py saves it."""
    with open(os.path.join(package, "manifest.json"), encoding="utf-8") as file:
        manifest = json.load(file)
    pieces = merge.read_pieces(manifest["instances"])
    maps, objects, names = cycles_bake.map_texels(pieces, manifest["pages"])
    materials = cycles_bake.BakeMaterials(manifest["pages"])
    merged = cycles_bake.merge_receivers(pieces, materials)
    total = cycles_bake.bake_repeats(merged, materials, CYCLES, 0, ("DIRECT", "INDIRECT"))
    path = package + ".npz"
    cycles_bake.save(path, manifest["pages"], total, None, maps, {"objects": objects, "materials": names})
    return path


def run_case(name):
    """(passed, text) of one case."""
    empty_file()
    light_cases.fill_case(name)
    package = os.path.join(FOLDER, name)
    bake(package)
    pages, _ = compare_bake.load(package, bake_reference(package))
    # Within a texel at the rim of a soft spot the light curves by as much as the limit.
    return light_units.judge(light_units.quiet_texels(pages), LIMIT, outside=0.02)


def main():
    """Runs all cases; fails at the end if one is off."""
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(FOLDER, "lights.blend"), check_existing=False)
    rows = [(name, *run_case(name)) for name in light_table.CASES]
    for name, passed, text in rows:
        print(f"{'ok  ' if passed else 'FAIL'} {name:20} {text}")
    bad = [name for name, passed, _ in rows if not passed]
    assert not bad, f"not the light that Cycles bakes: {', '.join(bad)}"
    print(f"bl_light_units: ok, {len(rows)} cases")


main()
