# SPDX-License-Identifier: GPL-3.0-or-later
"""An instance between the dependency graph and the snapshot."""

from dataclasses import dataclass

import bpy
import numpy as np

from .. import model
from .mesh import MeshData, lightmap_uv, rebuild_mesh


@dataclass
class Placed:
    """An instance on its way into the snapshot."""

    name: str
    source: object  # the original object
    mesh: MeshData
    mesh_id: int
    matrix: object
    materials: list
    surface: str = "occluder"
    place: dict | None = None  # page, scale, offset
    page_size: tuple = (1024, 1024)
    add_layer: object = None
    depsgraph: object = None  # None for instances, whose mesh need not be the source's
    instancer: object = None  # the original object that makes this instance, None for real objects
    occurrence: str = ""  # tells nested instances by one instancer apart

    lightmap_layer_name = model.LIGHTMAP_UV

    @property
    def bake_key(self):
        """What textures baked for this instance belong to: instances of one mesh share them."""
        return ("mesh", self.mesh_id) if self.depsgraph is None else self.name

    @property
    def lightmap_uv(self):
        return lightmap_uv(self.mesh) if self.surface == "lightmap" else None

    @property
    def page_texels(self):
        """Texels per unit of the mesh's lightmap UVs, (x, y)."""
        return np.array(self.page_size) * np.array(self.place["scale"])

    def make_mesh(self, split):
        """(new mesh data-block, its loops (T, 3)) with this instance's triangles, to be removed
        by the caller. split: triangles share no loops; attributes but UVs and colours are lost.
        """
        if self.depsgraph is not None and not split:
            evaluated = self.source.evaluated_get(self.depsgraph)
            mesh = bpy.data.meshes.new_from_object(
                evaluated, preserve_all_data_layers=True, depsgraph=self.depsgraph
            )
            if len(mesh.loops) > self.mesh.corner_loop.max():
                return mesh, self.mesh.corner_loop
            bpy.data.meshes.remove(mesh)
        return rebuild_mesh(self.mesh), np.arange(self.mesh.corner_vertex.size).reshape(-1, 3)

    def mesh_layer(self, name, make):
        """UVs of an extra layer of the mesh, made by make(triangle count) the first time."""
        if name not in self.mesh.uv_layers:
            self.add_layer(self.mesh_id, name, make(len(self.mesh.corner_vertex)))
        return self.mesh.uv_layers[name]
