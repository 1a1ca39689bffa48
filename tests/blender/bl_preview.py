# SPDX-License-Identifier: GPL-3.0-or-later
"""The preview shows albedo / pi * irradiance, leaves artists' data alone and comes off exactly."""
import json
import math
import os
import sys
import tempfile

import bpy
import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from support.addon import load_addon, render_pixels, write_package  # noqa: E402

load_addon()
from ajar.apply import clear, preview, uvs  # noqa: E402

IRRADIANCE = ((2.0, 1.0, 0.5), (0.25, 0.5, 1.0))
FOLDER = tempfile.mkdtemp(prefix="ajar-test-")


def principled(name, **inputs):
    """A material of one Principled node with the given inputs."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    node = material.node_tree.nodes["Principled BSDF"]
    for key, value in inputs.items():
        node.inputs[key.replace("_", " ")].default_value = value
    return material


def diffuse(name, color):
    """A plain diffuse material."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    node, output = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeOutputMaterial")
    node.inputs["Color"].default_value = (*color, 1.0)
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material


def grouped(name, color):
    """A diffuse closure inside a node group that takes its colour."""
    group = bpy.data.node_groups.new(name, "ShaderNodeTree")
    if hasattr(group, "interface"):
        group.interface.new_socket(name="Color", in_out="INPUT", socket_type="NodeSocketColor")
        group.interface.new_socket(name="Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    else:
        group.inputs.new("NodeSocketColor", "Color")
        group.outputs.new("NodeSocketShader", "Shader")
    start, node, end = (
        group.nodes.new(kind) for kind in ("NodeGroupInput", "ShaderNodeBsdfDiffuse", "NodeGroupOutput")
    )
    group.links.new(start.outputs[0], node.inputs["Color"])
    group.links.new(node.outputs[0], end.inputs[0])
    material = diffuse(name, color)
    tree = material.node_tree
    holder = tree.nodes.new("ShaderNodeGroup")
    holder.node_tree = group
    holder.inputs[0].default_value = (*color, 1.0)
    tree.links.new(holder.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    return material


def mixed(name, factor, color, emission):
    """Mix of diffuse and emission behind a reroute."""
    material = diffuse(name, color)
    tree = material.node_tree
    glow, mix, turn = (
        tree.nodes.new(kind) for kind in ("ShaderNodeEmission", "ShaderNodeMixShader", "NodeReroute")
    )
    glow.inputs["Color"].default_value = (*emission, 1.0)
    mix.inputs[0].default_value = factor
    tree.links.new(tree.nodes["Diffuse BSDF"].outputs[0], mix.inputs[1])
    tree.links.new(glow.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], turn.inputs[0])
    tree.links.new(turn.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    return material


def plane(name, x, materials, mesh=None, page=0):
    """A unit square that faces +Z at (x, 0, 0)."""
    if mesh is None:
        mesh = bpy.data.meshes.new(name)
        corners = [(-0.5, -0.5, 0), (0.5, -0.5, 0), (0.5, 0.5, 0), (-0.5, 0.5, 0)]
        mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
        mesh.uv_layers.new(name="UVMap")
        for material in materials:
            mesh.materials.append(material)
    obj = bpy.data.objects.new(name, mesh)
    obj.location.x = x
    obj.ajar.lightmap_page = page
    bpy.context.collection.objects.link(obj)
    return obj


def build():
    """Planes of many kinds in a row under a camera; returns them by name."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("Sky")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (0.2, 0.4, 0.8, 1.0)
    gray = diffuse("Gray", (0.5, 0.5, 0.5))
    objects = {
        "gray": plane("gray", 0, [gray]),
        "page1": plane("page1", 1, [gray], page=1),
        "metal": plane(
            "metal", 2, [principled("Metal", Base_Color=(1, 1, 1, 1), Metallic=1.0, Roughness=0.5)]
        ),
        "plastic": plane("plastic", 3, [principled("Plastic", Base_Color=(0.5, 0.5, 0.5, 1), Roughness=0.5)]),
        "clear": plane(
            "clear", 4, [principled("Clear", Base_Color=(0.5, 0.5, 0.5, 1), Alpha=0.25, Specular=0.0)]
        ),
        "empty": plane("empty", 5, []),
        "unmapped": plane("unmapped", 6, [gray], page=-1),
        "group": plane("group", 9, [grouped("Grouped", (0.5, 0.25, 0.125))]),
        "mixed": plane("mixed", 10, [mixed("Mixed", 0.25, (0.8, 0.8, 0.8), (2.0, 1.0, 0.0))]),
        "glow": plane(
            "glow",
            7,
            [
                principled(
                    "Glow",
                    Base_Color=(0, 0, 0, 1),
                    Specular=0.0,
                    Emission=(1, 0.5, 0.25, 1),
                    Emission_Strength=2.0,
                )
            ],
        ),
    }
    shared = plane("shared", 8, [], mesh=objects["gray"].data, page=1)
    shared.ajar.uv_scale, shared.ajar.uv_offset = (0.5, 0.5), (0.25, 0.25)
    shared.material_slots[0].link = "OBJECT"
    shared.material_slots[0].material = diffuse("Own", (0.25, 0.25, 0.25))
    objects["shared"] = shared
    for name, obj in objects.items():
        if name not in ("unmapped",):
            uvs.write_uv_layer(obj.data, numpy.array([0, 0, 1, 0, 1, 1, 0, 1], dtype=numpy.float32))
    add_lights(scene)
    return objects


def add_lights(scene):
    """A static and an off sun that must not shine in the preview, and a camera from above."""
    for name, role in (("static", "STATIC"), ("off", "OFF")):
        lamp = bpy.data.objects.new(name, bpy.data.lights.new(name, "SUN"))
        lamp.data.energy = 10.0
        lamp.ajar.light_role = role
        scene.collection.objects.link(lamp)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type = "ORTHO"
    camera.data.ortho_scale = 11.0
    camera.location = (5, 0, 5)
    scene.collection.objects.link(camera)
    scene.camera = camera


def state():
    """Everything of the artist's that the preview may not change, as JSON."""
    scene = bpy.context.scene
    objects = {}
    for obj in sorted(scene.objects, key=lambda obj: obj.name):
        slots = []
        for slot in obj.material_slots:
            link, shown = slot.link, slot.material.name if slot.material else None
            slot.link = "OBJECT"
            slots.append((link, shown, slot.material.name if slot.material else None))
            slot.link = link
        objects[obj.name] = (slots, obj.hide_render, obj.hide_viewport, sorted(set(obj.keys()) - {"ajar"}))
    meshes = {
        mesh.name: (
            [m and m.name for m in mesh.materials],
            [u.name for u in mesh.uv_layers],
            mesh.uv_layers.active.name,
            [u.active_render for u in mesh.uv_layers],
        )
        for mesh in bpy.data.meshes
    }
    trees = {m.name: sorted((n.name, n.bl_idname) for n in m.node_tree.nodes) for m in bpy.data.materials}
    return json.dumps(
        [objects, meshes, trees, scene.world.name, len(bpy.data.worlds), len(bpy.data.node_groups)],
        sort_keys=True,
    )


def bake(pages=IRRADIANCE):
    """Pretends that a bake has ended."""
    package = write_package(FOLDER, pages)
    bpy.context.scene.ajar.last_bake = json.dumps({"package": package})


def patch(pixels, index):
    """Mean colour of the plane at x = index; the view is 11 wide with plane 0 at its left."""
    width = pixels.shape[1]
    left = int((index + 0.25) / 11 * width)
    right = int((index + 0.75) / 11 * width)
    middle = pixels.shape[0] // 2
    return pixels[middle - 2 : middle + 2, left:right, :3].mean(axis=(0, 1))


def expect(name, got, want, tolerance=2e-3):
    """Fails with the name of what is wrong."""
    want = numpy.broadcast_to(numpy.asarray(want), 3)
    if not numpy.allclose(got, want, rtol=tolerance, atol=tolerance):
        raise AssertionError(f"{name}: got {got}, want {want}")


def check_picture():
    """Each plane has the radiance that its material and page say."""
    pixels = render_pixels(FOLDER, (176, 16), 32)
    pages = numpy.array(IRRADIANCE)
    sky = numpy.array((0.2, 0.4, 0.8))
    expect("gray", patch(pixels, 0), 0.5 * pages[0] / math.pi)
    expect("page 1", patch(pixels, 1), 0.5 * pages[1] / math.pi)
    expect("white metal", patch(pixels, 2), pages[0] / math.pi, 5e-3)
    specular = 0.04 * 0.864 + 0.0187
    specular *= 1 + 0.04 * (1 - 0.864 - 0.0187) / (0.864 + 0.0187)
    expect("plastic", patch(pixels, 3), (specular + 0.5 * (1 - specular)) * pages[0] / math.pi, 5e-3)
    specular = 0.0187  # B of roughness 0.5: Specular 0 still reflects at grazing angles
    expect(
        "clear",
        patch(pixels, 4),
        0.25 * (specular + 0.5 * (1 - specular)) * pages[0] / math.pi + 0.75 * sky,
        5e-3,
    )
    expect("empty slot", patch(pixels, 5), 0.8 * pages[0] / math.pi)
    expect("unmapped", patch(pixels, 6), 0.5 * pages.mean(axis=0) / math.pi)
    expect("glow", patch(pixels, 7), numpy.array((2.0, 1.0, 0.5)), 3e-2)
    expect("group", patch(pixels, 9), numpy.array((0.5, 0.25, 0.125)) * pages[0] / math.pi)
    expect("mix", patch(pixels, 10), 0.6 * pages[0] / math.pi + numpy.array((0.5, 0.25, 0.0)))
    expect("shared mesh", patch(pixels, 8), 0.25 * pages[1] / math.pi)


def check_primary():
    """A primary sun adds its direct light and nothing bounces."""
    sun = bpy.data.objects["static"]
    sun.ajar.light_role = "PRIMARY"
    sun.data.energy = 1.0
    preview.show(bpy.context)
    pixels = render_pixels(FOLDER, (176, 16), 32)
    pages = numpy.array(IRRADIANCE)
    expect("gray under sun", patch(pixels, 0), 0.5 * (pages[0] + 1.0) / math.pi)
    expect("page 1 under sun", patch(pixels, 1), 0.5 * (pages[1] + 1.0) / math.pi)
    preview.hide()


def check_shadow():
    """A half clear surface halves the direct light of a primary lamp on what lies behind it."""
    roof = plane("roof", 0, [principled("Roof", Base_Color=(0, 0, 0, 1), Alpha=0.5)], page=-1)
    roof.location.z, roof.scale = 6.0, (30.0, 30.0, 1.0)
    preview.show(bpy.context)
    pixels = render_pixels(FOLDER, (176, 16), 32)
    expect("under a half clear roof", patch(pixels, 0), 0.5 * (numpy.array(IRRADIANCE[0]) + 0.5) / math.pi)
    preview.hide()
    bpy.data.objects.remove(roof)


def check_round_trip(before):
    """Off restores everything, also after renaming, saving and loading again."""
    scene = bpy.context.scene
    preview.hide()
    assert state() == before, f"toggle off differs:\n{state()}\n{before}"
    preview.show(bpy.context)
    preview.show(bpy.context)  # twice in a row must not record the preview as the original
    path = os.path.join(FOLDER, "saved.blend")
    bpy.data.materials["Gray"].name = "Renamed"
    bpy.data.objects["gray"].name = "renamed"
    bpy.ops.wm.save_as_mainfile(filepath=path, check_existing=False)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert bpy.context.scene.ajar.preview
    preview.hide()
    bpy.data.materials["Renamed"].name = "Gray"
    bpy.data.objects["renamed"].name = "gray"
    assert state() == before, f"off after reload differs:\n{state()}\n{before}"
    assert not [m for m in bpy.data.materials if m.ajar.is_preview]


def check_new_material():
    """A material that the artist assigns while the preview is on stays."""
    preview.show(bpy.context)
    obj = bpy.data.objects["metal"]
    obj.material_slots[0].material = bpy.data.materials["Gray"]
    preview.hide()
    assert obj.material_slots[0].material == bpy.data.materials["Gray"]


def check_clear(before):
    """Clear leaves no trace."""
    count = len(json.loads(before)[2]) + 1  # and the roof's material
    preview.show(bpy.context)
    clear.clear(bpy.context.scene)
    for mesh in bpy.data.meshes:
        assert "AjarLightmap" not in mesh.uv_layers, mesh.name
    assert not [image for image in bpy.data.images if image.ajar.is_page]
    assert not bpy.context.scene.ajar.last_bake
    assert len(bpy.data.materials) == count and len(bpy.data.node_groups) == 1


def main():
    """Runs the checks in order."""
    build()
    bake()
    before = state()
    warnings = preview.show(bpy.context)
    assert not warnings, warnings
    check_picture()
    check_round_trip(before)
    check_primary()
    check_shadow()
    check_new_material()
    check_clear(before)
    print("bl_preview: ok")


main()
