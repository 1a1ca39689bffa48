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
import cycles_bake  # noqa: E402
from support import merge, reference_cases  # noqa: E402
from support.addon import load_addon  # noqa: E402

load_addon()
from ajar import job  # noqa: E402
from ajar.accuracy import engine  # noqa: E402
from ajar.accuracy.bakes import LUMINANCE  # noqa: E402
from ajar.bridge import abi  # noqa: E402
from ajar.bridge.library import check, load_library  # noqa: E402

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
MAX_STEP = 0.15  # between neighbours without an edge of light or shadow
DARK = 0.02  # of the mean light: what texels are measured against at least


def empty_file():
    """Removes what a case made; the add-on stays."""
    for kind in ("objects", "meshes", "lights", "materials", "images", "worlds", "collections"):
        collection = getattr(bpy.data, kind)
        kept = ("Render Result", "Viewer Node")
        bpy.data.batch_remove([item for item in collection if item.name not in kept])
    bpy.context.scene.ajar.light_sets.clear()


def export(folder):
    """Lays the open scene out and writes its snapshot."""

    def steps(task):
        wishes = {"preset": "DRAFT", "texels_per_meter": DENSITY}
        layout = yield from job.layout_steps(task, overrides=wishes)
        yield from job.snapshot_steps(task, folder, layout, wishes)

    task = job.Job("Export", bpy.context, steps)
    job.manager.start(task)
    while job.manager.step():
        time.sleep(0.005)
    assert task.status.result == "done", task.status.message


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


def blacken_backs():
    """Ajar takes the backs of culled materials for black; Cycles has to be told."""
    for material in [m for m in bpy.data.materials if m.use_nodes and m.use_backface_culling]:
        tree = material.node_tree
        output = tree.get_output_node('CYCLES')
        geometry, mix = tree.nodes.new('ShaderNodeNewGeometry'), tree.nodes.new('ShaderNodeMixShader')
        black = tree.nodes.new('ShaderNodeBsdfDiffuse')
        black.inputs['Color'].default_value = (0, 0, 0, 1)
        tree.links.new(geometry.outputs['Backfacing'], mix.inputs[0])
        tree.links.new(output.inputs['Surface'].links[0].from_socket, mix.inputs[1])
        tree.links.new(black.outputs[0], mix.inputs[2])
        tree.links.new(mix.outputs[0], output.inputs['Surface'])


def bake_cycles(data, hidden, dimmed):
    """(light, its standard error, whether a texel and its neighbours lie on one surface), per page."""
    for obj in hidden:
        obj.hide_render = True
    for lamp, weight in dimmed:
        lamp.energy *= weight
    blacken_backs()
    mapped = [i for i in data["instances"] if i.get("page") is not None]
    pieces = merge.read_pieces(mapped)
    maps, _, _ = cycles_bake.map_texels(pieces, data["pages"])
    materials = cycles_bake.BakeMaterials(data["pages"])
    merged = cycles_bake.merge_receivers(pieces, materials)
    total = cycles_bake.bake_repeats(merged, materials, CYCLES, BOUNCES, ("DIRECT", "INDIRECT"))
    light = [mean @ LUMINANCE for mean in total.mean]
    # Channels of one repeat share their paths: their errors add up.
    error = [np.sqrt(total.variance(page)) @ LUMINANCE for page in range(len(light))]
    usable = [valid & inside(m) & ~edges(*e) for valid, m, *e in zip(total.valid, maps, light, error)]
    return light, error, usable


def edges(light, error):
    """Texels that differ from a neighbour by more than MAX_STEP of their light and by more than their noise. Cycles'
    samples lie in the middle half of a texel (measured with Blender 3.4), the reference's all over it."""
    result = np.zeros_like(light, bool)
    for shift in ((0, 1), (0, -1), (1, 0), (-1, 0)):
        noise = np.hypot(error, np.roll(error, shift, (0, 1)))
        result |= np.abs(light - np.roll(light, shift, (0, 1))) > MAX_STEP * light + 4.0 * noise
    return result


def inside(texel_map):
    """Texels whose neighbours lie on the same object with about the same normal."""
    own, normal = texel_map.object, texel_map.normal
    result = own >= 0
    for dy in (-1, 0, 1):
        for dx in (-1, 0, 1):
            other = np.roll(own, (dy, dx), (0, 1)) == own
            near = (np.roll(normal, (dy, dx), (0, 1)) * normal).sum(-1) > 0.9
            result &= other & near
    return result


def student_quantile(chance, freedom):
    """Two-sided bound of Student's distribution, by Hill's expansion (1970, Algorithm 396) about the normal's."""
    low, high = 0.0, 40.0
    for _ in range(80):  # of the normal distribution, by halving
        middle = 0.5 * (low + high)
        tail = np.exp(log_erfc(middle / np.sqrt(2.0)))
        low, high = (middle, high) if tail > chance else (low, middle)
    z, n = low, freedom
    return (
        z
        + (z**3 + z) / (4 * n)
        + (5 * z**5 + 16 * z**3 + 3 * z) / (96 * n**2)
        + (3 * z**7 + 19 * z**5 + 17 * z**3 - 15 * z) / (384 * n**3)
    )


def log_erfc(x):
    """log(1 - erf(x)) for x >= 0 (Numerical Recipes, 6.2.2: relative error 1.2e-7)."""
    t = 1.0 / (1.0 + 0.5 * x)
    terms = (
        0.17087277, -0.82215223, 1.48851587, -1.13520398, 0.27886807, -0.18628806, 0.09678418, 0.37409196, 1.00002368
    )  # fmt: skip
    sum_ = 0.0
    for term in terms:
        sum_ = t * (term + sum_)
    return np.log(t) - x * x - 1.26551223 + sum_


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
    export(folder)
    points, data = trace(library, folder)
    passed, text = judge(points, *bake_cycles(data, hidden, dimmed), tests)
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
