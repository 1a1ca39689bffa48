# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a layout into the scene: the AjarLightmap UV layer of each mesh, and page, scale
and offset of each object. Active and render UV layers stay as they are."""
import bpy
import numpy as np

from ..model import LIGHTMAP_UV as UV_LAYER

MAX_UV_LAYERS = 8


def apply_layout(scene, layout, uvs, meshes):
    """Applies a layout answer, all keyed by name: layout and uvs as extract.layout.read_layout
    returns them, meshes as [(mesh, [objects])]. Objects whose mesh changed meanwhile are taken out
    of layout. Returns warnings as (culprit, text)."""
    warnings = []
    forget_placements(scene.objects)
    for name, users in meshes:
        problem = _apply_mesh(name, uvs[name])
        if problem:
            warnings.append((name, problem))
        for user in users:
            obj = bpy.data.objects.get(user)
            if problem or obj is None or obj.library:
                layout["objects"].pop(user, None)
            else:
                _place(obj, layout["objects"][user])
    return warnings


def _apply_mesh(name, uv):
    """Writes the lightmap layer of a mesh; returns the reason if it cannot."""
    mesh = bpy.data.meshes.get(name)
    if mesh is None:
        return "was removed while the layout ran: bake again"
    if len(uv) != len(mesh.loops):
        return "was edited while the layout ran: bake again"
    return write_uv_layer(mesh, uv.reshape(-1))


def _place(obj, place):
    obj.ajar.lightmap_page = place["page"]
    obj.ajar.uv_scale = place["scale"]
    obj.ajar.uv_offset = place["offset"]


class KeptLayout:
    """The lightmap UVs and places of a scene as they are now. A bake that does not finish puts them
    back, because the package on disk, which is the last one then, was made for them."""

    def __init__(self, scene):
        own = [obj for obj in scene.objects if obj.library is None]
        self._places = {obj.name: _placement(obj) for obj in own}
        meshes = {obj.data.name: obj.data for obj in own if obj.type == "MESH" and not obj.data.library}
        self._uvs = {name: read_uv_layer(mesh) for name, mesh in meshes.items()}

    def restore(self, scene):
        """Puts everything back, but for what the artist removed or edited meanwhile."""
        forget_placements(scene.objects)
        for name, place in self._places.items():
            obj = scene.objects.get(name)
            if obj is not None and place["page"] >= 0:
                _place(obj, place)
        for name, uv in self._uvs.items():
            mesh = bpy.data.meshes.get(name)
            if mesh is None or mesh.is_editmode:
                continue
            if uv is None:
                remove_uv_layer(mesh)
            elif len(uv) == 2 * len(mesh.loops):
                write_uv_layer(mesh, uv)


def _placement(obj):
    return {
        "page": obj.ajar.lightmap_page,
        "scale": tuple(obj.ajar.uv_scale),
        "offset": tuple(obj.ajar.uv_offset),
    }


def read_uv_layer(mesh):
    """Flat corner UVs of the mesh's AjarLightmap layer, or None if it has none (or is being edited)."""
    layer = mesh.uv_layers.get(UV_LAYER)
    if layer is None or len(layer.data) != len(mesh.loops):
        return None
    uv = np.empty(2 * len(mesh.loops), dtype=np.float32)
    layer.data.foreach_get("uv", uv)
    return uv


def forget_placements(objects):
    """Objects have no place in a page any more."""
    for obj in objects:
        if obj.library is None:
            for name in ("lightmap_page", "uv_scale", "uv_offset"):
                obj.ajar.property_unset(name)


def refusal(mesh):
    """Why a mesh cannot get a lightmap UV layer; empty if it can."""
    if mesh.library:
        return "is linked from a library: make it local, or tag its objects as occluders"
    if UV_LAYER not in mesh.uv_layers and len(mesh.uv_layers) >= MAX_UV_LAYERS:
        return f"has {MAX_UV_LAYERS} UV layers already: remove one to make room for the lightmap's"
    return ""


def write_uv_layer(mesh, uv):
    """Writes flat corner UVs to the mesh's AjarLightmap layer; returns the reason if it cannot."""
    problem = refusal(mesh)
    if problem:
        return problem
    if mesh.is_editmode:
        return "is in Edit Mode: leave it and bake again"
    layer = mesh.uv_layers.get(UV_LAYER)
    if layer is None:
        active, render = _active_layers(mesh)
        layer = mesh.uv_layers.new(name=UV_LAYER, do_init=False)
        if layer is None:
            return "Blender refused one more UV layer"
        _set_active_layers(mesh, active, render)
        layer = mesh.uv_layers[UV_LAYER]
    if "uv" in layer.bl_rna.properties:
        layer.uv.foreach_set("vector", uv)
    else:
        layer.data.foreach_set("uv", uv)
    mesh.update()
    return ""


def remove_uv_layer(mesh):
    """Takes the lightmap layer away again, leaving the active and render layers as they are."""
    layer = mesh.uv_layers.get(UV_LAYER)
    if layer is None or mesh.library:
        return
    active, render = _active_layers(mesh)
    mesh.uv_layers.remove(layer)
    _set_active_layers(mesh, active, render)


def _active_layers(mesh):
    """Names of the active and of the render layer ('' if there is none)."""
    active = mesh.uv_layers.active
    render = next((layer.name for layer in mesh.uv_layers if layer.active_render), "")
    return active.name if active else "", render


def _set_active_layers(mesh, active, render):
    if active in mesh.uv_layers:
        mesh.uv_layers.active = mesh.uv_layers[active]
    if render in mesh.uv_layers:
        mesh.uv_layers[render].active_render = True
