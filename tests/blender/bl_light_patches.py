# SPDX-License-Identifier: GPL-3.0-or-later
# timeout: 400
"""Light patches of a bake against its terms: equal for each box alone, the shadow twice where both are there.
And the pictures of what its texels take."""
import json
import os
import subprocess
import sys

import bpy
import numpy as np

ROOT, FOLDER = os.environ["AJAR_ROOT"], os.environ["AJAR_TEST_DIR"]
sys.path[:0] = [ROOT, os.path.join(ROOT, "examples", "runtime")]
import light_patches as lp  # noqa: E402

sys.path.append(os.path.dirname(os.path.abspath(__file__)))
from support.addon import load_addon  # noqa: E402

from blender_addon.bridge import runtime  # noqa: E402


def blender(*arguments):
    line = [bpy.app.binary_path, "-b", "--factory-startup", "-noaudio", *arguments]
    subprocess.run(line, check=True, timeout=200)


def bake(blend, out):
    batch = os.path.join(ROOT, "blender_addon", "batch.py")
    settings = ["--preset", "draft", "--density", "8", "--samples", "64", "--combinations", "all"]
    blender(
        *(blend, "--python-exit-code", "1", "-P", batch, "--", "--out", out),
        *("--light-patches", "rgb", "--overlap-pictures", *settings),
    )
    return os.path.join(out, "package")


def from_terms(package, presence):
    """The first page by the run-time library, top row first."""
    with runtime.Runtime(package) as light:
        for name, weight in presence.items():
            light.set_weight(name, weight)
        light.update()
        width, height = light.page_size(0)
        return np.array(light.page_irradiance(0), np.float32).reshape(height, width, -1)[::-1, :, :3]


def from_library(package, about, presence):
    """The first page by ajar_runtime_add_patch."""
    library, patches = runtime.load_library(), lp.LightPatches(package)
    light = np.zeros((*patches.pages[0], 3), np.float32)
    pointer = light.ctypes.data_as(runtime.floats)
    halves = [a.astype(np.float16) for a in patches.atlases]
    patch = runtime.Patch()
    library.ajar_runtime_patch_init(runtime.c.byref(patch))
    for stored in about["maps"]:
        share = stored["scale"] * (1.0 if stored["object"] is None else -presence[stored["object"]])
        for p in stored["patches"]:
            for key in ("page_x", "page_y", "width", "height", "atlas_x", "atlas_y", "channel"):
                setattr(patch, key, p[key])
            factor = [share * (p["plane"] == c) for c in range(3)]
            atlas = halves[p["atlas"]]
            words = atlas.ctypes.data_as(runtime.c.POINTER(runtime.c.c_uint16))
            size = (atlas.shape[1], atlas.shape[0])
            code = library.ajar_runtime_add_patch(
                runtime.c.byref(patch), words, *size, (runtime.f32 * 3)(*factor), pointer, *light.shape[1::-1]
            )
            assert code == runtime.OK
    patch.width = 60000
    assert (
        library.ajar_runtime_add_patch(
            runtime.c.byref(patch), words, *size, (runtime.f32 * 3)(1, 1, 1), pointer, *light.shape[1::-1]
        )
        == runtime.ERROR_ARGUMENT
    )
    return light


def error(a, b):
    """Largest difference, relative where b is bright and to its mean where it is dark."""
    return float((np.abs(a - b) / (np.abs(b) + b.mean())).max())


blend = os.path.join(FOLDER, "double_shadow.blend")
blender("--python-exit-code", "1", "-P", os.path.join(ROOT, "examples", "double_shadow.py"), "--", blend)
package = bake(blend, os.path.join(FOLDER, "out"))
with open(os.path.join(package, "patches.json"), encoding="utf-8") as file:
    about = json.load(file)
with open(os.path.join(package, "manifest.json"), encoding="utf-8") as file:
    assert json.load(file)["light_patches"] == "patches.json"
schema = os.path.join(ROOT, "schemas", "patches.schema.json")
validate = os.path.join(ROOT, "tests", "support", "validate.py")
subprocess.run(["python3", validate, schema, os.path.join(package, "patches.json")], check=True)

patches = lp.LightPatches(package)
full = dict.fromkeys(patches.lights, 1.0)
assert set(full) == {"P", "Q"} and set(patches.objects) == {"Box A", "Box B"}
for a, b in ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)):
    presence = {"Box A": a, "Box B": b}
    page, truth = patches.light_map(0, full, presence), from_terms(package, presence)
    assert error(from_library(package, about, presence), page) < 1e-4
    worst = error(page, truth)
    print(f"boxes {a:g} {b:g}: worst difference {100 * worst:.2f}%, darkest {page.min():.2f}")
    if a and b:
        assert worst > 0.3 and page.min() < -0.1 * page.mean(), "the shadows overlap: light is taken twice"
    else:
        assert worst < 0.03, "the rounding of packed texels alone tells them apart"

before, after = {"Box A": 0.0, "Box B": 0.0}, {"Box A": 1.0, "Box B": 0.0}
moved = patches.moved_object(patches.light_map(0, full, before), 0, full, before, after)
assert error(moved, patches.light_map(0, full, after)) < 1e-4
dimmed = patches.changed_light(moved, 0, "P", -0.75, after)
assert error(dimmed, patches.light_map(0, {"P": 0.25, "Q": 1.0}, after)) < 1e-4
print("light patches: ok")

load_addon()
bpy.ops.wm.open_mainfile(filepath=os.path.join(FOLDER, "out", "double_shadow.blend"))
for what in ("overlap", "bytes"):
    assert bpy.ops.ajar.show_overlap(what=what) == {"FINISHED"}
    picture = np.array(bpy.data.images[f"Ajar.page_0.{what}.png"].pixels).reshape(-1, 4)
    assert len(np.unique(picture, axis=0)) > 2, "several numbers of terms, and none"
print("overlap pictures: ok")
