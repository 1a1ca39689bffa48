# SPDX-License-Identifier: GPL-3.0-or-later
"""Lightmap layout: request over base meshes, and the answer as what apply and snapshot need."""

from dataclasses import dataclass, field

import numpy as np

from .. import model
from ..bridge.snapshot_io import Reader
from ..bridge.snapshot_write import ArrayWriter
from . import objects
from .compat import ajar, transform
from .tags import Tags
from .visibility import render_view


@dataclass
class LayoutMapping:
    """Which Blender data each layout mesh and user is: names, in the order of the request."""

    meshes: list = field(default_factory=list)  # (mesh name, [object names])
    warnings: list = field(default_factory=list)  # (culprit, text)


def write_layout_request(context, directory, settings, keep_existing=False):
    """Writes layout.json and layout.bin for every object that is to have a lightmap.

    settings: names of ajar_layout_settings (model.layout_settings). keep_existing: charts of
    meshes that have an AjarLightmap layer stay, only their place is new. Returns LayoutMapping.
    The user's scene is as before when it returns or raises.
    """
    warnings = model.Warnings()
    shown = render_view(context, Tags(context.scene).poses())
    with ArrayWriter(directory, "layout") as writer, shown as (depsgraph, visible):
        users = receivers(context.view_layer, depsgraph, visible, warnings, keep_existing)
        meshes, mapping = [], LayoutMapping()
        for mesh, owners in users:
            record = _mesh_record(mesh, writer, keep_existing)
            record["users"] = [
                {
                    "name": o.name,
                    "transform": transform(o.evaluated_get(depsgraph).matrix_world),
                    "texel_scale": float(ajar(o, "texel_scale")),
                }
                for o in owners
            ]
            meshes.append(record)
            mapping.meshes.append((mesh.name, [o.name for o in owners]))
        writer.finish({"settings": dict(settings), "meshes": meshes})
    mapping.warnings = list(warnings.items)
    return mapping


def receivers(view_layer, depsgraph, visible, warnings, keep_existing=False):
    """[(mesh, [objects that use it and are to have a lightmap])], both in a stable order.

    depsgraph, visible: from visibility.render_view. Objects that cannot are noted in warnings.
    """
    users = {}
    for obj in sorted(view_layer.objects, key=lambda o: o.name_full):
        if (
            obj.name_full not in visible
            or obj.type not in objects.GEOMETRY
            or not objects.wants_lightmap(obj)
        ):
            continue
        why = objects.obstacle(obj)
        if why and not (obj.type == "MESH" and len(obj.data.polygons) == 0):
            warnings.add(obj.name, why + ": baked as an occluder")
        elif why:
            continue  # extraction names empty meshes
        elif objects.copying_modifiers(obj) and not (keep_existing and objects.can_keep_uvs(obj, depsgraph)):
            warnings.add(obj.name, objects.copy_warning(obj))
        else:
            users.setdefault(obj.data.name_full, (obj.data, []))[1].append(obj)
    return list(users.values())


def _mesh_record(mesh, writer, keep_existing):
    """The request's dict of a base mesh, without users."""
    polygons, corners = len(mesh.polygons), len(mesh.loops)
    layer = mesh.uv_layers.get(model.LIGHTMAP_UV) if keep_existing else None
    return (
        {
            "name": mesh.name,
            "vertex_count": len(mesh.vertices),
            "positions": writer.add(_get(mesh.vertices, "co", 3, np.float32), "f32"),
            "corner_vertex": writer.add(_get(mesh.loops, "vertex_index", 1, np.int32), "u32"),
            "polygon_start": writer.add(_get(mesh.polygons, "loop_start", 1, np.int32), "u32"),
            "polygon_size": writer.add(_get(mesh.polygons, "loop_total", 1, np.int32), "u32"),
            "corner_edge_sharp": writer.add(
                _cut_edges(mesh)[_get(mesh.loops, "edge_index", 1, np.int32)], "u8"
            ),
            "corner_uv": writer.add(_get(layer.data, "uv", 2, np.float32), "f32")
            if layer and corners
            else None,
        }
        if polygons
        else {}
    )


def _cut_edges(mesh):
    """(E,) bool: edges that charts should not cross: marked sharp, or UV seams."""
    return _get(mesh.edges, "use_edge_sharp", 1, bool) | _get(mesh.edges, "use_seam", 1, bool)


def _get(collection, name, width, kind):
    values = np.empty(len(collection) * width, dtype=kind)
    collection.foreach_get(name, values)
    return values


def read_layout(directory, mapping):
    """(layout, uvs) of a worker's answer.

    layout is {"pages", "objects": {object name: {"page", "scale", "offset", "texels_per_meter"}}},
    as write_snapshot takes it; uvs is {mesh name: (corners, 2) float32} for the AjarLightmap
    layer. Raises bridge.snapshot_io.SnapshotError.
    """
    layout, uvs = {"pages": [], "objects": {}}, {}
    with Reader(directory, "layout_result") as reader:
        layout["pages"] = reader.data["pages"]
        for answer, (mesh, users) in zip(reader.data["meshes"], mapping.meshes):
            uvs[mesh] = np.array(reader.values(answer["corner_uv"], "f32"), dtype=np.float32).reshape(-1, 2)
            layout["objects"].update(zip(users, answer["users"]))
    return layout, uvs
