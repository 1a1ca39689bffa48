# SPDX-License-Identifier: GPL-3.0-or-later
"""Small scenes with light sets, doors and toggles."""
import bpy

SQUARE = ([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2, 3)])


def add(name, data=None, parent=None, collection=None, **options):
    """An object of some data; options are its attributes."""
    obj = bpy.data.objects.new(name, data)
    obj.parent = parent
    for key, value in options.items():
        setattr(obj, key, value)
    (collection or bpy.context.scene.collection).objects.link(obj)
    return obj


def quad(name, parent=None, collection=None, **options):
    """A unit square without a lightmap."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(SQUARE[0], [], SQUARE[1])
    obj = add(name, mesh, parent, collection, **options)
    obj.ajar.surface = "OCCLUDER"
    return obj


def lamp(name, light_set="", parent=None, collection=None):
    """A static point lamp."""
    obj = add(name, bpy.data.lights.new(name, "POINT"), parent, collection)
    obj.ajar.light_role, obj.ajar.light_set = "STATIC", light_set
    return obj


def glow(obj):
    """Makes an object emit."""
    material = bpy.data.materials.new("Glow")
    material.use_nodes = True
    tree = material.node_tree
    shader = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(shader.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    obj.data.materials.append(material)
    return obj


def collection(name, parent=None):
    """A collection of the scene."""
    made = bpy.data.collections.new(name)
    (parent or bpy.context.scene.collection).children.link(made)
    return made


def light_set(name, weight=1.0, combine=True):
    """An entry of the scene's list."""
    entry = bpy.context.scene.ajar.light_sets.add()
    entry.name, entry.weight, entry.combine = name, weight, combine
    return entry


def select(*objects):
    """Selects exactly these; the last becomes active."""
    bpy.context.view_layer.update()
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj in objects)
    bpy.context.view_layer.objects.active = objects[-1] if objects else None


def run_tests(tests, addon, wanted=()):
    """Runs the functions named test_* in empty files."""
    for name, function in list(tests.items()):
        if name.startswith("test_") and (not wanted or name in wanted):
            bpy.ops.wm.read_factory_settings(use_empty=True)
            if not hasattr(bpy.types.Scene, "ajar"):
                addon.register()
            function()
            print("ok  ", name, flush=True)
