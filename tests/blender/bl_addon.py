# SPDX-License-Identifier: GPL-3.0-or-later
"""Public names, tagging operators, checks and UV layers of the add-on."""
import json
import os
import sys
import tempfile

import bpy
import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from support.addon import load_addon  # noqa: E402

ADDON = load_addon()
from ajar import checks, settings  # noqa: E402
from ajar.apply import uvs  # noqa: E402

SCENE = {
    "texels_per_meter",
    "atlas_size",
    "preset",
    "bounces",
    "noise_target",
    "time_limit",
    "seed",
    "output_dir",
    "light_sets",
    "combinations",
    "term_threshold",
    "light_patches",
}
LIGHT_SET = {"name", "weight", "color", "combine"}
COLLECTION = {
    "light_set",
    "movable",
    "open_pose",
    "bounce_when_closed",
    "openness",
    "presence",
    "combine",
}
OBJECT = {
    "light_role",
    "light_set",
    "surface",
    "texel_scale",
    "bake_side",
    "movable",
    "open_pose",
    "bounce_when_closed",
    "openness",
    "presence",
    "combine",
}
OPERATORS = (
    "accuracy",
    "accuracy_show",
    "bake",
    "cancel",
    "check",
    "preview_toggle",
    "show_overlap",
    "prepare_uvs",
    "light_set_add",
    "light_set_remove",
    "light_set_assign",
    "light_set_per_light",
    "light_set_import",
    "door_mark",
    "toggle_mark",
    "clear",
)
ENUMS = {
    ("scene", "preset"): ["DRAFT", "PREVIEW", "PRODUCTION", "REFERENCE"],
    ("scene", "combinations"): ["NONE", "AUTO", "ALL"],
    ("object", "light_role"): ["PRIMARY", "STATIC", "OFF"],
    ("object", "surface"): ["AUTO", "LIGHTMAP", "LIGHT_GRID", "OCCLUDER", "IGNORE"],
    ("object", "movable"): ["FIXED", "DOOR", "TOGGLE"],
    ("collection", "movable"): ["FIXED", "DOOR", "TOGGLE"],
    ("world", "sky_role"): ["BAKED", "OFF"],
}


def fresh():
    """Blender's default scene: a cube, a lamp, a camera."""
    bpy.ops.wm.read_factory_settings()
    load_again()
    return bpy.context.scene, bpy.data.objects["Cube"]


def load_again():
    """Loading factory settings drops add-ons registered by hand in some versions."""
    if not hasattr(bpy.types.Scene, "ajar"):
        ADDON.register()


def check_names():
    """Property groups and operators have exactly the public names."""
    scene, cube = fresh()
    owners = {
        "scene": scene.ajar,
        "object": cube.ajar,
        "world": scene.world.ajar,
        "collection": bpy.data.collections[0].ajar,
    }
    assert set(owners["collection"].bl_rna.properties.keys()) >= COLLECTION
    assert set(scene.ajar.light_sets.add().bl_rna.properties.keys()) >= LIGHT_SET
    assert set(scene.ajar.bl_rna.properties.keys()) >= SCENE
    assert set(cube.ajar.bl_rna.properties.keys()) >= OBJECT
    for (owner, name), items in ENUMS.items():
        assert owners[owner].bl_rna.properties[name].enum_items.keys() == items, name
    for name in OPERATORS:
        assert hasattr(getattr(bpy.ops.ajar, name), "get_rna_type"), name
        getattr(bpy.ops.ajar, name).get_rna_type()
    assert cube.ajar.light_role == "PRIMARY" and cube.ajar.surface == "AUTO"


def check_sets_and_doors():
    """Light sets are added, assigned and removed; doors are marked with their open pose."""
    scene, cube = fresh()
    bpy.ops.ajar.light_set_add(name="Lamps")
    bpy.ops.ajar.light_set_add(name="Lamps")
    assert [entry.name for entry in scene.ajar.light_sets] == ["Lamps", "Lamps.001"]
    bpy.data.objects["Light"].select_set(True)
    cube.select_set(False)
    bpy.ops.ajar.light_set_assign(name="Lamps")
    assert bpy.data.objects["Light"].ajar.light_set == "Lamps"
    scene.ajar.light_set_index = 0
    bpy.ops.ajar.light_set_remove()
    assert bpy.data.objects["Light"].ajar.light_set == ""
    assert [entry.name for entry in scene.ajar.light_sets] == ["Lamps.001"]
    pose = bpy.data.objects.new("Pose", cube.data)
    scene.collection.objects.link(pose)
    for obj in (pose, cube):
        obj.select_set(True)
    bpy.context.view_layer.objects.active = cube
    bpy.ops.ajar.door_mark()
    assert cube.ajar.movable == "DOOR" and cube.ajar.open_pose == pose


def found(text, level=None):
    """Findings whose text holds a word."""
    findings = checks.check_scene(bpy.context)
    for finding in findings:
        assert finding.remedy and finding.text, finding
    return [f for f in findings if text in f.text and (level is None or f.level == level)]


def check_checks():
    """Each problem is named, and gone when it is mended."""
    scene, cube = fresh()
    assert found("not saved", "ERROR")
    scene.ajar.output_dir = tempfile.mkdtemp()
    assert not found("not saved") and not found("nothing to bake")
    cube.scale.x = -1
    bpy.context.view_layer.update()
    assert found("negative scale", "WARNING")
    bpy.data.objects["Light"].ajar.light_role = "OFF"
    scene.world.ajar.sky_role = "OFF"
    assert found("nothing shines", "WARNING")
    scene.world.ajar.sky_role = "BAKED"
    assert not found("nothing shines")
    text = "looks flipped, 100 % of its surface. Flip its normals, or set Bake side to Back"
    scene.ajar.last_bake = json.dumps({"warnings": [[cube.name, text]]})
    assert [f.remedy for f in found("looks flipped")] == ["Flip its normals, or set Bake side to Back"]
    cube.ajar.bake_side = "BACK"
    assert not found("looks flipped")
    scene.ajar.last_bake = ""
    node = cube.active_material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.new("Lost", 4, 4)
    node.image.source, node.image.filepath = "FILE", "/nowhere/lost.png"
    assert found("is missing", "WARNING")[0].culprit == "Lost"
    cube.hide_render = True
    assert found("nothing to bake", "ERROR")
    cube.hide_render = False
    package = os.path.join(scene.ajar.output_dir, "package")
    os.makedirs(package)
    with open(os.path.join(package, "diary.txt"), "w", encoding="ascii"):
        pass
    assert found("not a baked package", "ERROR")


def check_uv_layers():
    """The lightmap layer never takes the active or render role, and a full mesh is refused."""
    _scene, cube = fresh()
    mesh = cube.data
    mesh.uv_layers.new(name="Second")
    mesh.uv_layers.active = mesh.uv_layers["UVMap"]
    mesh.uv_layers["Second"].active_render = True
    values = numpy.random.default_rng(1).random(2 * len(mesh.loops), dtype=numpy.float32)
    assert uvs.write_uv_layer(mesh, values) == ""
    assert mesh.uv_layers.active.name == "UVMap" and mesh.uv_layers["Second"].active_render
    stored = numpy.empty_like(values)
    mesh.uv_layers["AjarLightmap"].data.foreach_get("uv", stored)
    assert (stored == values).all()
    uvs.remove_uv_layer(mesh)
    assert mesh.uv_layers.keys() == ["UVMap", "Second"]
    assert mesh.uv_layers.active.name == "UVMap" and mesh.uv_layers["Second"].active_render
    while len(mesh.uv_layers) < 8:
        mesh.uv_layers.new()
    assert "8 UV layers" in uvs.write_uv_layer(mesh, values)
    assert found("8 UV layers", "WARNING")


def check_settings():
    """Scene settings reach the engine; a batch's overrides win; a sample count is exact."""
    scene, _cube = fresh()
    assert settings.engine_settings(scene)["noise_target"] == 0.12
    scene.ajar.preset = "DRAFT"
    assert settings.engine_settings(scene)["noise_target"] == 0.4
    scene.ajar.noise_target = 0.1
    assert abs(settings.engine_settings(scene)["noise_target"] - 0.1) < 1e-6
    fixed = settings.engine_settings(scene, {"samples": 256, "bounces": 2, "texels_per_meter": 4.0})
    assert (fixed["noise_target"], fixed["samples"], fixed["bounces"]) == (0.0, 256, 2)
    assert settings.layout_settings(scene, {"texels_per_meter": 4.0, "samples": 1})["texels_per_meter"] == 4.0


def check_polls():
    """Operators that cannot run say why."""
    fresh()
    assert not bpy.ops.ajar.cancel.poll()
    assert not bpy.ops.ajar.preview_toggle.poll()
    try:
        bpy.ops.ajar.bake()
    except RuntimeError as error:
        assert "not saved" in str(error), error
    else:
        raise AssertionError("baked an unsaved file")


def check_registration():
    """Registers and unregisters repeatedly without leftovers."""
    for _ in range(3):
        ADDON.unregister()
        assert not hasattr(bpy.types.Scene, "ajar")
        ADDON.register()


for check in (
    check_names,
    check_sets_and_doors,
    check_checks,
    check_uv_layers,
    check_settings,
    check_polls,
    check_registration,
):
    check()
    print(f"bl_addon: {check.__name__} ok")
