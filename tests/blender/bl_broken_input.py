# SPDX-License-Identifier: GPL-3.0-or-later
# timeout: 300
"""What real levels get wrong, each in one object: it is named, and every other surface is lit as it
should be. All floors lie beside each other under a vertical sun of 1 W/m^2."""
import json
import math
import os
import sys
import tempfile

import bpy
import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from support import exr  # noqa: E402
from support.addon import load_addon  # noqa: E402

load_addon()
from ajar import checks, job  # noqa: E402

FOLDER = os.environ.get("AJAR_TEST_DIR") or tempfile.mkdtemp(prefix="ajar-test-")
SQUARE = ((0, 0), (1, 0), (1, 1), (0, 1))
SUN = 1.0  # W/m^2


def add_floors(name, at, count=1, material=None):
    """An object of squares of one metre in a row along y, facing up, at x = 2 * at."""
    vertices = [(x, y + 2 * k, 0) for k in range(count) for x, y in SQUARE]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], [tuple(range(4 * k, 4 * k + 4)) for k in range(count)])
    mesh.materials.append(material or bpy.data.materials["Grey"])
    obj = bpy.data.objects.new(name, mesh)
    obj.location = (2 * at, 0, 0)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def add_lightmap(obj, corners):
    """Lightmap UVs drawn by the artist: corners(square) gives the four of each square."""
    layer = obj.data.uv_layers.new(name="AjarLightmap")
    values = [uv for k in range(len(obj.data.polygons)) for uv in corners(k)]
    layer.data.foreach_set("uv", numpy.array(values, numpy.float32).ravel())


def folded(k):
    """Two squares that share an edge in space and in UVs, where the second lies upon the first."""
    return [(x if k == 0 else 2 - x, y) for x, y in (SQUARE if k == 0 else ((1, 0), (2, 0), (2, 1), (1, 1)))]


def add_folded(name, at):
    """Two squares side by side, joined along an edge, with UVs folded over it."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(
        [(0, 0, 0), (1, 0, 0), (2, 0, 0), (2, 1, 0), (1, 1, 0), (0, 1, 0)], [], [(0, 1, 4, 5), (1, 2, 3, 4)]
    )
    mesh.materials.append(bpy.data.materials["Grey"])
    obj = bpy.data.objects.new(name, mesh)
    obj.location = (2 * at, 5, 0)
    bpy.context.scene.collection.objects.link(obj)
    add_lightmap(obj, folded)


def plain_material(name, image=None):
    """Grey diffuse, or coloured by an image."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    shader, output = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeOutputMaterial")
    shader.inputs["Color"].default_value = (0.5, 0.5, 0.5, 1)
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    if image is not None:
        node = tree.nodes.new("ShaderNodeTexImage")
        node.image = image
        tree.links.new(node.outputs["Color"], shader.inputs["Color"])
    return material


def missing_image():
    """An image whose file is gone."""
    image = bpy.data.images.new("Lost", 4, 4)
    image.filepath, image.source = "//nowhere/lost.png", "FILE"
    return image


def build():
    """The scene with all its faults."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    load_addon()
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.ajar.light_role = SUN, "STATIC"
    bpy.context.scene.collection.objects.link(sun)
    plain_material("Grey")
    add_floors("Sound", 0)
    add_floors("Untextured", 1, material=plain_material("Lost Paint", missing_image()))
    add_floors("Mirrored", 2).scale = (-1, 1, 1)
    add_floors("Turned Over", 3).scale = (1, 1, -1)
    add_floors("Turned Back", 9).scale = (1, 1, -1)
    bpy.data.objects["Turned Back"].ajar.bake_side = "BACK"
    add_lightmap(add_floors("Stacked", 4, 2), lambda k: SQUARE)
    add_folded("Folded", 5)
    add_floors("Empty", 7).data.clear_geometry()
    torn = add_floors("Torn", 8, 2).data
    torn.vertices[0].co = (math.nan, 0, 0)


def irradiance_at(package, manifest, name, polygon):
    """Mean luminance of the texels around the middle of a polygon, and their validity."""
    instance = next(i for i in manifest["instances"] if i["name"] == name)
    mesh = bpy.data.objects[name].data
    loops = mesh.polygons[polygon].loop_indices
    uv = numpy.mean([mesh.uv_layers["AjarLightmap"].data[i].uv for i in loops], axis=0)
    u, v = uv * instance["uv_scale"] + instance["uv_offset"]
    page = manifest["pages"][instance["page"]]
    x, y = int(u * page["width"]), int(v * page["height"])
    light = exr.read_rgb(os.path.join(package, page["irradiance"]))[y - 1 : y + 2, x - 1 : x + 2]
    validity = exr.read_exr(os.path.join(package, page["quality"]))["validity"][y - 1 : y + 2, x - 1 : x + 2]
    return float(light.mean()), float(validity.mean())


def check_findings():
    """What can be seen before the bake is named before it."""
    found = [(f.culprit, f.text) for f in checks.check_scene(bpy.context)]
    for culprit, words in (
        ("Lost", "is missing"),
        ("Mirrored", "negative scale"),
        ("Turned Over", "negative scale"),
        ("Empty", "empty mesh"),
    ):
        assert any(c == culprit and words in t for c, t in found), (culprit, words, found)


def check_warnings(report):
    """The report names the object or material at fault, and no sound one."""
    found = [(w["culprit"], w["text"]) for w in report["warnings"]]
    shown = job.manager.last.warnings
    for culprit, words in (
        ("Lost Paint", "image 'Lost'"),
        ("Empty", "no faces"),
        ("Torn", "not finite"),
        ("Folded", "overlap"),
    ):
        assert any(c == culprit and words in t for c, t in found), (culprit, words, found)
    assert any(c == "Stacked" and "overlap" in t for c, t in shown), shown
    assert not [c for c, _ in found if c in ("Sound", "Mirrored", "Grey")], found


def check_light(package):
    """Every square that is sound has the light of the sun; so have both of overlapping ones.

    Scaled by -1 along z, a square stays where it was with its front below, in the dark as in Cycles; its back is
    the side that the sun lights.
    """
    with open(os.path.join(package, "manifest.json"), encoding="utf-8") as file:
        manifest = json.load(file)
    names = {i["name"] for i in manifest["instances"]}
    turned = {"Turned Over", "Turned Back"}
    assert names == turned | {"Sound", "Untextured", "Mirrored", "Stacked", "Folded", "Torn"}, names
    assert irradiance_at(package, manifest, "Turned Over", 0) == (0.0, 1.0)
    for name, polygon in (
        ("Sound", 0),
        ("Untextured", 0),
        ("Mirrored", 0),
        ("Turned Back", 0),
        ("Stacked", 0),
        ("Stacked", 1),
        ("Folded", 0),
        ("Folded", 1),
        ("Torn", 1),
    ):
        light, validity = irradiance_at(package, manifest, name, polygon)
        assert abs(light / SUN - 1) < 2e-3 and validity == 1.0, (name, polygon, light, validity)


def main():
    """Bakes once and looks at everything."""
    build()
    scene = bpy.context.scene
    settings = scene.ajar
    settings.preset, settings.texels_per_meter, settings.bounces = "DRAFT", 8.0, 1
    settings.output_dir, settings.keep_uvs = "//out/", True
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(FOLDER, "broken.blend"), check_existing=False)
    check_findings()
    assert bpy.ops.ajar.bake() == {"FINISHED"}, job.manager.last.message
    with open(os.path.join(FOLDER, "out", "report.json"), encoding="utf-8") as file:
        check_warnings(json.load(file))
    check_light(os.path.join(FOLDER, "out", "package"))
    print("bl_broken_input: ok")


main()
