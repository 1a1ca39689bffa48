# SPDX-License-Identifier: GPL-3.0-or-later
"""Extraction of the world, lights and tags.

    blender -b --factory-startup --python-exit-code 1 -P tests/blender/bl_extract_light.py [-- NAME...]
"""
import math
import os
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import bpy
import numpy as np

from support.extract_kit import *  # noqa: F401,F403 - the words these tests are written in
from support.extract_kit import run


def directional_world():
    world = bpy.data.worlds.new("Directions")
    bpy.context.scene.world = world
    world.use_nodes = True
    tree = world.node_tree
    tree.nodes.clear()
    direction = node(tree, "TexCoord").outputs["Generated"]
    half = node(
        tree, "VectorMath", {0: direction, 1: (0.5, 0.5, 0.5), 2: (0.5, 0.5, 0.5)}, operation="MULTIPLY_ADD"
    )
    background = node(tree, "Background", {"Color": half.outputs[0], "Strength": 2.0})
    tree.links.new(background.outputs[0], tree.nodes.new("ShaderNodeOutputWorld").inputs[0])
    return world


def test_sky_mapping():
    directional_world()
    before, engine = data_counts(), bpy.context.scene.render.engine
    world_module.SKY_WIDTH, old = 64, world_module.SKY_WIDTH
    try:
        shot = Shot()
    finally:
        world_module.SKY_WIDTH = old
    assert data_counts() == before and bpy.context.scene.render.engine == engine
    sky = shot.data["sky"]
    assert sky["type"] == "equirect"
    texels = shot.data["textures"][sky["texture"]]["texels"]
    height, width = texels.shape[:2]
    v, u = np.meshgrid((np.arange(height) + 0.5) / height, (np.arange(width) + 0.5) / width, indexing="ij")
    angle, z = -(u - 0.5) * 2 * math.pi, np.sin((v - 0.5) * math.pi)
    flat = np.sqrt(1 - z * z)
    expected = np.stack([np.cos(angle) * flat, np.sin(angle) * flat, z], -1) + 1.0
    close(texels[..., :3], expected, 0.06)


def test_constant_sky():
    world = bpy.data.worlds.new("Constant")
    bpy.context.scene.world = world
    world.use_nodes = True
    background = next(n for n in world.node_tree.nodes if n.type == "BACKGROUND")
    background.inputs["Color"].default_value = (0.1, 0.2, 0.4, 1)
    background.inputs["Strength"].default_value = 0.5
    sky = Shot().data["sky"]
    assert sky["type"] == "constant"
    close(sky["color"], (0.05, 0.1, 0.2))
    bpy.context.scene.world = None
    assert Shot().data["sky"]["type"] == "none"


def test_hdri_sky():
    world = bpy.data.worlds.new("HDRI")
    bpy.context.scene.world = world
    world.use_nodes = True
    tree = world.node_tree
    texture = node(tree, "TexEnvironment", image=image("Env", checker(8) * 5, "Non-Color", True))
    background = next(n for n in tree.nodes if n.type == "BACKGROUND")
    tree.links.new(texture.outputs[0], background.inputs["Color"])
    background.inputs["Strength"].default_value = 3.0
    shot = Shot()
    assert shot.data["sky"]["type"] == "equirect" and shot.data["sky"]["color"] == [3.0] * 3
    close(shot.data["textures"][shot.data["sky"]["texture"]]["texels"][..., :2], checker(8)[..., :2] * 5)


def light(name, kind, **options):
    data = bpy.data.lights.new(name, kind)
    for key, setting in options.items():
        setattr(data, key, setting)
    return add(name, data)


def test_lights():
    light("Point", "POINT", energy=12.5, color=(1, 0.5, 0.25), shadow_soft_size=0.3)
    light("Spot", "SPOT", spot_size=1.2, spot_blend=0.3)
    light("Sun", "SUN", energy=3, angle=0.1)
    light("Square", "AREA", shape="SQUARE", size=2)
    light("Disk", "AREA", shape="DISK", size=2)
    light("Ellipse", "AREA", shape="ELLIPSE", size=2, size_y=3)
    off = light("Gone", "POINT")
    off.hide_render = True
    nodes = light("Nodes", "POINT", use_nodes=True)
    emission = next(n for n in nodes.data.node_tree.nodes if n.type == "EMISSION")
    emission.inputs["Strength"].default_value = 2.0
    emission.inputs["Color"].default_value = (0.5, 1, 1, 1)
    lights = {l["name"]: l for l in Shot().data["lights"]}
    assert "Gone" not in lights
    assert lights["Point"]["energy"] == 12.5 and abs(lights["Point"]["radius"] - 0.3) < 1e-6
    close(lights["Point"]["color"], (1, 0.5, 0.25))
    assert abs(lights["Spot"]["spot_angle"] - 1.2) < 1e-6 and lights["Sun"]["type"] == "sun"
    assert lights["Square"]["type"] == "rectangle" and lights["Square"]["size_y"] == 2
    assert lights["Disk"]["type"] == "ellipse" and lights["Ellipse"]["size_y"] == 3
    close(lights["Nodes"]["color"], (1, 2, 2))


def test_sky_texture_has_its_sun():
    """Irradiance of a Sky Texture's sun disc on a plane that faces it: the panorama keeps it."""
    world = bpy.data.worlds.new("Nishita")
    bpy.context.scene.world = world
    world.use_nodes = True
    tree = world.node_tree
    sky = node(tree, "TexSky")
    background = next(n for n in tree.nodes if n.type == "BACKGROUND")
    tree.links.new(sky.outputs[0], background.inputs["Color"])
    sums = []
    for disc in (False, True):
        sky.sun_disc, sky.sun_elevation, sky.sun_size = disc, 0.8, math.radians(2)
        texels = world_module.render_panorama(world, 512).data
        latitude = (np.arange(256) + 0.5) / 256 * math.pi - math.pi / 2
        solid_angle = np.cos(latitude)[:, None] * (math.pi / 256) ** 2
        sums.append(float((texels[..., 1] * solid_angle)[128:].sum()))
        high = np.unravel_index(texels[..., 1].argmax(), texels.shape[:2])
    assert sums[1] > 2 * sums[0] > 0.0, sums
    assert abs(latitude[high[0]] - 0.8) < 0.03


def test_tags():
    """What the artist set in Object.ajar and World.ajar; needs the add-on registered."""
    if not hasattr(bpy.types.Scene, "ajar"):
        return
    for name, tag in (("Ignored", "IGNORE"), ("Grid", "LIGHT_GRID"), ("Block", "OCCLUDER"), ("Lit", "AUTO")):
        quad(name).ajar.surface = tag
    light("Off", "POINT").ajar.light_role = "OFF"
    light("Static", "POINT").ajar.light_role = "STATIC"
    directional_world().ajar.sky_role = "OFF"
    _, mapping = layout_request()
    assert mapping.meshes == [("Lit", ["Lit"])]
    shot = Shot()
    assert "Ignored" not in [i["name"] for i in shot.data["instances"]]
    assert [(l["name"], l["role"]) for l in shot.data["lights"]] == [("Static", "static")]
    assert shot.data["sky"]["type"] == "none" and not shot.warned("Block", "lightmap")


run(globals())
