# SPDX-License-Identifier: GPL-3.0-or-later
"""Two toggles whose shadows from one lamp overlap, on a floor that a second lamp lights from the other side.

    blender -b --factory-startup --python-exit-code 1 -P examples/double_shadow.py -- double_shadow.blend [--fixed]

The case that "Semi-Dynamic Light Maps" gives as its limit (figure 17). --fixed leaves the boxes untagged: a
bake of that file is what both boxes together really do.
"""
import os
import sys

import bpy
from mathutils import Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import scene_kit as kit  # noqa: E402


def plain_material(name, color):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    shader.inputs["Specular"].default_value = 0.0
    return material


def box(name, center, size, color):
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=center)
    obj = bpy.context.object
    obj.name, obj.scale = name, size
    obj.data.materials.append(plain_material(name, color))
    return obj


def lamp(name, place, target, energy, color):
    data = bpy.data.lights.new(name, "SPOT")
    data.energy, data.color, data.spot_size, data.shadow_soft_size = energy, color, 1.2, 0.05
    obj = bpy.data.objects.new(name, data)
    obj.location = place
    obj.rotation_euler = (Vector(target) - Vector(place)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.collection.objects.link(obj)
    kit.tag(obj, light_role="STATIC", light_set=name)
    return obj


def build(fixed=False):
    """The scene; fixed: without toggles."""
    kit.start()
    bpy.ops.mesh.primitive_plane_add(size=6.0)
    floor = bpy.context.object
    floor.name = "Floor"
    floor.data.materials.append(plain_material("Floor", (0.7, 0.7, 0.7)))
    boxes = [
        box("Box A", (-1.2, 0.0, 0.6), (0.2, 1.6, 1.2), (0.8, 0.3, 0.2)),
        box("Box B", (-0.4, 0.4, 0.6), (0.2, 1.6, 1.2), (0.2, 0.4, 0.8)),
    ]
    for obj in boxes if not fixed else ():
        kit.tag(obj, movable="TOGGLE")
    kit.light_sets("P", "Q")
    lamp("P", (-3.5, 0.0, 3.2), (0.0, 0.0, 0.0), 400.0, (1.0, 0.8, 0.5))
    lamp("Q", (3.5, 0.0, 3.2), (0.0, 0.0, 0.0), 200.0, (0.5, 0.7, 1.0))


if __name__ == "__main__":
    fixed = "--fixed" in kit.arguments()
    build(fixed)
    kit.save("double_shadow.blend")
