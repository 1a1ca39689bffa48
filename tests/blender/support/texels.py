# SPDX-License-Identifier: GPL-3.0-or-later
"""Which surface point lies under each texel centre: for reports about where bakes differ."""
import numpy as np


class TexelMap:
    """Per texel: world position, geometric normal, object and material index (-1: none), number of
    triangles, share of rays that meet back faces, whether an opposite face coincides."""

    def __init__(self, width, height):
        self.position = np.zeros((height, width, 3), np.float32)
        self.normal = np.zeros((height, width, 3), np.float32)
        self.object = np.full((height, width), -1, np.int32)
        self.material = np.full((height, width), -1, np.int32)
        self.overlap = np.zeros((height, width), np.uint8)
        self.back = np.zeros((height, width), np.float32)
        self.coincident = np.zeros((height, width), bool)


def rasterize_piece(piece, index, material_index, maps):
    """Enter every triangle of a merge.Piece into its page's map."""
    target = maps[piece.page]
    height, width = target.object.shape
    uv = piece.uvs['AjarPage'] * (width, height) - 0.5
    points = piece.points[piece.loop_vertex]
    for polygon, (start, total) in enumerate(zip(piece.start, piece.total)):
        material = material_index[piece.slot[polygon]]
        for k in range(1, total - 1):
            corners = [start, start + k, start + k + 1]
            _rasterize_triangle(uv[corners], points[corners], index, material, target)


def _rasterize_triangle(uv, points, index, material, target):
    height, width = target.object.shape
    low = np.maximum(np.ceil(uv.min(0)).astype(int), 0)
    high = np.minimum(np.floor(uv.max(0)).astype(int), (width - 1, height - 1))
    (ax, ay), (bx, by) = uv[1] - uv[0], uv[2] - uv[0]
    area = ax * by - ay * bx
    if (high < low).any() or area == 0:
        return
    x, y = np.meshgrid(np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1))
    dx, dy = x - uv[0, 0], y - uv[0, 1]
    b, c = (dx * by - dy * bx) / area, (ax * dy - ay * dx) / area
    inside = (b >= 0) & (c >= 0) & (b + c <= 1)
    x, y, b, c = x[inside], y[inside], b[inside, None], c[inside, None]
    normal = np.cross(points[1] - points[0], points[2] - points[0])
    target.position[y, x] = points[0] + b * (points[1] - points[0]) + c * (points[2] - points[0])
    target.normal[y, x] = normal / max(np.linalg.norm(normal), 1e-30)
    target.object[y, x], target.material[y, x] = index, material
    target.overlap[y, x] += 1
