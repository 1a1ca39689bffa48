# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes a socket that fields cannot express to a texture of one object, by Cycles' EMIT bake.

Everything happens on temporary copies in a temporary scene, which are removed again.
"""

from contextlib import ExitStack, contextmanager

import bpy
import numpy as np

from .compat import has
from .images import Texels, downscale
from .tree import active_output, by_identifier, group_output
from .values import Field, Sampler, constant

BAKED_UV = "AjarBaked"  # layer of objects without lightmap UVs: every triangle has its own cell
SAMPLES = 4
MIN_SIZE, MAX_SIZE = 16, 1024
OVERSAMPLING = 2  # texels per lightmap texel: cutouts and emission need more than light
_CELL = 12  # texels per cell edge wanted; two triangles share a cell


class SocketBaker:
    """Evaluator fallback for one placed object: called with what could not be expressed."""

    def __init__(self, owner, material, store, warnings, textures_by_owner):
        self.owner, self.material, self.store, self.warnings = owner, material, store, warnings
        self._cache = textures_by_owner

    def __call__(self, scope, socket, scalar, reason):
        """Field of the baked socket; a warning and the socket's own default if that fails."""
        path = tuple(node.name for node in scope) + (socket.node.name, socket.identifier)
        key = ("baked", self.owner.bake_key, self.material.name_full, path)
        try:
            if key not in self._cache:
                self._cache[key] = self._bake(key, path)
                self.warnings.add(self.material.name, f"{reason}: baked to a texture by Cycles")
        except (RuntimeError, TypeError, ValueError) as error:
            self.warnings.add(
                self.material.name,
                f"{reason} on object '{self.owner.name}' could not be "
                f"baked to a texture ({error}): the socket's own value is used",
            )
            value = socket.default_value
            return constant(tuple(value)[:3] if hasattr(value, "__len__") else value)
        return Field(texture=key, sampler=self._cache[key], channel="r" if scalar else "rgb")

    def _bake(self, key, path):
        uv, layer, low, extent, size = self._chart()
        scaled = (uv - low) / extent
        data = bake_socket(self.owner, self.material, path, scaled, size, layer == BAKED_UV)
        self.store.put(key, downscale(Texels(f"{self.material.name}.{path[-1]}", data), MAX_SIZE))
        sx, sy = 1.0 / extent[0], 1.0 / extent[1]
        return Sampler(layer, (sx, 0.0, -low[0] * sx, 0.0, sy, -low[1] * sy), "edge")

    def _chart(self):
        """(uv (T, 3, 2), layer name, low corner, extent, (width, height)) to bake into."""
        uv = self.owner.lightmap_uv
        if uv is None or not np.isfinite(uv).all():
            uv = self.owner.mesh_layer(BAKED_UV, triangle_cells)
            cells = int(np.ceil(np.sqrt((len(uv) + 1) // 2)))
            size = int(np.clip(cells * _CELL, MIN_SIZE, MAX_SIZE))
            return uv, BAKED_UV, np.zeros(2), np.ones(2), (size, size)
        low, high = uv.reshape(-1, 2).min(0).astype(float), uv.reshape(-1, 2).max(0).astype(float)
        margin = 2.0 / MAX_SIZE
        low, extent = low - margin, np.maximum(high - low, 1e-6) + 2 * margin
        texels = extent * self.owner.page_texels * OVERSAMPLING
        size = tuple(int(np.clip(np.ceil(t), MIN_SIZE, MAX_SIZE)) for t in texels)
        return uv, self.owner.lightmap_layer_name, low, extent, size


def triangle_cells(count):
    """(count, 3, 2) UVs: triangle i is half of cell i // 2 of a square grid, with a gap."""
    edge = int(np.ceil(np.sqrt((count + 1) // 2)))
    index = np.arange(count)
    cell = np.stack([(index // 2) % edge, (index // 2) // edge], 1)[:, None, :]
    gap = 0.12
    lower = np.array([[gap, gap], [1 - 2 * gap, gap], [gap, 1 - 2 * gap]])
    upper = 1.0 - lower
    corners = np.where((index % 2 == 0)[:, None, None], lower, upper)
    return ((cell + corners) / edge).astype(np.float32)


def bake_socket(owner, material, path, uv, size, split):
    """(height, width, 4) float32 linear values of an input socket over uv (T, 3, 2) in [0, 1].

    path: names of the group nodes entered, then node name and socket identifier. owner: a
    snapshot.Placed. split: neighbouring triangles have UVs of their own. Raises RuntimeError if Cycles cannot bake.
    """
    with ExitStack() as stack:
        scene = stack.enter_context(_temporary(bpy.data.scenes, bpy.data.scenes.new("AjarBake")))
        image = stack.enter_context(
            _temporary(
                bpy.data.images,
                bpy.data.images.new("AjarBake", *size, alpha=False, float_buffer=True, is_data=True),
            )
        )
        copies = []
        stack.callback(_remove_trees, copies)
        probe = stack.enter_context(_temporary(bpy.data.materials, material.copy()))
        _emit_socket(probe, path, copies)
        other = stack.enter_context(_temporary(bpy.data.materials, bpy.data.materials.new("AjarBake")))
        other.use_nodes = True
        other.node_tree.nodes.clear()
        mesh, corners = owner.make_mesh(split)
        stack.enter_context(_temporary(bpy.data.meshes, mesh))
        target = stack.enter_context(_temporary(bpy.data.objects, bpy.data.objects.new(owner.name, mesh)))
        _prepare(target, owner, material, probe, other)
        _bake_layer(mesh, corners, uv)
        for shown in (probe, other):
            _select_image(shown, image)
        _run(scene, target)
        data = np.empty(size[0] * size[1] * 4, dtype=np.float32)
        image.pixels.foreach_get(data)
        return np.nan_to_num(data.reshape(size[1], size[0], 4))


@contextmanager
def _temporary(collection, item):
    try:
        yield item
    finally:
        collection.remove(item)


def _remove_trees(trees):
    for tree in reversed(trees):
        bpy.data.node_groups.remove(tree)


def _prepare(target, owner, material, probe, other):
    """Gives the temporary object its place and its materials: the probe in place of material."""
    mesh = target.data
    target.matrix_world = owner.matrix
    target.color, target.pass_index = owner.source.color, owner.source.pass_index
    slots = [probe if m is not None and m == material else other for m in owner.materials]
    mesh.materials.clear()
    for slot in slots:
        mesh.materials.append(slot)


def _bake_layer(mesh, corners, uv):
    """Adds the UV layer to bake into: uv (T, 3, 2) at loops corners (T, 3)."""
    while len(mesh.uv_layers) > 7:
        mesh.uv_layers.remove(mesh.uv_layers[-1])
    rendered = next((l.name for l in mesh.uv_layers if l.active_render), None)
    layer = mesh.uv_layers.new(name="AjarBakeTarget", do_init=False)
    values = np.zeros((len(mesh.loops), 2), dtype=np.float32)
    values[corners.reshape(-1)] = uv.reshape(-1, 2)
    layer.data.foreach_set("uv", values.reshape(-1))
    mesh.uv_layers.active = layer  # baked into; the render layer stays what shaders read
    if rendered is not None:
        mesh.uv_layers[rendered].active_render = True


def _emit_socket(material, path, copies):
    """Rewires a material copy: its surface emits the value of the socket at path."""
    tree = material.node_tree
    output = active_output(tree, "ShaderNodeOutputMaterial")
    value = _expose(tree, path, copies)
    emission = tree.nodes.new("ShaderNodeEmission")
    if isinstance(value, bpy.types.NodeSocket):
        tree.links.new(value, emission.inputs["Color"])
    else:
        emission.inputs["Color"].default_value = value
    for link in list(output.inputs["Surface"].links):
        tree.links.remove(link)
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    for node in tree.nodes:
        if node.bl_idname == "ShaderNodeOutputMaterial" and node != output:
            tree.nodes.remove(node)


def _expose(tree, path, copies):
    """Output socket in tree that carries the input socket at path out of its groups."""
    node = tree.nodes[path[0]]
    if len(path) == 2:
        socket = by_identifier(node.inputs, path[1])
        if not socket.is_linked:
            raise ValueError("nothing is linked")
        return socket.links[0].from_socket
    node.node_tree = node.node_tree.copy()
    copies.append(node.node_tree)
    inner = _expose(node.node_tree, path[1:], copies)
    _new_output(node.node_tree)
    exit_node = group_output(node.node_tree)
    node.node_tree.links.new(inner, [s for s in exit_node.inputs if s.bl_idname != "NodeSocketVirtual"][-1])
    return node.outputs[-1]


def _new_output(tree):
    if has(tree, "interface"):
        tree.interface.new_socket("AjarBake", in_out="OUTPUT", socket_type="NodeSocketColor")
    else:
        tree.outputs.new("NodeSocketColor", "AjarBake")


def _select_image(material, image):
    nodes = material.node_tree.nodes
    node = nodes.new("ShaderNodeTexImage")
    node.image = image
    for other in nodes:
        other.select = False
    node.select = True
    nodes.active = node


def _run(scene, target):
    scene.collection.objects.link(target)
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples = "CPU", SAMPLES
    for name, value in (("use_denoising", False), ("use_adaptive_sampling", False)):
        if has(scene.cycles, name):
            setattr(scene.cycles, name, value)
    if has(scene.render.bake, "margin_type"):
        scene.render.bake.margin_type = "EXTEND"
    view_layer = scene.view_layers[0]
    target.select_set(True, view_layer=view_layer)
    view_layer.objects.active = target
    with bpy.context.temp_override(
        scene=scene,
        view_layer=view_layer,
        active_object=target,
        object=target,
        selected_objects=[target],
        selected_editable_objects=[target],
    ):
        result = bpy.ops.object.bake(
            type="EMIT",
            margin=8,
            use_clear=True,
            target="IMAGE_TEXTURES",
            use_selected_to_active=False,
            save_mode="INTERNAL",
        )
    if result != {"FINISHED"}:
        raise RuntimeError("Cycles did not finish")
