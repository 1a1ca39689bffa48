# SPDX-License-Identifier: GPL-3.0-or-later
# timeout: 300
"""ajar.predict from a script: times of three presets, the file left as it was, and cancel."""
import os
import sys
import tempfile

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from support.addon import build_room, cancelling, load_addon  # noqa: E402

load_addon()
from ajar import job  # noqa: E402

FOLDER = os.environ.get("AJAR_TEST_DIR") or tempfile.mkdtemp(prefix="ajar-test-")


def check_cancel():
    """Cancel while the worker runs leaves no job and no prediction."""
    with cancelling(job.manager, 0.2):
        assert bpy.ops.ajar.predict() == {"CANCELLED"}
    assert job.manager.predicted is None


def check_times(scene):
    """Every preset has a time, better ones take longer; UVs and preview are as before."""
    assert bpy.ops.ajar.predict() == {"FINISHED"}
    found = job.manager.predicted
    assert list(found.seconds) == ["DRAFT", "PREVIEW", "PRODUCTION"], found
    assert 0.0 < found.seconds["DRAFT"] < found.seconds["PRODUCTION"], found
    assert found.scene == scene.name and found.density == 2.0 and found.texels > 100, found
    assert "AjarLightmap" not in bpy.data.meshes["Room"].uv_layers
    assert scene.objects["Room"].ajar.lightmap_page == -1 and not scene.ajar.preview
    plan = found.plan(scene.ajar.preset)
    assert any(line.startswith("Bounces: ") and "of the time" in line for line in plan), plan
    assert any(line.startswith("Skipped: ") and "doors (the scene has none)" in line for line in plan), plan
    assert plan[-1].startswith("Memory of level and light"), plan
    assert "Production: about" in job.manager.last.message, job.manager.last.message


def main():
    """All of it on a small room."""
    scene = build_room()
    scene.ajar.texels_per_meter = 2.0
    scene.ajar.output_dir = FOLDER
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(FOLDER, "level.blend"))
    check_cancel()
    check_times(scene)
    print("bl_predict: ok", flush=True)


main()
