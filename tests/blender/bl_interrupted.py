# SPDX-License-Identifier: GPL-3.0-or-later
# timeout: 300
"""A bake that ends in the middle, because its worker is killed or the artist cancels, at each stage:
Blender, the file and the last package are as they were, and the next bake works."""
import glob
import hashlib
import os
import signal
import sys
import tempfile
import time

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from support.addon import build_room, load_addon  # noqa: E402

load_addon()
from ajar import job, settings  # noqa: E402

FOLDER = os.environ.get("AJAR_TEST_DIR") or tempfile.mkdtemp(prefix="ajar-test-")
OUT = os.path.join(FOLDER, "out")
STAGES = ("lightmap layout", "lightmap texels", "direct light", "bounces", "final gather")


def digest(folder):
    """Hash of every file below a folder, by name."""
    result = {}
    for path in sorted(glob.glob(os.path.join(folder, "**", "*"), recursive=True)):
        if os.path.isfile(path):
            with open(path, "rb") as file:
                result[path] = hashlib.sha256(file.read()).hexdigest()
    return result


def scene_state():
    """What a bake may not touch unless it finishes."""
    scene = bpy.context.scene
    places = {o.name: (o.ajar.lightmap_page, *o.ajar.uv_scale, *o.ajar.uv_offset) for o in bpy.data.objects}
    slots = {o.name: [s.material and s.material.name for s in o.material_slots] for o in bpy.data.objects}
    uvs = {m.name: [tuple(d.uv) for layer in m.uv_layers for d in layer.data] for m in bpy.data.meshes}
    images = sorted((i.name, i.filepath) for i in bpy.data.images)
    return scene.ajar.preview, scene.ajar.last_bake, images, places, slots, uvs


def start():
    """A bake that would take minutes."""
    package, report = settings.output_paths(bpy.context.scene)
    task = job.Job(
        "Bake",
        bpy.context,
        job.bake_steps,
        package=package,
        report=report,
        overrides={"preset": "REFERENCE", "samples": 1 << 18, "bounces": 2},
    )
    job.manager.start(task)
    return task


def run_until(task, stage):
    """Steps a job until its worker is in a stage, or in a later one if that was too short to be seen."""
    while job.manager.step():
        if task.worker is not None and task.status.stage in STAGES[STAGES.index(stage) :]:
            return True
        time.sleep(0.01)
    return False


def finish(task):
    """Steps the job to its end."""
    while job.manager.step():
        time.sleep(0.01)
    return task.status


def check_end(task, before, state, folder):
    """Nothing is left of the attempt."""
    assert digest(OUT) == before, "the last package changed"
    assert sorted(os.listdir(OUT)) == ["package", "report.json"], os.listdir(OUT)
    assert not os.path.exists(folder), "the temporary folder is left"
    assert not job.manager.running and task.worker is None
    assert scene_state() == state


def interrupt(stage, how, before, saved):
    """One bake that ends at a stage."""
    bpy.ops.ajar.preview_toggle()  # a bake takes the preview off before it starts
    assert not bpy.context.scene.ajar.preview
    state = scene_state()
    task = start()
    folder = task.folder
    assert run_until(task, stage), (stage, task.status.message)
    if how == "kill":
        os.kill(task.worker.pid, signal.SIGKILL)
    else:
        job.manager.cancel()
    status = finish(task)
    wanted = ("failed", "signal 9") if how == "kill" else ("cancelled", "cancelled")
    assert status.result == wanted[0] and wanted[1] in status.message, (
        stage,
        how,
        status.result,
        status.message,
    )
    check_end(task, before, state, folder)
    assert digest(os.path.dirname(bpy.data.filepath))[bpy.data.filepath] == saved
    bpy.ops.ajar.preview_toggle()
    assert bpy.context.scene.ajar.preview, "the last bake can no longer be shown"


def main():
    """Bakes once, then interrupts bakes, then bakes again."""
    scene = build_room()
    scene.ajar.preset, scene.ajar.texels_per_meter, scene.ajar.bounces = "DRAFT", 4.0, 1
    scene.ajar.output_dir = "//out/"
    path = os.path.join(FOLDER, "room.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, check_existing=False)
    assert bpy.ops.ajar.bake() == {"FINISHED"}
    bpy.ops.wm.save_mainfile()
    before, saved = digest(OUT), digest(FOLDER)[path]
    scene.ajar.texels_per_meter = 16.0
    for stage in STAGES:
        for how in ("kill", "cancel"):
            interrupt(stage, how, before, saved)
    scene.ajar.texels_per_meter = 5.0
    assert bpy.ops.ajar.bake() == {"FINISHED"}
    assert digest(OUT) != before
    print("bl_interrupted: ok")


main()
