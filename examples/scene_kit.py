# SPDX-License-Identifier: GPL-3.0-or-later
"""Pieces that the example scenes are built from. Lengths in metres, Z up."""
import math
import os
import sys

import bpy
import numpy as np
from mathutils import Vector

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


def arguments():
    """What stands behind `--` on Blender's command line."""
    return sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []


def register_addon():
    """Registers Ajar from this repository, unless it is enabled or not there."""
    if hasattr(bpy.types.Scene, "ajar") or not os.path.isfile(
        os.path.join(ROOT, "blender_addon", "__init__.py")
    ):
        return
    sys.path.insert(0, ROOT)
    import blender_addon

    blender_addon.register()


def start():
    """An empty scene in Cycles with the Standard view transform."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    register_addon()
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x, scene.render.resolution_y = 960, 540
    return scene


def save(default_name):
    path = os.path.abspath((arguments() or [default_name])[0])
    os.makedirs(os.path.dirname(path), exist_ok=True)
    bpy.ops.wm.save_as_mainfile(filepath=path, compress=True)


def tag(owner, **values):
    """Sets Ajar's properties where the add-on is registered."""
    settings = getattr(owner, "ajar", None)
    for name, value in values.items():
        if settings is not None and name in settings.bl_rna.properties:
            setattr(settings, name, value)


def attach(child, parent):
    """Parents an object so that it stays where it is."""
    child.parent = parent
    child.matrix_parent_inverse = parent.matrix_basis.inverted()
    return child


def door(leaf, pose, **values):
    """Makes a door of its closed leaf and of the leaf as it stands when open. The pose and what is
    attached to it go to a hidden collection: they are there while the door is open."""
    tag(leaf, movable="DOOR", open_pose=pose, **values)
    hidden = bpy.data.collections.get("Open doors")
    if hidden is None:
        hidden = bpy.data.collections.new("Open doors")
        bpy.context.scene.collection.children.link(hidden)
        hidden.hide_render = hidden.hide_viewport = True
    for obj in (pose, *pose.children):
        for collection in obj.users_collection:
            collection.objects.unlink(obj)
        hidden.objects.link(obj)
    return leaf


def light_sets(*names):
    """Declares the sets that lights and glowing meshes are tagged with."""
    declared = getattr(getattr(bpy.context.scene, "ajar", None), "light_sets", None)
    if declared is not None:
        for name in names:
            declared.add().name = name


# ---- images and materials -------------------------------------------------------------------


def image(name, pixels, is_float=False):
    """A packed image from an array (height, width, 3 or 4)."""
    height, width, channels = pixels.shape
    rgba = np.ones((height, width, 4), np.float32)
    rgba[..., :channels] = pixels
    result = bpy.data.images.new(name, width, height, alpha=channels == 4, float_buffer=is_float)
    result.pixels.foreach_set(rgba.ravel())
    result.update()
    result.pack()
    return result


def _node_material(name):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    return material, material.node_tree.nodes, material.node_tree.links


def _texture(nodes, picture):
    node = nodes.new("ShaderNodeTexImage")
    node.image = picture
    node.location = (-320, 280)
    return node


def _specular(shader):
    return shader.inputs.get("Specular") or shader.inputs["Specular IOR Level"]


def surface(
    name, color=(0.8, 0.8, 0.8), picture=None, roughness=0.8, metallic=0.0, specular=0.3, cutout=False
):
    """Principled material of one colour or picture; a cutout also takes its alpha."""
    material, nodes, links = _node_material(name)
    shader = nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    shader.inputs["Roughness"].default_value = roughness
    shader.inputs["Metallic"].default_value = metallic
    _specular(shader).default_value = specular
    if picture is not None:
        texture = _texture(nodes, picture)
        links.new(texture.outputs["Color"], shader.inputs["Base Color"])
        if cutout:
            links.new(texture.outputs["Alpha"], shader.inputs["Alpha"])
    if cutout and hasattr(material, "blend_method"):
        material.blend_method = "CLIP"
    material.diffuse_color = (*color, 1.0)
    return material


def matte(name, color):
    """Plain diffuse material."""
    material, nodes, links = _node_material(name)
    nodes.remove(nodes["Principled BSDF"])
    shader = nodes.new("ShaderNodeBsdfDiffuse")
    shader.inputs["Color"].default_value = (*color, 1.0)
    links.new(shader.outputs["BSDF"], nodes["Material Output"].inputs["Surface"])
    material.diffuse_color = (*color, 1.0)
    return material


def glowing(name, color, strength):
    """Emission of color * strength, W/(m^2 sr)."""
    material, nodes, links = _node_material(name)
    nodes.remove(nodes["Principled BSDF"])
    shader = nodes.new("ShaderNodeEmission")
    shader.inputs["Color"].default_value = (*color, 1.0)
    shader.inputs["Strength"].default_value = strength
    links.new(shader.outputs["Emission"], nodes["Material Output"].inputs["Surface"])
    return material


def tinted(name, picture):
    """A thin pane that lets through what the picture says."""
    material, nodes, links = _node_material(name)
    nodes.remove(nodes["Principled BSDF"])
    shader = nodes.new("ShaderNodeBsdfTransparent")
    links.new(_texture(nodes, picture).outputs["Color"], shader.inputs["Color"])
    links.new(shader.outputs["BSDF"], nodes["Material Output"].inputs["Surface"])
    if hasattr(material, "blend_method"):
        material.blend_method = "BLEND"
    return material


def sky_world(picture, strength=1.0):
    world = bpy.data.worlds.new("Sky")
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    environment = nodes.new("ShaderNodeTexEnvironment")
    environment.image = picture
    links.new(environment.outputs["Color"], nodes["Background"].inputs["Color"])
    nodes["Background"].inputs["Strength"].default_value = strength
    bpy.context.scene.world = world
    return world


# ---- meshes ---------------------------------------------------------------------------------


def place(name, data, location=(0, 0, 0), turn=0.0):
    """An object of this data, turned about Z by degrees; objects may share data."""
    result = bpy.data.objects.new(name, data)
    result.location = location
    result.rotation_euler = (0.0, 0.0, math.radians(turn))
    bpy.context.scene.collection.objects.link(result)
    return result


def _box_uvs(mesh, meters):
    """Texture UVs projected along each face's main axis; one repeat every `meters`."""
    layer = mesh.uv_layers.new(name="UVMap").data
    for polygon in mesh.polygons:
        normal = [abs(c) for c in polygon.normal]
        axis = normal.index(max(normal))
        u, v = ((1, 2), (0, 2), (0, 1))[axis]
        for corner in polygon.loop_indices:
            position = mesh.vertices[mesh.loops[corner].vertex_index].co
            layer[corner].uv = (position[u] / meters, position[v] / meters)


def mesh(name, vertices, faces, materials, slots=None, meters=1.0, smooth=False):
    """Mesh data with texture UVs; slots gives each face its place in materials."""
    result = bpy.data.meshes.new(name)
    result.from_pydata(vertices, [], faces)
    for material in materials:
        result.materials.append(material)
    if slots is not None:
        result.polygons.foreach_set("material_index", slots)
    result.polygons.foreach_set("use_smooth", [smooth] * len(faces))
    result.update()
    _box_uvs(result, meters)
    return result


_BOX_FACES = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (2, 3, 7, 6), (1, 2, 6, 5), (3, 0, 4, 7)]


def boxes(name, extents, material, meters=1.0):
    """One mesh of axis-aligned boxes, each given by its lowest and highest corner."""
    vertices, faces = [], []
    for (x0, y0, z0), (x1, y1, z1) in extents:
        first = len(vertices)
        ring = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        vertices += [(x, y, z0) for x, y in ring] + [(x, y, z1) for x, y in ring]
        faces += [tuple(first + i for i in face) for face in _BOX_FACES]
    return mesh(name, vertices, faces, [material], meters=meters)


def box(name, low, high, material, meters=1.0):
    return place(name, boxes(name, [(low, high)], material, meters))


def pane(name, corners, material):
    """A quad whose texture fills it once; corners from bottom left, counter-clockwise."""
    data = mesh(name, corners, [(0, 1, 2, 3)], [material])
    for corner, uv in zip(data.uv_layers[0].data, ((0, 0), (1, 0), (1, 1), (0, 1))):
        corner.uv = uv
    return place(name, data)


def wall(name, axis, depth, span, height, holes, materials, meters=1.0):
    """An upright wall with rectangular holes.

    axis     0 or 1: the axis that the wall is thin along
    depth    its extent along that axis; span: along the other; height: along Z
    holes    (low, high, bottom, top) each
    materials  of the low side, the high side and the reveals
    """
    us = sorted({*span, *(u for hole in holes for u in hole[:2])})
    zs = sorted({*height, *(z for hole in holes for z in hole[2:])})

    def solid(i, j):
        if not (0 <= i < len(us) - 1 and 0 <= j < len(zs) - 1):
            return False
        u, z = (us[i] + us[i + 1]) / 2, (zs[j] + zs[j + 1]) / 2
        return not any(h[0] < u < h[1] and h[2] < z < h[3] for h in holes)

    def index(i, j, side):
        return (i * len(zs) + j) * 2 + side

    def point(u, z, side):
        return (depth[side], u, z) if axis == 0 else (u, depth[side], z)

    vertices = [point(u, z, side) for u in us for z in zs for side in (0, 1)]
    faces, slots = [], []

    def add(corners, slot):
        faces.append(corners if axis == 0 else corners[::-1])
        slots.append(slot)

    for i in range(len(us) - 1):
        for j in range(len(zs) - 1):
            if not solid(i, j):
                continue
            add((index(i, j, 0), index(i, j + 1, 0), index(i + 1, j + 1, 0), index(i + 1, j, 0)), 0)
            add((index(i, j, 1), index(i + 1, j, 1), index(i + 1, j + 1, 1), index(i, j + 1, 1)), 1)
            for (di, dj), (a, b) in {
                (-1, 0): ((i, j), (i, j + 1)),
                (1, 0): ((i + 1, j + 1), (i + 1, j)),
                (0, -1): ((i + 1, j), (i, j)),
                (0, 1): ((i, j + 1), (i + 1, j + 1)),
            }.items():
                if not solid(i + di, j + dj):
                    add((index(*a, 0), index(*a, 1), index(*b, 1), index(*b, 0)), 2)
    return place(name, mesh(name, vertices, faces, materials, slots, meters))


def cylinder(name, center, radius, height, material, segments=32, meters=1.0):
    """An upright column with smooth sides, open at both ends."""
    ring = [
        (radius * math.cos(a), radius * math.sin(a))
        for a in np.linspace(0, 2 * math.pi, segments, endpoint=False)
    ]
    vertices = [(x, y, 0) for x, y in ring] + [(x, y, height) for x, y in ring]
    faces = [(i, (i + 1) % segments, (i + 1) % segments + segments, i + segments) for i in range(segments)]
    return place(name, mesh(name, vertices, faces, [material], meters=meters, smooth=True), center)


def sphere(name, center, radius, material, rings=16, segments=32):
    """A ball with smooth normals."""
    vertices = [(0, 0, -radius)]
    for t in np.linspace(-math.pi / 2, math.pi / 2, rings + 1)[1:-1]:
        for a in np.linspace(0, 2 * math.pi, segments, endpoint=False):
            vertices.append(
                (radius * math.cos(t) * math.cos(a), radius * math.cos(t) * math.sin(a), radius * math.sin(t))
            )
    vertices.append((0, 0, radius))
    top, last = len(vertices) - 1, len(vertices) - 1 - segments
    faces = []
    for s in range(segments):
        n = (s + 1) % segments
        faces += [(0, 1 + n, 1 + s), (top, last + s, last + n)]
        for r in range(rings - 2):
            a, b = 1 + r * segments, 1 + (r + 1) * segments
            faces.append((a + s, a + n, b + n, b + s))
    return place(name, mesh(name, vertices, faces, [material], smooth=True), center)


def tubes(name, lines, radius, material, location=(0, 0, 0), rotation=(0, 0, 0)):
    """Bent round tubes along 2D lines in the XY plane, turned by rotation (degrees), as one mesh."""
    curve = bpy.data.curves.new(name, "CURVE")
    curve.dimensions = "3D"
    curve.bevel_depth, curve.bevel_resolution, curve.use_fill_caps = radius, 1, True
    for line in lines:
        spline = curve.splines.new("POLY")
        spline.points.add(len(line) - 1)
        for knot, (x, y) in zip(spline.points, line):
            knot.co = (x, y, 0.0, 1.0)
    drawn = place(name + " curve", curve)
    data = bpy.data.meshes.new_from_object(drawn.evaluated_get(bpy.context.evaluated_depsgraph_get()))
    bpy.data.objects.remove(drawn)
    bpy.data.curves.remove(curve)
    data.name = name
    data.materials.clear()
    data.materials.append(material)
    result = place(name, data, location)
    result.rotation_euler = [math.radians(a) for a in rotation]
    return result


def text(name, words, size, material, location, rotation):
    """A text object, left as text; rotation in degrees."""
    curve = bpy.data.curves.new(name, "FONT")
    curve.body, curve.size, curve.extrude = words, size, 0.01
    curve.align_x = curve.align_y = "CENTER"
    curve.materials.append(material)
    result = place(name, curve, location)
    result.rotation_euler = [math.radians(a) for a in rotation]
    return result


# ---- lights and cameras ---------------------------------------------------------------------


def light(
    name, kind, location, energy, color=(1, 1, 1), target=None, role="STATIC", light_set="", **settings
):
    """A lamp; energy in W (sun: W/m^2); it looks at target, or down."""
    data = bpy.data.lights.new(name, kind)
    data.energy, data.color = energy, color
    for key, value in settings.items():
        setattr(data, key, value)
    result = bpy.data.objects.new(name, data)
    result.location = location
    if target is not None:
        result.rotation_euler = (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(result)
    tag(result, light_role=role, light_set=light_set)
    return result


def camera(name, location, target, lens=20.0):
    data = bpy.data.cameras.new(name)
    data.lens, data.clip_start = lens, 0.05
    result = bpy.data.objects.new(name, data)
    result.location = location
    result.rotation_euler = (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(result)
    return result
