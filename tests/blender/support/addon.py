# SPDX-License-Identifier: GPL-3.0-or-later
"""Loads the add-on from the source tree the way batch bakes do, and makes packages by hand."""
import contextlib
import importlib.util
import json
import os
import struct
import sys

import bpy
import numpy

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
ADDON = os.path.join(ROOT, "blender_addon")


def load_addon(name=os.environ.get("AJAR_ADDON_MODULE", "ajar")):
    """The add-on, registered: the enabled one, else the one of the source tree."""
    if hasattr(bpy.types.Scene, "ajar"):
        return sys.modules[name]
    place = os.path.join(ADDON, "__init__.py")
    spec = importlib.util.spec_from_file_location(name, place, submodule_search_locations=[ADDON])
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    module.register()
    return module


@contextlib.contextmanager
def cancelling(manager, fraction):
    """Jobs that run inside are cancelled once their worker has come further than a fraction."""
    step = manager.step

    def cancel_in_worker():
        if manager.job.worker is not None and manager.status.fraction > fraction:
            manager.cancel()
        return step()

    manager.step = cancel_in_worker
    try:
        yield
    finally:
        del manager.step
    assert manager.last.result == "cancelled", manager.last.message
    assert not manager.running


def build_room():
    """A closed room with a lamp, two boxes that share a mesh, and a curve; the active scene is
    emptied first. Returns the scene."""
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    scene = bpy.context.scene
    bpy.ops.mesh.primitive_cube_add(size=4)
    room = bpy.context.object
    room.name = room.data.name = "Room"
    room.data.flip_normals()
    material = bpy.data.materials.new("Wall")
    material.use_nodes = True
    material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.6, 0.5, 0.4, 1.0)
    room.data.materials.append(material)
    bpy.ops.mesh.primitive_cube_add(size=0.8, location=(1, 0, -1.6))
    box = bpy.context.object
    box.name = box.data.name = "Box"
    other = bpy.data.objects.new("Other Box", box.data)
    other.location = (-1, 0.5, -1.6)
    scene.collection.objects.link(other)
    bpy.ops.curve.primitive_bezier_circle_add(radius=0.3)
    bpy.context.object.data.bevel_depth = 0.05
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    lamp.data.energy, lamp.location = 100.0, (0.2, 0.3, 1.0)
    lamp.ajar.light_role = "STATIC"
    scene.collection.objects.link(lamp)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0, -1.8, 0), (1.4, 0, 0)
    camera.data.angle = 1.5
    scene.collection.objects.link(camera)
    scene.camera = camera
    return scene


def write_package(folder, pages):
    """A package of constant pages: pages is [(r, g, b)]. Returns its folder."""
    package = os.path.join(folder, "package")
    os.makedirs(package, exist_ok=True)
    entries = []
    for index, color in enumerate(pages):
        name = f"page_{index}.irradiance.exr"
        write_exr(os.path.join(package, name), 16, 16, lambda x, y, color=color: color)
        entries.append({"width": 16, "height": 16, "irradiance": name})
    write_manifest(package, entries)
    return package


def write_manifest(package, entries):
    """manifest.json with the given pages."""
    with open(os.path.join(package, "manifest.json"), "w", encoding="utf-8") as file:
        json.dump({"version": 1, "minVersion": 1, "name": "test", "pages": entries}, file)


def write_exr(path, width, height, shade):
    """An uncompressed float32 RGB EXR; shade(x, y) is called with y = 0 at the bottom row. Blender's
    own Image.save() would encode the values."""
    pixels = numpy.array([[shade(x, y) for x in range(width)] for y in range(height)], dtype="<f4")
    box = struct.pack("<4i", 0, 0, width - 1, height - 1)
    channels = (
        b"".join(name + b"\0" + struct.pack("<iB3xii", 2, 0, 1, 1) for name in (b"B", b"G", b"R")) + b"\0"
    )
    header = [
        ("channels", "chlist", channels),
        ("compression", "compression", b"\0"),
        ("dataWindow", "box2i", box),
        ("displayWindow", "box2i", box),
        ("lineOrder", "lineOrder", b"\0"),
        ("pixelAspectRatio", "float", struct.pack("<f", 1)),
        ("screenWindowCenter", "v2f", bytes(8)),
        ("screenWindowWidth", "float", struct.pack("<f", 1)),
    ]
    data = struct.pack("<II", 20000630, 2)
    for name, kind, value in header:
        data += name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<I", len(value)) + value
    data += b"\0"
    line = 8 + 12 * width
    first = len(data) + 8 * height
    data += b"".join(struct.pack("<Q", first + line * y) for y in range(height))
    for y in range(height):
        row = pixels[height - 1 - y]
        data += struct.pack("<iI", y, 12 * width) + row[:, ::-1].T.tobytes()
    with open(path, "wb") as file:
        file.write(data)


def render_pixels(folder, size=(64, 64), samples=16):
    """Renders the scene with Cycles in linear light; returns (height, width, 4), bottom row first."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = samples
    scene.cycles.use_denoising = False
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.pixel_filter_type = "BOX"
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = os.path.join(folder, "render.exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath, check_existing=False)
    pixels = numpy.empty(len(image.pixels), dtype=numpy.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels.reshape(size[1], size[0], 4)
