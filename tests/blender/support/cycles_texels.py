# SPDX-License-Identifier: GPL-3.0-or-later
"""Light of small scenes by Cycles, on the lightmap texels of an export to Ajar."""
import time

import bpy
import numpy as np
from ajar import job
from ajar.accuracy.bakes import LUMINANCE

import cycles_bake

from . import merge

MAX_STEP = 0.15  # between neighbours without an edge of light or shadow


def empty_file():
    """Removes what a case made; the add-on stays."""
    for kind in ("objects", "meshes", "lights", "materials", "images", "worlds", "collections"):
        collection = getattr(bpy.data, kind)
        kept = ("Render Result", "Viewer Node")
        bpy.data.batch_remove([item for item in collection if item.name not in kept])
    bpy.context.scene.ajar.light_sets.clear()


def export(folder, wishes):
    """Lays the open scene out and writes its snapshot. wishes: settings by name, e.g. texels_per_meter."""

    def steps(task):
        layout = yield from job.layout_steps(task, overrides=wishes)
        yield from job.snapshot_steps(task, folder, layout, wishes)

    task = job.Job("Export", bpy.context, steps)
    job.manager.start(task)
    while job.manager.step():
        time.sleep(0.005)
    assert task.status.result == "done", task.status.message


def blacken_backs():
    """Ajar takes the backs of culled materials for black; Cycles has to be told."""
    for material in [m for m in bpy.data.materials if m.use_nodes and m.use_backface_culling]:
        tree = material.node_tree
        output = tree.get_output_node('CYCLES')
        geometry, mix = tree.nodes.new('ShaderNodeNewGeometry'), tree.nodes.new('ShaderNodeMixShader')
        black = tree.nodes.new('ShaderNodeBsdfDiffuse')
        black.inputs['Color'].default_value = (0, 0, 0, 1)
        tree.links.new(geometry.outputs['Backfacing'], mix.inputs[0])
        tree.links.new(output.inputs['Surface'].links[0].from_socket, mix.inputs[1])
        tree.links.new(black.outputs[0], mix.inputs[2])
        tree.links.new(mix.outputs[0], output.inputs['Surface'])


class CyclesTexels:
    """The open scene, whose lightmapped objects give way to merged ones that Cycles bakes."""

    def __init__(self, data):
        """data: what the snapshot of the scene says."""
        blacken_backs()
        pieces = merge.read_pieces([i for i in data["instances"] if i.get("page") is not None])
        self.maps, _, _ = cycles_bake.map_texels(pieces, data["pages"])
        self._materials = cycles_bake.BakeMaterials(data["pages"])
        self._merged = cycles_bake.merge_receivers(pieces, self._materials)

    def bake(self, options, bounces):
        """(light, its standard error, whether a texel and its neighbours lie on one surface without an edge of light)
        per page, as the scene stands. options: samples, repeats, seed and threads, as of cycles_bake.py."""
        total = cycles_bake.bake_repeats(
            self._merged, self._materials, options, bounces, ("DIRECT", "INDIRECT")
        )
        light = [mean @ LUMINANCE for mean in total.mean]
        # Channels of one repeat share their paths: their errors add up.
        error = [np.sqrt(total.variance(page)) @ LUMINANCE for page in range(len(light))]
        usable = [
            valid & inside(m) & ~edges(*e) for valid, m, *e in zip(total.valid, self.maps, light, error)
        ]
        return light, error, usable


def edges(light, error):
    """Texels that differ from a neighbour by more than MAX_STEP of their light and by more than their noise. Cycles'
    samples lie in the middle half of a texel (measured with Blender 3.4), the reference's all over it."""
    result = np.zeros_like(light, bool)
    for shift in ((0, 1), (0, -1), (1, 0), (-1, 0)):
        noise = np.hypot(error, np.roll(error, shift, (0, 1)))
        result |= np.abs(light - np.roll(light, shift, (0, 1))) > MAX_STEP * light + 4.0 * noise
    return result


def inside(texel_map):
    """Texels whose neighbours lie on the same object with about the same normal."""
    own, normal = texel_map.object, texel_map.normal
    result = own >= 0
    for dy in (-1, 0, 1):
        for dx in (-1, 0, 1):
            other = np.roll(own, (dy, dx), (0, 1)) == own
            near = (np.roll(normal, (dy, dx), (0, 1)) * normal).sum(-1) > 0.9
            result &= other & near
    return result


def student_quantile(chance, freedom):
    """Two-sided bound of Student's distribution, by Hill's expansion (1970, Algorithm 396) about the normal's."""
    low, high = 0.0, 40.0
    for _ in range(80):  # of the normal distribution, by halving
        middle = 0.5 * (low + high)
        tail = np.exp(log_erfc(middle / np.sqrt(2.0)))
        low, high = (middle, high) if tail > chance else (low, middle)
    z, n = low, freedom
    return (
        z
        + (z**3 + z) / (4 * n)
        + (5 * z**5 + 16 * z**3 + 3 * z) / (96 * n**2)
        + (3 * z**7 + 19 * z**5 + 17 * z**3 - 15 * z) / (384 * n**3)
    )


def log_erfc(x):
    """log(1 - erf(x)) for x >= 0 (Numerical Recipes, 6.2.2: relative error 1.2e-7)."""
    t = 1.0 / (1.0 + 0.5 * x)
    terms = (
        0.17087277, -0.82215223, 1.48851587, -1.13520398, 0.27886807, -0.18628806, 0.09678418, 0.37409196, 1.00002368
    )  # fmt: skip
    sum_ = 0.0
    for term in terms:
        sum_ = t * (term + sum_)
    return np.log(t) - x * x - 1.26551223 + sum_
