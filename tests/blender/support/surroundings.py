# SPDX-License-Identifier: GPL-3.0-or-later
"""What lies around each texel, to explain differences: Cycles lights the inside of solids through
two-sided back faces, and leaves coincident opposite faces black; a lightmapper does neither."""
import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

DIRECTIONS = 32  # rays of each texel
OFFSET = 1e-3  # m
COINCIDENT = 2e-3  # m


def make_tree(pieces):
    """BVH over the world-space faces of all pieces."""
    points, faces, first = [], [], 0
    for piece in pieces:
        points.append(piece.points)
        for start, total in zip(piece.start, piece.total):
            faces.append((piece.loop_vertex[start : start + total] + first).tolist())
        first += len(piece.points)
    return BVHTree.FromPolygons(np.concatenate(points).tolist(), faces)


def hemisphere(count=DIRECTIONS):
    """Cosine-spread directions around +Z."""
    i = np.arange(count) + 0.5
    r, phi = np.sqrt(i / count), i * np.pi * (3 - np.sqrt(5))
    return np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1 - r * r)], -1)


def back_share(tree, point, normal, local):
    """Share of cosine-spread rays that meet back faces."""
    helper = np.array([1.0, 0, 0]) if abs(normal[0]) < 0.7 else np.array([0, 1.0, 0])
    x = np.cross(helper, normal)
    x /= np.linalg.norm(x)
    frame = np.stack([x, np.cross(normal, x), normal])
    origin, backs = Vector(point + normal * OFFSET), 0
    for direction in local @ frame:
        ray = Vector(direction)
        _, face_normal, _, _ = tree.ray_cast(origin, ray)
        backs += face_normal is not None and face_normal.dot(ray) > 0
    return backs / len(local)


def is_coincident(tree, point, normal):
    """True if an opposite face lies at the same place."""
    faces = tree.find_nearest_range(Vector(point), COINCIDENT)
    return any(face_normal.dot(Vector(normal)) < -0.99 for _, face_normal, _, _ in faces)


def examine(pieces, maps, wanted):
    """Fill back and coincident of each texel map where wanted[page]."""
    tree, local = make_tree(pieces), hemisphere()
    for page, mask in zip(maps, wanted):
        for y, x in zip(*np.nonzero(mask & (page.object >= 0))):
            point, normal = page.position[y, x], page.normal[y, x]
            page.back[y, x] = back_share(tree, point, normal, local)
            page.coincident[y, x] = is_coincident(tree, point, normal)
