# SPDX-License-Identifier: GPL-3.0-or-later
# timeout: 600
"""ajar.accuracy from a script: the page and its numbers, the file left as it was, and cancel."""
import json
import os
import sys
import tempfile

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from support.addon import build_room, cancelling, load_addon  # noqa: E402

load_addon()
from ajar import job  # noqa: E402

FOLDER = os.environ.get("AJAR_TEST_DIR") or tempfile.mkdtemp(prefix="ajar-test-")
OUT = os.path.join(FOLDER, "out", "accuracy")


def measure(**options):
    """Runs the operator with little time."""
    return bpy.ops.ajar.accuracy(quick=True, points=64, reference_seconds=1.0, **options)


def check_show_has_to_wait():
    """Nothing is measured yet."""
    assert not bpy.ops.ajar.accuracy_show.poll()


def check_cancel():
    """Cancel while the worker runs leaves no page and no job."""
    with cancelling(job.manager, 0.05):
        assert measure(budget=300.0) == {"CANCELLED"}
    assert not os.path.exists(OUT)


def check_page(scene):
    """The page is there, its numbers are of this scene; UVs and preview are as before."""
    assert measure(budget=0.1) == {"FINISHED"}
    assert "AjarLightmap" not in bpy.data.meshes["Room"].uv_layers
    assert scene.objects["Room"].ajar.lightmap_page == -1 and not scene.ajar.preview
    with open(os.path.join(OUT, "accuracy.json"), encoding="utf-8") as file:
        data = json.load(file)
    assert data["about"]["points"] == 64 and data["about"]["density"] == 2.0, data["about"]
    assert data["about"]["scene"] == "level"
    preset = data["trials"][0]
    assert preset["value"] == "draft" and 0.0 < preset["error"] < 1.0, preset
    assert abs(preset["mean"]) < 0.2, ("the bake is not of the scene that was traced", preset)
    assert preset["estimated_noise"] > 0.0 and preset["seconds"] > 0.0
    assert any("out of time" in name for name in data["about"]["skipped"]), data["about"]["skipped"]
    assert data["storage"], "no elements: storage is measured"
    with open(os.path.join(OUT, "accuracy.html"), encoding="utf-8") as file:
        assert data["advice"][0].replace("'", "&#x27;") in file.read()
    assert os.path.join(OUT, "accuracy.html") in job.manager.last.message
    assert bpy.ops.ajar.accuracy_show() == {"FINISHED"}


def check_other_densities(scene):
    """With a little time, a bake at half the density is among the trials; UVs and preview of a bake stay."""
    assert bpy.ops.ajar.bake() == {"FINISHED"} and scene.ajar.preview
    places = [tuple(obj.ajar.uv_offset) for obj in scene.objects]
    assert measure(budget=8.0) == {"FINISHED"}
    assert scene.ajar.preview and [tuple(obj.ajar.uv_offset) for obj in scene.objects] == places
    with open(os.path.join(OUT, "accuracy.json"), encoding="utf-8") as file:
        trials = json.load(file)["trials"]
    texels = {t["value"]: t["texels"] for t in trials if t["knob"] == "texels per metre"}
    assert texels[1.0] < trials[0]["texels"], texels


room = build_room()
room.ajar.preset, room.ajar.texels_per_meter, room.ajar.output_dir = "DRAFT", 2.0, "//out"
bpy.ops.wm.save_as_mainfile(filepath=os.path.join(FOLDER, "level.blend"))
check_show_has_to_wait()
for check in (check_cancel, lambda: check_page(room), lambda: check_other_densities(room)):
    check()
    print("bl_accuracy: ok", flush=True)
