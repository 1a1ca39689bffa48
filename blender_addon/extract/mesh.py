# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluated meshes as triangle arrays."""

from contextlib import contextmanager
from dataclasses import dataclass, field

import bpy
import numpy as np

from .. import model
from .compat import has


@dataclass
class MeshData:
    """Triangles of an evaluated mesh in local space, metres.

    positions (V, 3) f32; corner_vertex (T, 3) u32; corner_normals (T, 3, 3) f32 or None (flat);
    triangle_slot (T,) u32; uv_layers name -> (T, 3, 2) f32; color_layers name -> (T, 3, 4) f32
    linear; active_uv and active_color name the layers Blender renders by default.
    """

    name: str
    positions: np.ndarray
    corner_vertex: np.ndarray
    corner_normals: np.ndarray | None
    triangle_slot: np.ndarray
    uv_layers: dict
    color_layers: dict
    active_uv: str | None = None
    active_color: str | None = None
    materials: list = field(default_factory=list)
    corner_loop: np.ndarray | None = None  # (T, 3) loop of the evaluated mesh

    def uv_index(self, name):
        """Index of a UV layer (None or '': the active one), None if there is none."""
        return _index(self.uv_layers, name or self.active_uv)

    def color_index(self, name):
        """Index of a colour layer ('': the active one), None if there is none."""
        return _index(self.color_layers, name or self.active_color)


def _index(layers, name):
    return list(layers).index(name) if name in layers else None


@contextmanager
def evaluated_mesh(evaluated):
    """The mesh of an evaluated object (any geometry type) while the context lasts, or None."""
    try:
        mesh = evaluated.to_mesh()
    except RuntimeError:
        mesh = None
    try:
        yield mesh
    finally:
        evaluated.to_mesh_clear()


def read_mesh(mesh, name):
    """MeshData of a bpy Mesh; None if it has no triangles."""
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    if count == 0:
        return None
    loops = _get(mesh.loop_triangles, "loops", (count, 3), np.int32)
    loop_vertex = _get(mesh.loops, "vertex_index", (len(mesh.loops),), np.int32)
    positions = _get(mesh.vertices, "co", (len(mesh.vertices), 3), np.float32)
    corner_vertex = loop_vertex[loops]
    return MeshData(
        name,
        positions,
        corner_vertex.astype(np.uint32),
        _corner_normals(mesh, loops, positions[corner_vertex]),
        _get(mesh.loop_triangles, "material_index", (count,), np.int32).astype(np.uint32),
        _uv_layers(mesh, loops),
        _color_layers(mesh, loops, corner_vertex),
        _active_uv(mesh),
        _active_color(mesh),
        [m.original if m is not None else None for m in mesh.materials],
        loops,
    )


def _get(collection, name, shape, kind):
    values = np.empty(int(np.prod(shape)), dtype=kind)
    collection.foreach_get(name, values)
    return values.reshape(shape)


def _corner_normals(mesh, loops, corners):
    """(T, 3, 3) shading normals as rendered, or None if every face is flat.

    corners are the (T, 3, 3) positions: flat faces take their triangle's own normal, as Cycles does.
    """
    smooth_faces = _get(mesh.polygons, "use_smooth", (len(mesh.polygons),), bool)
    if not smooth_faces.any():
        return None
    normals = _loop_normals(mesh)[loops]
    smooth = smooth_faces[_get(mesh.loop_triangles, "polygon_index", (len(loops),), np.int32)]
    # A NaN vertex spoils the normals of its neighbours, which are sound otherwise.
    sound = np.isfinite(normals).all(axis=(1, 2)) & (np.abs(normals).max(axis=2) > 0.0).all(axis=1)
    if not (smooth & sound).all():
        normals[~(smooth & sound)] = _face_normals(corners[~(smooth & sound)])[:, None, :]
    return normals


def _face_normals(corners):
    """(T, 3) unit normals of triangles (T, 3, 3)."""
    corners = corners.astype(np.float64)
    with np.errstate(all="ignore"):
        face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        return face / np.maximum(np.linalg.norm(face, axis=1, keepdims=True), 1e-300)


def _loop_normals(mesh):
    """(L, 3) normals per loop, with sharp edges and custom normals."""
    shape = (len(mesh.loops), 3)
    if has(mesh, "corner_normals"):
        return _get(mesh.corner_normals, "vector", shape, np.float32)
    mesh.calc_normals_split()
    return _get(mesh.loops, "normal", shape, np.float32)


def _uv_layers(mesh, loops):
    shape = (len(mesh.loops), 2)
    return {
        layer.name: _get(layer.data, "uv", shape, np.float32)[loops]
        for layer in mesh.uv_layers
        if len(layer.data) == len(mesh.loops)
    }


def _active_uv(mesh):
    return next((l.name for l in mesh.uv_layers if l.active_render), None)


def _color_layers(mesh, loops, corner_vertex):
    layers = {}
    for attribute in mesh.color_attributes:
        size = len(attribute.data)
        index = {"CORNER": loops, "POINT": corner_vertex}.get(attribute.domain)
        if index is None or size == 0:
            continue
        # RNA's "color" is scene-linear for byte layers too.
        layers[attribute.name] = _get(attribute.data, "color", (size, 4), np.float32)[index]
    return layers


def _active_color(mesh):
    colors = mesh.color_attributes
    index = colors.render_color_index if has(colors, "render_color_index") else 0
    return colors[index].name if 0 <= index < len(colors) else None


def write_mesh(writer, data):
    """The snapshot's dict of a mesh; its arrays go to the writer."""
    return {
        "name": data.name,
        "vertex_count": len(data.positions),
        "triangle_count": len(data.corner_vertex),
        "positions": writer.add(data.positions, "f32"),
        "corner_vertex": writer.add(data.corner_vertex, "u32"),
        "corner_normals": writer.add(data.corner_normals, "f32"),
        "triangle_slot": writer.add(data.triangle_slot, "u32") if data.triangle_slot.any() else None,
        "uv_layers": [writer.add(uv, "f32") for uv in data.uv_layers.values()],
        "uv_layer_names": list(data.uv_layers),
        "color_layers": [writer.add(color, "f32") for color in data.color_layers.values()],
        "color_layer_names": list(data.color_layers),
    }


def rebuild_mesh(data):
    """A new bpy Mesh of a MeshData: one polygon per triangle, with its UV and colour layers."""
    mesh = bpy.data.meshes.new(data.name)
    mesh.from_pydata(data.positions.tolist(), [], data.corner_vertex.tolist())
    for name, uv in list(data.uv_layers.items())[:7]:
        layer = mesh.uv_layers.new(name=name, do_init=False)
        layer.data.foreach_set("uv", uv.reshape(-1))
        layer.active_render = name == data.active_uv
    for name, color in data.color_layers.items():
        attribute = mesh.color_attributes.new(name, "FLOAT_COLOR", "CORNER")
        attribute.data.foreach_set("color", color.reshape(-1))
    mesh.polygons.foreach_set("material_index", data.triangle_slot.astype(np.int32))
    mesh.update()
    return mesh


def lightmap_uv(data):
    """(T, 3, 2) lightmap UVs of a MeshData, or None."""
    return data.uv_layers.get(model.LIGHTMAP_UV)


def overlap_share(uv, resolution=512):
    """Share of the covered cells of a resolution^2 grid over the UVs that two triangles cover."""
    uv = uv[np.isfinite(uv).all(axis=(1, 2))]
    if len(uv) == 0:
        return 0.0
    low, high = uv.reshape(-1, 2).min(0), uv.reshape(-1, 2).max(0)
    grid = np.zeros((resolution, resolution), dtype=np.uint16)
    scaled = (uv.astype(np.float64) - low) / max(float((high - low).max()), 1e-12) * resolution
    for triangle in scaled:
        _cover(grid, triangle)
    covered = np.count_nonzero(grid)
    return float(np.count_nonzero(grid > 1)) / covered if covered else 0.0


def _cover(grid, triangle):
    """Counts cells whose centre is well inside a triangle given in cells."""
    low = np.maximum(np.floor(triangle.min(0)).astype(int), 0)
    high = np.minimum(np.ceil(triangle.max(0)).astype(int), grid.shape[0])
    if np.any(high <= low):
        return
    x = np.arange(low[0], high[0]) + 0.5
    y = (np.arange(low[1], high[1]) + 0.5)[:, None]
    edges = []
    for a, b in ((0, 1), (1, 2), (2, 0)):
        (ax, ay), (bx, by) = triangle[a], triangle[b]
        edges.append((bx - ax) * (y - ay) - (by - ay) * (x - ax))
    inside = (np.minimum.reduce(edges) > 1e-6) | (np.maximum.reduce(edges) < -1e-6)
    grid[low[1] : high[1], low[0] : high[0]] += inside
