# SPDX-License-Identifier: GPL-3.0-or-later
"""Small scenes for tests of the extraction, read back from the snapshot they give."""
import importlib
import math
import os
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True
import bpy
import numpy as np

ROOT = Path(os.environ.get("AJAR_ROOT", Path(__file__).resolve().parents[3]))
sys.path.insert(0, str(ROOT))
MODULE = os.environ.get("AJAR_ADDON_MODULE", "blender_addon")
snapshot = importlib.import_module(MODULE + ".extract.snapshot")
layout_module = importlib.import_module(MODULE + ".extract.layout")
world_module = importlib.import_module(MODULE + ".extract.world")
color_module = importlib.import_module(MODULE + ".extract.node_color")
model = importlib.import_module(MODULE + ".model")
Reader = importlib.import_module(MODULE + ".bridge.snapshot_io").Reader

QUAD = ([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2, 3)])


# ---- helpers --------------------------------------------------------------------------------


class Shot:
    """A snapshot read back: data, result, and arrays by reference."""

    def __init__(self, layout=None):
        with tempfile.TemporaryDirectory() as folder:
            self.result = snapshot.write_snapshot(bpy.context, folder, model.engine_settings("DRAFT"), layout)
            self._reader = Reader(folder)
            self.data = self._reader.data
            self.arrays = {}
            for mesh in self.data["meshes"]:
                mesh["uv_layers"] = [self.array(r, "f32", 3, 2) for r in mesh["uv_layers"]]
                mesh["color_layers"] = [self.array(r, "f32", 3, 4) for r in mesh["color_layers"]]
                mesh["positions"] = self.array(mesh["positions"], "f32", 3)
                mesh["corner_vertex"] = self.array(mesh["corner_vertex"], "u32", 3)
                if mesh["corner_normals"]:
                    mesh["corner_normals"] = self.array(mesh["corner_normals"], "f32", 3, 3)
            for texture in self.data["textures"]:
                kind = texture["texel"]
                texture["texels"] = self.array(texture["texels"], kind, texture["width"], 4)
            self._reader.close()

    def array(self, reference, kind, *shape):
        return np.array(self._reader.values(reference, kind)).reshape(-1, *shape)

    def instance(self, name):
        return next(i for i in self.data["instances"] if i["name"] == name)

    def mesh(self, name):
        return self.data["meshes"][self.instance(name)["mesh"]]

    def material(self, name, slot=0):
        return self.data["materials"][self.instance(name)["materials"][slot]]

    def closures(self, name, slot=0):
        return self.material(name, slot)["closures"]

    def warned(self, culprit, part):
        return any(c == culprit and part in t for c, t in self.result.warnings)


def reset():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    enabled = os.environ.get("AJAR_ADDON_MODULE")
    if enabled:
        bpy.ops.preferences.addon_enable(module=enabled)


def add(name, data=None, **options):
    obj = bpy.data.objects.new(name, data)
    for key, value in options.items():
        setattr(obj, key, value)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def quad_mesh(name, uv=True):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(QUAD[0], [], QUAD[1])
    if uv:
        layer = mesh.uv_layers.new(name="UVMap")
        for loop in mesh.loops:
            layer.data[loop.index].uv = mesh.vertices[loop.vertex_index].co[:2]
    return mesh


def quad(name, material=None, **options):
    mesh = quad_mesh(name)
    if material is not None:
        mesh.materials.append(material)
    return add(name, mesh, **options)


def tree_material(name):
    """(material, tree, output node) with an empty tree."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.node_tree.nodes.clear()
    output = material.node_tree.nodes.new("ShaderNodeOutputMaterial")
    return material, material.node_tree, output


def surface(name, build):
    """A quad whose material's surface is the shader socket that build(tree) returns."""
    material, tree, output = tree_material(name)
    tree.links.new(build(tree), output.inputs["Surface"])
    quad(name, material)
    return material


def node(tree, kind, inputs=None, **options):
    made = tree.nodes.new("ShaderNode" + kind)
    for key, value in options.items():
        setattr(made, key, value)
    for key, value in (inputs or {}).items():
        if isinstance(value, bpy.types.NodeSocket):
            tree.links.new(value, made.inputs[key])
        else:
            made.inputs[key].default_value = value
    return made


def image(name, pixels, colorspace="Non-Color", is_float=False):
    """Image of (height, width, 4) values, bottom row first."""
    pixels = np.asarray(pixels, dtype=np.float32)
    made = bpy.data.images.new(name, pixels.shape[1], pixels.shape[0], alpha=True, float_buffer=is_float)
    made.colorspace_settings.name = colorspace
    made.pixels.foreach_set(pixels.reshape(-1))
    made.pack()
    return made


def close(a, b, tolerance=1e-5):
    assert np.allclose(a, b, atol=tolerance, rtol=0), f"{a} is not {b}"


def value(record):
    return record.get("value", [1, 1, 1])


def checker(size=2):
    pixels = np.zeros((size, size, 4), dtype=np.float32)
    pixels[..., 0] = np.linspace(0, 1, size)[None, :]
    pixels[..., 1] = np.linspace(0, 1, size)[:, None]
    pixels[..., 3] = 1.0
    pixels[0, 0, 3] = 0.0
    return pixels


def data_counts():
    return {
        name: len(getattr(bpy.data, name))
        for name in (
            "scenes",
            "worlds",
            "objects",
            "meshes",
            "materials",
            "images",
            "cameras",
            "node_groups",
            "textures",
        )
    }


def layout_request():
    with tempfile.TemporaryDirectory() as folder:
        mapping = layout_module.write_layout_request(bpy.context, folder, model.layout_settings())
        with Reader(folder, "layout") as reader:
            return reader.data, mapping


def run(tests):
    """Calls every test_* of a module's globals, or those named after '--'; exits with what failed."""
    wanted = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    tests = [(n, f) for n, f in tests.items() if n.startswith("test_") and (not wanted or n in wanted)]
    failed = []
    for name, function in tests:
        reset()
        try:
            function()
            print("ok  ", name)
        except Exception:
            import traceback

            traceback.print_exc()
            print("FAIL", name)
            failed.append(name)
    if failed:
        raise SystemExit(f"{len(failed)} of {len(tests)} failed: {', '.join(failed)}")
