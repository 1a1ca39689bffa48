# SPDX-License-Identifier: GPL-3.0-or-later
"""Direct light of every light type and size: Ajar against Cycles, texel by texel.

    python3 tests/blender/light_units.py [--cases point_r0 sun_1 ...] [--keep DIR] [--limit 0.005]

Each case is baked by the batch entry without bounces and by Cycles on the same UVs. Compared are
texels whose own noise is known to be small and that lie on no light or shadow edge. A case fails if
their mean ratio or more than 1% of them leave the limit (plus three standard errors).
"""
import argparse
import os
import subprocess
import sys
import tempfile

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
import compare_bake  # noqa: E402
from support import light_table, run  # noqa: E402

DENSITY = 32  # texels per metre: light hardly changes within a texel
AJAR_SAMPLES = 4096
CYCLES_SAMPLES = 1024
MAX_NOISE = 0.02  # relative standard error of a texel that counts
MAX_STEP = 0.06  # relative difference to a neighbour beyond which a texel lies on an edge


def build(name, folder, log):
    """Write a case's .blend."""
    path = os.path.join(folder, f"{name}.blend")
    code = (
        f"import sys; sys.path.insert(0, {HERE!r}); import bpy; from support import light_cases; "
        f"light_cases.build_case({name!r}); bpy.ops.wm.save_as_mainfile(filepath={path!r})"
    )
    run.blender(['--factory-startup', '--python-exit-code', '1', '--python-expr', code], log)
    return path


def bake(path, folder, log):
    """Bake with Ajar and with Cycles; returns (package, reference)."""
    blend, package = run.bake(
        path,
        os.path.join(folder, "out"),
        ['--density', DENSITY, '--bounces', 0, '--samples', AJAR_SAMPLES],
        log,
    )
    reference = os.path.join(folder, "reference.npz")
    run.script(
        "cycles_bake.py",
        blend,
        ['--package', package, '--out', reference, '--bounces', 0, '--samples', CYCLES_SAMPLES],
        log,
    )
    return package, reference


def quiet_texels(pages):
    """Texels on all pages that are valid, bright, noise-free and on no edge."""
    peak = max((p.reference[p.valid].sum(-1).max() for p in pages if p.valid.any()), default=0.0)
    for page in pages:
        light = page.reference @ compare_bake.LUMINANCE
        error = np.hypot(page.reference_error, page.ajar_error)
        with np.errstate(all='ignore'):
            page.valid &= (
                (light * 3 > 1e-3 * peak) & (error < MAX_NOISE * light) & ~page.border & ~_edges(light)
            )
    return compare_bake.Texels(pages)


def _edges(light):
    """True where a neighbour differs much."""
    result = np.zeros_like(light, bool)
    for axis in (0, 1):
        step = np.abs(np.diff(light, axis=axis)) > MAX_STEP * np.abs(light).take(
            range(light.shape[axis] - 1), axis
        )
        low, high = [slice(None)] * 2, [slice(None)] * 2
        low[axis], high[axis] = slice(None, -1), slice(1, None)
        result[tuple(low)] |= step
        result[tuple(high)] |= step
    return result


def judge(texels, limit, outside=0.01):
    """(passed, text) of one case; `outside` is the share of texels that may leave the limit."""
    if len(texels.a) < 50:
        return False, f"only {len(texels.a)} texels can be compared"
    mean = texels.ajar.sum(0) / np.maximum(texels.reference.sum(0), 1e-12)
    far = np.abs(texels.a - texels.r) > limit * texels.r + 3 * texels.error
    relative = np.abs(texels.a / texels.r - 1)
    # A channel without light (an odd colour) has no ratio.
    lit = texels.reference.sum(0) > 1e-3 * texels.reference.sum()
    passed = bool((np.abs(mean[lit] - 1) < limit).all() and far.mean() < outside)
    return passed, (
        f"texels {len(texels.a):5}  mean ratio {mean[0]:.5f} {mean[1]:.5f} {mean[2]:.5f}  "
        f"median |d| {np.median(relative):.5f}  p99 |d| {np.percentile(relative, 99):.5f}  outside {far.mean():.4f}"
    )


def run_case(name, folder, limit):
    """Bake and judge one case."""
    folder = os.path.abspath(folder)
    os.makedirs(folder, exist_ok=True)
    log = os.path.join(folder, "log.txt")
    try:
        package, reference = bake(build(name, folder, log), folder, log)
    except subprocess.CalledProcessError:
        return False, f"a bake failed, see {log}"
    return judge(quiet_texels(compare_bake.load(package, reference)[0]), limit)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument('--cases', nargs='*', help="default: all")
    parser.add_argument('--keep', help="folder to keep the files in")
    parser.add_argument('--limit', type=float, default=0.005)
    args = parser.parse_args()
    failures = 0
    with tempfile.TemporaryDirectory() as temporary:
        for name in args.cases or light_table.CASES:
            passed, text = run_case(name, os.path.join(args.keep or temporary, name), args.limit)
            failures += not passed
            print(f"{'ok  ' if passed else 'FAIL'} {name:20} {text}", flush=True)
    return int(failures > 0)


if __name__ == "__main__":
    sys.exit(main())
