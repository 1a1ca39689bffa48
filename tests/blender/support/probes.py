# SPDX-License-Identifier: GPL-3.0-or-later
"""Point receivers for light measurements: one mesh of tiny quads, each filling one UV cell."""
import bpy
import numpy as np
from mathutils import Vector

CELL = 4  # texels along one edge of a receiver's cell
STRIDE = 8  # texels between cells; the gap keeps receivers apart
SIZE = 1e-3  # m, edge of a receiver


def image_size(count):
    """Texels along one edge of the square image that holds `count` receivers."""
    return STRIDE * max(1, int(np.ceil(np.sqrt(count))))


def cell_origin(index, size):
    """Lower left texel of a receiver's cell."""
    columns = size // STRIDE
    margin = (STRIDE - CELL) // 2
    return (index % columns) * STRIDE + margin, (index // columns) * STRIDE + margin


def quad_corners(point, normal, size):
    """Corners of a small square around `point`, counter-clockwise seen from `normal`."""
    normal = Vector(normal).normalized()
    helper = Vector((1, 0, 0)) if abs(normal.x) < 0.7 else Vector((0, 1, 0))
    tangent = normal.cross(helper).normalized() * (size / 2)
    bitangent = normal.cross(tangent)
    point = Vector(point)
    return [
        point - tangent - bitangent,
        point + tangent - bitangent,
        point + tangent + bitangent,
        point - tangent + bitangent,
    ]


def make_receivers(points, normals, layer="AjarLightmap", size=SIZE):
    """Build one object with a quad per receiver; its UV cells lie in an image_size() image."""
    pixels = image_size(len(points))
    mesh = bpy.data.meshes.new("receivers")
    vertices = [c for p, n in zip(points, normals) for c in quad_corners(p, n, size)]
    faces = [tuple(range(4 * i, 4 * i + 4)) for i in range(len(points))]
    mesh.from_pydata(vertices, [], faces)
    uv = mesh.uv_layers.new(name=layer).data
    for i in range(len(points)):
        x, y = cell_origin(i, pixels)
        for k, (dx, dy) in enumerate(((0, 0), (CELL, 0), (CELL, CELL), (0, CELL))):
            uv[4 * i + k].uv = ((x + dx) / pixels, (y + dy) / pixels)
    obj = bpy.data.objects.new("receivers", mesh)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def read_receivers(pixels, count):
    """Mean and standard error of each receiver's cell of an (h, w, c) array, bottom row first."""
    means, errors = [], []
    for i in range(count):
        x, y = cell_origin(i, pixels.shape[0])
        cell = pixels[y : y + CELL, x : x + CELL, :3].reshape(-1, 3).astype(np.float64)
        means.append(cell.mean(0))
        errors.append(cell.std(0, ddof=1) / np.sqrt(len(cell)))
    return np.array(means), np.array(errors)
