# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiny scenes, one for each light type and size: a floor, a tilted and a mirrored plane, one light."""
import math

import bpy
from mathutils import Euler, Matrix

from . import cycles, scene
from .light_table import CASES

FLOOR = 1.2  # m, edge of the floor
PLACE = Matrix.Translation((0.3, 0.2, 1.5)) @ Euler((0.3, 0.1, 0.4)).to_matrix().to_4x4()


def lamp(kind, matrix=PLACE, scale=(1, 1, 1), **values):
    """A static lamp with the given properties."""
    data = bpy.data.lights.new("Lamp", kind)
    for name, value in values.items():
        setattr(data, name, value)
    obj = bpy.data.objects.new("Lamp", data)
    bpy.context.scene.collection.objects.link(obj)
    obj.matrix_world = matrix @ Matrix.Diagonal((*scale, 1))
    obj.ajar.light_role = 'STATIC'


def sun(**values):
    """A slanted static sun."""
    lamp('SUN', Euler((0.6, 0, 0)).to_matrix().to_4x4(), **values)


def emitter(principled=False, flip=False):
    """An emissive square of half a metre above the floor."""
    mesh = bpy.data.meshes.new("Emitter")
    corners = [(-0.25, -0.25, 0), (0.25, -0.25, 0), (0.25, 0.25, 0), (-0.25, 0.25, 0)]
    mesh.from_pydata(corners, [], [(0, 1, 2, 3) if flip else (3, 2, 1, 0)])
    mesh.materials.append(_emission_material(principled))
    obj = bpy.data.objects.new("Emitter", mesh)
    bpy.context.scene.collection.objects.link(obj)
    obj.location = (0.3, 0.2, 1.5)
    obj.ajar.surface = 'OCCLUDER'


def _emission_material(principled):
    material = bpy.data.materials.new("Emission")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    kind = 'ShaderNodeBsdfPrincipled' if principled else 'ShaderNodeEmission'
    node, output = tree.nodes.new(kind), tree.nodes.new('ShaderNodeOutputMaterial')
    node.inputs['Emission' if principled else 'Color'].default_value = (2, 1.5, 1, 1)
    node.inputs['Emission Strength' if principled else 'Strength'].default_value = 3
    if principled:
        node.inputs['Base Color'].default_value = (0, 0, 0, 1)
    tree.links.new(node.outputs[0], output.inputs['Surface'])
    return material


def sky(textured=False):
    """A constant sky, or one that differs in every direction."""
    world = bpy.data.worlds.new("World")
    world.use_nodes = True
    background = world.node_tree.nodes['Background']
    background.inputs['Color'].default_value = (0.7, 0.5, 0.3, 1)
    if textured:
        node = world.node_tree.nodes.new('ShaderNodeTexEnvironment')
        node.image = _ramp_image()
        world.node_tree.links.new(node.outputs[0], background.inputs['Color'])
    bpy.context.scene.world = world


def _ramp_image():
    """Smooth equirectangular picture: red grows with u, green with v, blue a bump."""
    width, height = 64, 32
    image = cycles.float_image("sky", width, height)
    pixels = []
    for y in range(height):
        for x in range(width):
            u, v = (x + 0.5) / width, (y + 0.5) / height
            pixels += [0.5 - 0.5 * math.cos(2 * math.pi * u), v, math.exp(-20 * (u - 0.3) ** 2), 1.0]
    image.pixels.foreach_set(pixels)
    image.pack()
    return image


def _plane(name, matrix, size, material):
    mesh = bpy.data.meshes.new(name)
    half = size / 2
    mesh.from_pydata(
        [(-half, -half, 0), (half, -half, 0), (half, half, 0), (-half, half, 0)], [], [(0, 1, 2, 3)]
    )
    mesh.materials.append(material)
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    obj.matrix_world = matrix


_BUILDERS = {'lamp': lamp, 'sun': sun, 'emitter': emitter, 'sky': sky}


def build_case(name):
    """Replace the open file by one case's scene."""
    cycles.clear_file()
    scene.register_addon()
    fill_case(name)


def fill_case(name):
    """Add one case's scene to an empty file. The planes do not shade one another's light."""
    grey = cycles.diffuse_material("Grey", (0.5, 0.5, 0.5))
    _plane("Floor", Matrix.Identity(4), FLOOR, grey)
    tilt = Matrix.Translation((0, 1.3, 0.3)) @ Euler((1.0, 0, 0)).to_matrix().to_4x4()
    _plane("Tilted", tilt, 0.5, grey)
    lean = Matrix.Translation((-1.3, 0, 0.3)) @ Euler((0, 0.8, 0)).to_matrix().to_4x4()
    _plane("Mirrored", lean @ Matrix.Diagonal((-1, 1, 1, 1)), 0.5, grey)
    builder, arguments = CASES[name]
    _BUILDERS[builder](**arguments)
