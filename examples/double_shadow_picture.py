# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture of examples/pictures/double_shadow.png, from bakes of the files that double_shadow.py builds.

    python3 examples/double_shadow_picture.py PACKAGE FIXED_PACKAGE OUT.png

Left: a bake with both boxes. Middle: base and terms of the package with both toggles present. Right: the same
from its light patches, the layout of the second paper. Prints how far either is from the bake.
"""
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "examples" / "runtime")]
import light_patches as lp  # noqa: E402

from blender_addon.bridge import runtime  # noqa: E402


def page_of(package, present):
    """The first page through the run-time library, top row first."""
    with runtime.Runtime(package) as light:
        for element in light.elements():
            light.set_weight(element.name, float(present) if element.kind == "toggle" else 1.0)
        light.update()
        pixels = np.asarray(light.page_irradiance(0), np.float32)
        width, height = light.page_size(0)
    return pixels.reshape(height, width, -1)[::-1, :, :3]


def main(package, fixed, out):
    patches = lp.LightPatches(package)
    truth = page_of(fixed, True)
    ours = page_of(package, True)
    theirs = patches.light_map(0, dict.fromkeys(patches.lights, 1.0), dict.fromkeys(patches.objects, 1.0))
    white = np.percentile(truth, 99.5)
    for name, page in (("terms", ours), ("light patches", theirs)):
        lit = (truth.sum(axis=2) > 0.0) & (ours.sum(axis=2) > 0.0)  # leaves out what lies under a box
        error = np.sqrt(np.mean((page - truth)[lit] ** 2)) / truth[lit].mean()
        print(f"{name}: error {100 * error:.2f}% of the mean, darkest {page.min():.3f} W/m^2")
    images = [lp.to_bytes(page, white) for page in (truth, ours, theirs)]
    gap = np.full((images[0].shape[0], 8, 3), 255, np.uint8)
    lp.write_png(out, np.concatenate([images[0], gap, images[1], gap, images[2]], axis=1))


if __name__ == "__main__":
    main(*sys.argv[1:])
