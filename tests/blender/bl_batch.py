# SPDX-License-Identifier: GPL-3.0-or-later
# timeout: 300
"""The batch entry: what it leaves behind, its exit codes and its messages."""
import hashlib
import json
import os
import signal
import subprocess
import sys
import tempfile
import time

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from support.addon import build_room, load_addon  # noqa: E402

BATCH = os.path.join(os.path.dirname(load_addon().__file__), "batch.py")
FOLDER = os.environ.get("AJAR_TEST_DIR") or tempfile.mkdtemp(prefix="ajar-test-")


def command(blend, arguments, addons=False):
    """The command line of a batch bake."""
    line = [bpy.app.binary_path, "-b", "--factory-startup", "-noaudio"]
    line += ["--addons", "ajar"] if addons else []
    return [*line, blend, "--python-exit-code", "1", "-P", BATCH, "--", *arguments]


def run(blend, *arguments, addons=False):
    """(exit code, output) of a batch bake."""
    result = subprocess.run(
        command(blend, arguments, addons), capture_output=True, text=True, timeout=200, check=False
    )
    return result.returncode, result.stdout + result.stderr


def digest(path):
    """Hash of a file."""
    with open(path, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


def check_bake(blend):
    """A bake leaves blend, package and report, prints progress and keeps its input."""
    out, before = os.path.join(FOLDER, "out"), digest(blend)
    code, text = run(
        blend,
        "--preset",
        "draft",
        "--out",
        out,
        "--density",
        "4",
        "--samples",
        "16",
        "--bounces",
        "1",
        "--threads",
        "1",
        "--seed",
        "3",
        addons="BLENDER_USER_SCRIPTS" in os.environ,
    )
    assert code == 0, text
    assert digest(blend) == before and "ajar: " in text and "%" in text
    for name in ("room.blend", "package/manifest.json", "report.json"):
        assert os.path.isfile(os.path.join(out, name)), name
    assert sorted(os.listdir(out)) == ["package", "report.json", "room.blend"], os.listdir(out)
    with open(os.path.join(out, "report.json"), encoding="utf-8") as file:
        json.load(file)
    return out


def check_result(out):
    """The saved file opens with the preview on, needs only files beside it, and loses the preview."""
    bpy.ops.wm.open_mainfile(filepath=os.path.join(out, "room.blend"))
    load_addon()
    scene = bpy.context.scene
    assert scene.ajar.preview and "AjarLightmap" in bpy.data.meshes["Room"].uv_layers
    images = [image for image in bpy.data.images if image.ajar.is_page]
    assert images and all(image.filepath.startswith("//package/") for image in images)
    assert scene.ajar.preset == "PREVIEW", "the batch changed a setting of the scene"
    bpy.ops.ajar.preview_toggle()
    assert scene.objects["Room"].material_slots[0].material.name == "Wall"
    bpy.ops.ajar.preview_toggle()
    assert scene.ajar.preview, "the record's path does not hold"


def check_errors(blend):
    """Each mistake ends with code 1 and a sentence."""
    out = os.path.join(FOLDER, "errors")
    dusty = os.path.join(FOLDER, "dusty")
    os.makedirs(os.path.join(dusty, "package"))
    with open(os.path.join(dusty, "package", "diary.txt"), "w", encoding="ascii"):
        pass
    cases = (
        ((blend, "--preset", "splendid", "--out", out), "invalid choice"),
        ((blend, "--preset", "draft"), "--out"),
        ((blend, "--out", out, "--samples", "0"), "at least 1"),
        ((blend, "--out", os.path.dirname(blend)), "would replace the input"),
        ((blend, "--out", "/proc/nowhere"), "cannot write"),
        ((blend, "--out", dusty), "not a baked package"),
        ((os.path.join(FOLDER, "missing.blend"), "--out", out), "Cannot read file"),
    )
    for arguments, words in cases:
        code, text = run(*arguments)
        assert code == 1 and words in text, (arguments, code, text)
        assert "Traceback" not in text, text


def check_cancel(blend):
    """SIGTERM cancels: code 2, no package."""
    out = os.path.join(FOLDER, "cancelled")
    process = subprocess.Popen(
        command(blend, ["--preset", "reference", "--out", out, "--density", "64"]),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    for line in process.stdout:
        if line.startswith("ajar: ") and "warning" not in line:
            break
    time.sleep(1.0)
    process.send_signal(signal.SIGTERM)
    text = process.communicate(timeout=30)[0]
    assert process.returncode == 2, (process.returncode, text)
    assert not os.path.exists(os.path.join(out, "package")) and not os.path.exists(
        os.path.join(out, "room.blend")
    )


def main():
    """Runs the checks in order."""
    build_room()
    blend = os.path.join(FOLDER, "in", "room.blend")
    os.makedirs(os.path.dirname(blend))
    bpy.ops.wm.save_as_mainfile(filepath=blend, check_existing=False)
    out = check_bake(blend)
    check_errors(blend)
    check_cancel(blend)
    check_result(out)
    print("bl_batch: ok")


main()
