# SPDX-License-Identifier: GPL-3.0-or-later
"""Small scenes, each for something that a judge of baked light must get right. Every builder fills an empty file;
what it returns are objects that Cycles has to hide to show the state that the elements start in."""
import math

import bpy
import numpy as np
from mathutils import Matrix, Vector

from . import cycles, light_cases

GREY, WARM, BLUE = (0.7, 0.7, 0.7), (0.8, 0.55, 0.3), (0.3, 0.45, 0.8)


def make_mesh(name, points, faces, material, occluder=False, smooth=False):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points, [], faces)
    mesh.materials.append(material)
    if smooth:
        mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    mesh.update()
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    if occluder:
        obj.ajar.surface = 'OCCLUDER'
    return obj


def make_quad(name, points, material, **options):
    return make_mesh(name, points, [(0, 1, 2, 3)], material, **options)


def make_box(name, low, high, material, **options):
    (x0, y0, z0), (x1, y1, z1) = low, high
    points = [(x, y, z) for z in (z0, z1) for y in (y0, y1) for x in (x0, x1)]
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return make_mesh(name, points, faces, material, **options)


def _corner():
    """A floor of 3 x 3 m and two walls of 2 m."""
    grey, warm = cycles.diffuse_material("Grey", GREY), cycles.diffuse_material("Warm", WARM)
    make_quad("Floor", [(0, 0, 0), (3, 0, 0), (3, 3, 0), (0, 3, 0)], grey)
    make_quad("Back", [(0, 3, 0), (3, 3, 0), (3, 3, 2), (0, 3, 2)], warm)
    make_quad("Left", [(0, 0, 0), (0, 3, 0), (0, 3, 2), (0, 0, 2)], grey)


def lamp_at(kind, at, towards=None, **values):
    """A static lamp, aimed at a place."""
    matrix = Matrix.Translation(at)
    if towards is not None:
        matrix = matrix @ (Vector(towards) - Vector(at)).to_track_quat('-Z', 'Y').to_matrix().to_4x4()
    light_cases.lamp(kind, matrix, **values)
    return bpy.context.scene.collection.objects[-1]


def _nodes(name):
    """(material, tree, output) without nodes but the output."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.node_tree.nodes.clear()
    return material, material.node_tree, material.node_tree.nodes.new('ShaderNodeOutputMaterial')


def _shader(tree, kind, color=None, **inputs):
    node = tree.nodes.new('ShaderNode' + kind)
    if color is not None:
        node.inputs['Color'].default_value = (*color, 1)
    for key, value in inputs.items():
        node.inputs[key].default_value = value
    return node


def _glow(strength):
    material, tree, output = _nodes("Glow")
    emission = _shader(tree, 'Emission', (1, 0.8, 0.5), Strength=strength)
    tree.links.new(emission.outputs[0], output.inputs['Surface'])
    return material


def lamps():
    """Point, spot and sun, each with extent, and a box in their light."""
    _corner()
    make_box("Box", (1.6, 1.4, 0.2), (2.3, 2.1, 0.8), cycles.diffuse_material("Blue", BLUE))
    lamp_at('POINT', (0.8, 0.9, 1.4), energy=40, shadow_soft_size=0.1)
    lamp_at(
        'SPOT',
        (2.4, 0.4, 1.8),
        (1.5, 2.5, 0),
        energy=150,
        shadow_soft_size=0.05,
        spot_size=1.1,
        spot_blend=0.4,
    )
    lamp_at('SUN', (0, 0, 3), (-1, 1, 0.4), energy=1.0, angle=0.2)


def areas():
    """A slanted rectangle, a disk of narrow spread, an ellipse scaled by its object."""
    _corner()
    lamp_at('AREA', (0.7, 0.8, 1.5), (1.5, 2.5, 0.5), energy=20, shape='RECTANGLE', size=0.8, size_y=0.3)
    lamp_at(
        'AREA', (2.2, 1.2, 1.8), (2.0, 1.5, 0), energy=10, shape='DISK', size=0.5, spread=math.radians(70)
    )
    lamp_at(
        'AREA',
        (1.5, 0.2, 0.6),
        (1.5, 3, 0.9),
        energy=10,
        shape='ELLIPSE',
        size=0.3,
        size_y=0.5,
        scale=(1, 2, 1),
    )


def sky():
    """A sky of many colours under a roof with a gap."""
    _corner()
    make_box("Roof", (-0.2, 1.0, 2.1), (3.2, 3.2, 2.3), cycles.diffuse_material("Roof", WARM))
    light_cases.sky(textured=True)


def emissive():
    """A glowing sheet, seen from both sides, and a glowing solid."""
    _corner()
    make_quad(
        "Sheet", [(0.6, 0.8, 1.2), (1.3, 0.8, 1.0), (1.3, 1.5, 1.3), (0.6, 1.5, 1.5)], _glow(4), occluder=True
    )
    make_box("Lantern", (2.0, 1.8, 0.3), (2.3, 2.1, 0.7), _glow(6), occluder=True)


def glass():
    """A red pane and one of half glass, half paint between a lamp and the floor."""
    _corner()
    clear, tree, output = _nodes("Red Glass")
    tree.links.new(_shader(tree, 'BsdfTransparent', (0.9, 0.2, 0.15)).outputs[0], output.inputs['Surface'])
    make_quad("Pane", [(0.1, 0.1, 1), (1.5, 0.1, 1), (1.5, 2.9, 1), (0.1, 2.9, 1)], clear, occluder=True)
    half, tree, output = _nodes("Gauze")
    mix = tree.nodes.new('ShaderNodeMixShader')
    tree.links.new(_shader(tree, 'BsdfTransparent', (1, 1, 1)).outputs[0], mix.inputs[1])
    tree.links.new(_shader(tree, 'BsdfDiffuse', BLUE).outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], output.inputs['Surface'])
    make_quad("Gauze", [(1.5, 0.1, 1), (2.9, 0.1, 1), (2.9, 2.9, 1), (1.5, 2.9, 1)], half, occluder=True)
    lamp_at('POINT', (1.5, 1.4, 1.7), energy=60, shadow_soft_size=0.1)
    light_cases.sky()


def smooth():
    """A wavy floor with smooth normals under a lamp high above: no terminator is near."""
    edge = np.linspace(0, 3, 25)
    points = [(x, y, 0.06 * math.sin(2.5 * x) * math.cos(2.0 * y)) for y in edge for x in edge]
    faces = [
        (r * 25 + c, r * 25 + c + 1, r * 25 + c + 26, r * 25 + c + 25) for r in range(24) for c in range(24)
    ]
    make_mesh("Waves", points, faces, cycles.diffuse_material("Grey", GREY), smooth=True)
    warm = cycles.diffuse_material("Warm", WARM)
    make_quad("Back", [(0, 3.3, 0), (3, 3.3, 0), (3, 3.3, 2), (0, 3.3, 2)], warm)
    lamp_at('AREA', (1.5, 1.5, 2.5), energy=60, shape='SQUARE', size=0.6)


def sheets():
    """Walls seen from behind: of plain sheets, which Cycles and Ajar show from both sides, and one whose back is
    culled, which Ajar takes for black there."""
    _corner()
    sheet, culled = cycles.diffuse_material("Sheet", WARM), cycles.diffuse_material("Culled", BLUE)
    culled.use_backface_culling = True
    make_quad("Right", [(3, 0, 0), (3, 0, 2), (3, 3, 2), (3, 3, 0)][::-1], sheet, occluder=True)
    make_quad("Front", [(0, 0, 0), (3, 0, 0), (3, 0, 2), (0, 0, 2)][::-1], culled, occluder=True)
    lamp_at('POINT', (1.2, 1.3, 1.5), energy=40, shadow_soft_size=0.1)


def occluders():
    """A closed room most of whose surfaces have no lightmap, with a lamp close to one of them."""
    _corner()
    make_quad(
        "Ceiling",
        [(0, 0, 2), (0, 3, 2), (3, 3, 2), (3, 0, 2)],
        cycles.diffuse_material("Ceiling", GREY),
        occluder=True,
    )
    make_quad(
        "Right",
        [(3, 0, 0), (3, 0, 2), (3, 3, 2), (3, 3, 0)],
        cycles.diffuse_material("Right", BLUE),
        occluder=True,
    )
    make_quad(
        "Front",
        [(0, 0, 0), (0, 0, 2), (3, 0, 2), (3, 0, 0)],
        cycles.diffuse_material("Front", WARM),
        occluder=True,
    )
    make_box("Crate", (1.7, 1.5, 0.2), (2.4, 2.2, 0.7), cycles.diffuse_material("Crate", WARM), occluder=True)
    lamp_at(
        'SPOT',
        (1.5, 1.5, 1.0),
        (1.4, 1.4, 2.0),
        energy=80,
        shadow_soft_size=0.1,
        spot_size=1.6,
        spot_blend=0.5,
    )


def state():
    """A lamp at half its weight, a door that stands open and a toggle that is away."""
    _corner()
    scene, grey = bpy.context.scene, cycles.diffuse_material("Leaf", GREY)
    entry = scene.ajar.light_sets.add()
    entry.name, entry.weight = "lamp", 0.5
    lamp = lamp_at('POINT', (2.4, 0.8, 1.4), energy=80, shadow_soft_size=0.1)
    lamp.ajar.light_set = "lamp"
    make_box("Wall", (1.4, 0.06, 0.06), (1.5, 1.0, 2.0), grey, occluder=True)
    door = make_box("Door", (1.42, 1.03, 0.06), (1.48, 2.0, 1.95), grey, occluder=True)
    door.ajar.movable, door.ajar.openness = 'DOOR', 1.0
    crate = make_box("Crate", (0.5, 1.2, 0.1), (1.0, 1.7, 0.6), grey, occluder=True)
    crate.ajar.movable, crate.ajar.presence = 'TOGGLE', 0.0
    light_cases.sky()
    return [door, crate], [(lamp.data, 0.5)]


def instances():
    """One mesh placed thrice: mirrored, sheared by its parent's scale, and flat; and a collection of it."""
    _corner()
    first = make_box("Part", (-0.25, -0.2, -0.15), (0.25, 0.2, 0.15), cycles.diffuse_material("Part", BLUE))
    first.matrix_world = Matrix.Translation((0.8, 0.8, 0.4)) @ Matrix.Diagonal((-1, 1, 1.5, 1))
    sheared = bpy.data.objects.new("Sheared", first.data)
    bpy.context.scene.collection.objects.link(sheared)
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.scale, parent.location = (1.6, 0.8, 1), (2.0, 1.0, 0.6)
    sheared.parent, sheared.rotation_euler = parent, (0.2, 0.3, 0.7)
    group = bpy.data.collections.new("Group")
    member = bpy.data.objects.new("Member", first.data)
    member.location = (0, 0, 0.3)
    group.objects.link(member)
    for place in ((1.0, 2.2, 0.2), (2.1, 2.3, 0.5)):
        instancer = bpy.data.objects.new("Instancer", None)
        instancer.instance_type, instancer.instance_collection = 'COLLECTION', group
        instancer.location, instancer.rotation_euler = place, (0, 0, 0.5)
        bpy.context.scene.collection.objects.link(instancer)
    lamp_at('POINT', (1.4, 1.4, 1.6), energy=40, shadow_soft_size=0.15)


def visibility():
    """A glowing sheet and a box that diffuse rays do not see, a glowing sheet and a box without shadow."""
    _corner()
    blue = cycles.diffuse_material("Blue", BLUE)
    unseen = make_quad(
        "Unseen",
        [(1.0, 1.0, 1.6), (1.6, 1.0, 1.6), (1.6, 1.6, 1.6), (1.0, 1.6, 1.6)],
        _glow(5),
        occluder=True,
    )
    box = make_box("Shadow Only", (0.6, 1.9, 0.3), (1.1, 2.4, 0.8), blue, occluder=True)
    unseen.visible_diffuse = box.visible_diffuse = False
    sheet = make_quad(
        "Sheet", [(2.0, 0.6, 1.2), (2.5, 0.6, 1.0), (2.5, 1.1, 1.2), (2.0, 1.1, 1.4)], _glow(5), occluder=True
    )
    other = make_box("No Shadow", (1.9, 1.9, 0.3), (2.4, 2.4, 0.8), blue, occluder=True)
    sheet.visible_shadow = other.visible_shadow = False
    lamp_at('POINT', (1.5, 1.4, 1.7), energy=20, shadow_soft_size=0.1)


def beams():
    """An area lamp whose spread is 8 degrees, a sun 80 degrees wide, a lamp without shadow."""
    _corner()
    lamp_at(
        'AREA', (1.3, 1.2, 1.8), (1.5, 1.6, 0), energy=4, shape='SQUARE', size=1.0, spread=math.radians(8)
    )
    lamp_at('SUN', (0, 0, 3), (-1, 1, 1), energy=1.0, angle=math.radians(80))
    make_box("Box", (1.9, 1.6, 0.3), (2.4, 2.1, 0.7), cycles.diffuse_material("Blue", BLUE), occluder=True)
    lamp_at('POINT', (2.2, 1.8, 1.1), energy=8, shadow_soft_size=0.1, use_shadow=False)


def tilted():
    """A floor whose normals lean by 25 degrees, away from a lit wall and towards it."""
    _corner()
    grey = cycles.diffuse_material("Leaning", GREY)
    for name, x, lean in (("Away", 0.3, -1), ("Towards", 1.7, 1)):
        obj = make_quad(
            name, [(x, 0.5, 0.3), (x + 1, 0.5, 0.3), (x + 1, 2.5, 0.3), (x, 2.5, 0.3)], grey, smooth=True
        )
        obj.data.use_auto_smooth = True
        normal = (0.0, math.sin(math.radians(25)) * lean, math.cos(math.radians(25)))
        obj.data.normals_split_custom_set([normal] * 4)
    lamp_at('AREA', (1.5, 1.0, 1.8), (1.5, 3, 1), energy=60, shape='SQUARE', size=0.5)


CASES = (
    lamps,
    areas,
    sky,
    emissive,
    glass,
    smooth,
    sheets,
    occluders,
    state,
    instances,
    visibility,
    beams,
    tilted,
)
