# SPDX-License-Identifier: GPL-3.0-or-later
# timeout: 300
"""ajar.prepare_uvs and ajar.bake from a script: results, record, preview, cancel and clear."""
import os
import sys
import tempfile

import bpy
import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from support.addon import build_room, load_addon, render_pixels  # noqa: E402

load_addon()
from ajar import job  # noqa: E402
from ajar.apply import preview, record  # noqa: E402

FOLDER = os.environ.get("AJAR_TEST_DIR") or tempfile.mkdtemp(prefix="ajar-test-")


def uvs_of(name):
    """Lightmap UVs of a mesh."""
    mesh = bpy.data.meshes[name]
    values = numpy.empty(2 * len(mesh.loops), dtype=numpy.float32)
    mesh.uv_layers["AjarLightmap"].data.foreach_get("uv", values)
    return values


def check_prepare(scene):
    """Every mesh gets finite UVs in the page; objects that share a mesh get places of their own."""
    active = bpy.data.meshes["Room"].uv_layers.active.name
    assert bpy.ops.ajar.prepare_uvs() == {"FINISHED"}
    assert bpy.data.meshes["Room"].uv_layers.active.name == active
    for name in ("Room", "Box"):
        values = uvs_of(name)
        assert numpy.isfinite(values).all() and values.min() >= 0.0 and values.max() <= 1.0, name
        assert numpy.ptp(values) > 0.0, name
    first, second = scene.objects["Box"].ajar, scene.objects["Other Box"].ajar
    assert first.lightmap_page >= 0 and second.lightmap_page >= 0
    places = [(box.lightmap_page, *box.uv_offset) for box in (first, second)]
    assert places[0] != places[1], places


def check_bake(scene):
    """A bake leaves a whole package, a report, a record, and the preview on."""
    materials = [m.name for m in bpy.data.materials]
    assert bpy.ops.ajar.bake() == {"FINISHED"}
    package = os.path.join(FOLDER, "out", "package")
    assert os.path.isfile(os.path.join(package, "manifest.json"))
    assert os.path.isfile(os.path.join(FOLDER, "out", "report.json"))
    bake = record.read_record(scene)
    assert bake["package"] == "//out/package" and bake["seconds"] > 0.0, bake
    assert scene.ajar.preview
    images = [image for image in bpy.data.images if image.ajar.is_page]
    assert images and all(image.filepath.startswith("//out/package") for image in images)
    assert all(image.colorspace_settings.name in ("Linear", "Linear Rec.709") for image in images)
    assert scene.objects["Lamp"].hide_render
    pixels = render_pixels(FOLDER, (48, 32), 8)
    assert pixels[:, :, :3].mean() > 0.01, "the preview is black"
    assert bpy.ops.ajar.preview_toggle() == {"FINISHED"}
    assert not scene.ajar.preview and not scene.objects["Lamp"].hide_render
    assert [m.name for m in bpy.data.materials] == materials
    assert not scene.objects["Camera"].ajar.preview_slots


def check_cancel(scene):
    """Cancel ends a long job soon and leaves the last package as it was."""
    manifest = os.path.join(FOLDER, "out", "package", "manifest.json")
    with open(manifest, "rb") as file:
        before = file.read()
    steps = {"count": 0}
    original = job.manager.step

    def step():
        steps["count"] += 1
        if steps["count"] == 12:
            job.manager.cancel()
        return original()

    job.manager.step = step
    scene.ajar.preset, scene.ajar.texels_per_meter = "REFERENCE", 64.0
    try:
        assert bpy.ops.ajar.bake() == {"CANCELLED"}
    finally:
        del job.manager.step
        scene.ajar.preset, scene.ajar.texels_per_meter = "DRAFT", 4.0
    assert job.manager.last.result == "cancelled" and not job.manager.running
    with open(manifest, "rb") as file:
        assert file.read() == before
    assert not [
        name for name in os.listdir(os.path.join(FOLDER, "out")) if name not in ("package", "report.json")
    ]


def check_reload():
    """The record and the preview hold after a save and a load."""
    preview.show(bpy.context)
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.open_mainfile(filepath=bpy.data.filepath)
    scene = bpy.context.scene
    assert scene.ajar.preview and record.read_record(scene)["package"] == "//out/package"
    bpy.ops.ajar.preview_toggle()
    assert scene.objects["Room"].material_slots[0].material.name == "Wall"
    assert bpy.ops.ajar.clear() == {"FINISHED"}
    assert not any("AjarLightmap" in mesh.uv_layers for mesh in bpy.data.meshes)


def main():
    """Runs the checks in order on one file."""
    scene = build_room()
    scene.ajar.preset, scene.ajar.texels_per_meter, scene.ajar.bounces = "DRAFT", 4.0, 1
    scene.ajar.output_dir = "//out/"
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(FOLDER, "room.blend"), check_existing=False)
    check_prepare(scene)
    check_bake(scene)
    check_cancel(scene)
    check_reload()
    print("bl_bake: ok")


main()
