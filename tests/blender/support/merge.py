# SPDX-License-Identifier: GPL-3.0-or-later
"""Merge lightmapped objects into few world-space meshes with page UVs: Cycles bakes one object at a
time and prepares the whole scene for each, so one merged object bakes far faster than hundreds."""
import bpy
import numpy as np

PAGE_UV = "AjarPage"
RENDER_UV = "AjarRenderUV"
_FLAGS = (
    'visible_camera',
    'visible_diffuse',
    'visible_glossy',
    'visible_transmission',
    'visible_shadow',
    'visible_volume_scatter',
)
_OBJECT_BOUND_NODES = ('ShaderNodeObjectInfo', 'ShaderNodeAttribute', 'ShaderNodeParticleInfo')


class Piece:
    """World-space arrays of one placed mesh."""

    def __init__(self, obj, instance, depsgraph):
        self.obj, self.name, self.page = obj, instance['name'], instance['page']
        evaluated = obj.evaluated_get(depsgraph)
        mesh = bpy.data.meshes.new_from_object(evaluated, preserve_all_data_layers=True, depsgraph=depsgraph)
        self.materials = [slot.material for slot in evaluated.material_slots] or [None]
        self._read(mesh, np.array(evaluated.matrix_world, np.float64))
        self._read_layers(mesh, instance)
        bpy.data.meshes.remove(mesh)

    def _read(self, mesh, matrix):
        mesh.calc_normals_split()
        points = _get(mesh.vertices, 'co', 3)
        self.points = points @ matrix[:3, :3].T + matrix[:3, 3]
        normals = _get(mesh.loops, 'normal', 3) @ np.linalg.inv(matrix[:3, :3])
        self.normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
        self.loop_vertex = _get(mesh.loops, 'vertex_index', 1, np.int32).ravel()
        self.start = _get(mesh.polygons, 'loop_start', 1, np.int32).ravel()
        self.total = _get(mesh.polygons, 'loop_total', 1, np.int32).ravel()
        self.slot = np.minimum(
            _get(mesh.polygons, 'material_index', 1, np.int32).ravel(), len(self.materials) - 1
        )
        self.smooth = _get(mesh.polygons, 'use_smooth', 1, np.bool_).ravel()
        self.order = _flipped(self.start, self.total) if np.linalg.det(matrix[:3, :3]) < 0 else None

    def _read_layers(self, mesh, instance):
        self.uvs = {layer.name: _get(layer.data, 'uv', 2) for layer in mesh.uv_layers}
        render = next((layer.name for layer in mesh.uv_layers if layer.active_render), None)
        self.uvs[RENDER_UV] = self.uvs.get(render, np.zeros((len(mesh.loops), 2)))
        lightmap = self.uvs[instance.get('uv_layer', 'AjarLightmap')]
        self.uvs[PAGE_UV] = lightmap * instance['uv_scale'] + instance['uv_offset']
        self.colors = {}
        for layer in mesh.color_attributes:
            values = _get(layer.data, 'color', 4)
            self.colors[layer.name] = values if layer.domain == 'CORNER' else values[self.loop_vertex]
        if self.order is not None:
            self._reorder()

    def keep_share(self, fraction, seed):
        """Take a random 1 - fraction of the polygons off the page, so that they are not baked."""
        if fraction >= 1.0:
            return
        dropped = np.random.default_rng(seed).random(len(self.start)) >= fraction
        loops = np.repeat(dropped, self.total)
        self.uvs[PAGE_UV] = np.where(loops[:, None], -1.0, self.uvs[PAGE_UV])

    def _reorder(self):
        """Reverse each polygon: a mirrored mesh keeps its outside."""
        self.loop_vertex, self.normals = self.loop_vertex[self.order], self.normals[self.order]
        self.uvs = {name: uv[self.order] for name, uv in self.uvs.items()}
        self.colors = {name: color[self.order] for name, color in self.colors.items()}


def _get(collection, name, size, kind=np.float32):
    values = np.empty(len(collection) * size, kind)
    collection.foreach_get(name, values)
    return values.reshape(-1, size).astype(np.float64) if kind == np.float32 else values.reshape(-1, size)


def _flipped(start, total):
    return np.concatenate([np.arange(s + t - 1, s - 1, -1) for s, t in zip(start, total)] or [[]]).astype(int)


def read_pieces(instances, warn=print):
    """Pieces of every manifest instance that is an object of this scene."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    pieces = []
    for instance in instances:
        obj = bpy.context.scene.objects.get(instance['name'])
        if obj is None:
            warn(f"warning: {instance['name']} is not an object of the scene, skipped")
        elif instance['page'] is not None:
            pieces.append(Piece(obj, instance, depsgraph))
    return pieces


def group_pieces(pieces):
    """Lists of pieces that may become one object without changing how they look."""
    groups = {}
    for piece in pieces:
        key = tuple(getattr(piece.obj, flag) for flag in _FLAGS)
        bound = any(_is_object_bound(material) for material in piece.materials)
        groups.setdefault((key, piece.name if bound else None), []).append(piece)
    return list(groups.values())


def _is_object_bound(material):
    """True if the look depends on the object it is on (object info, generated coordinates)."""
    if material is None or not material.use_nodes:
        return False
    for node in material.node_tree.nodes:
        if node.bl_idname in _OBJECT_BOUND_NODES:
            return True
        if node.bl_idname == 'ShaderNodeTexCoord' and any(
            node.outputs[name].is_linked for name in ('Generated', 'Object', 'Normal')
        ):
            return True
    return False


def build_object(pieces, find_material, name):
    """One object from pieces; find_material(material, page) gives each slot's material."""
    mesh = bpy.data.meshes.new(name)
    points = np.concatenate([p.points for p in pieces])
    first_point = np.cumsum([0] + [len(p.points) for p in pieces])
    first_loop = np.cumsum([0] + [len(p.loop_vertex) for p in pieces])
    mesh.vertices.add(len(points))
    mesh.vertices.foreach_set('co', points.astype(np.float32).ravel())
    mesh.loops.add(int(first_loop[-1]))
    mesh.loops.foreach_set(
        'vertex_index',
        np.concatenate([p.loop_vertex + f for p, f in zip(pieces, first_point)]).astype(np.int32),
    )
    mesh.polygons.add(sum(len(p.start) for p in pieces))
    mesh.polygons.foreach_set(
        'loop_start', np.concatenate([p.start + f for p, f in zip(pieces, first_loop)]).astype(np.int32)
    )
    mesh.polygons.foreach_set('loop_total', np.concatenate([p.total for p in pieces]).astype(np.int32))
    slots = _add_slots(mesh, pieces, find_material)
    mesh.polygons.foreach_set('material_index', slots)
    _add_layers(mesh, pieces)
    _set_normals(mesh, pieces)
    obj = bpy.data.objects.new(name, mesh)
    for flag in _FLAGS:
        setattr(obj, flag, getattr(pieces[0].obj, flag))
    bpy.context.scene.collection.objects.link(obj)
    obj.cycles.shadow_terminator_offset = 0.0
    obj.cycles.shadow_terminator_geometry_offset = 0.0
    return obj


def _add_slots(mesh, pieces, find_material):
    """Append every material that the pieces use; returns the slot of each polygon."""
    known, slots = {}, []
    for piece in pieces:
        table = []
        for material in piece.materials:
            target = find_material(material, piece.page)
            if target.name not in known:
                known[target.name] = len(mesh.materials)
                mesh.materials.append(target)
            table.append(known[target.name])
        slots.append(np.array(table, np.int32)[piece.slot])
    return np.concatenate(slots)


def _add_layers(mesh, pieces):
    names = [PAGE_UV, RENDER_UV] + sorted({n for p in pieces for n in p.uvs} - {PAGE_UV, RENDER_UV})
    for name in names[:8]:
        layer = mesh.uv_layers.new(name=name, do_init=False)
        values = [p.uvs.get(name, np.zeros((len(p.loop_vertex), 2))) for p in pieces]
        layer.data.foreach_set('uv', np.concatenate(values).astype(np.float32).ravel())
    mesh.uv_layers[RENDER_UV].active_render = True
    for name in sorted({n for p in pieces for n in p.colors}):
        layer = mesh.color_attributes.new(name, 'FLOAT_COLOR', 'CORNER')
        values = [p.colors.get(name, np.ones((len(p.loop_vertex), 4))) for p in pieces]
        layer.data.foreach_set('color', np.concatenate(values).astype(np.float32).ravel())


def _set_normals(mesh, pieces):
    any_smooth = any(p.smooth.any() for p in pieces)
    mesh.polygons.foreach_set('use_smooth', np.full(len(mesh.polygons), any_smooth))
    mesh.update(calc_edges=True)
    if any_smooth:
        mesh.use_auto_smooth = True
        mesh.auto_smooth_angle = np.pi
        mesh.normals_split_custom_set(np.concatenate([p.normals for p in pieces]).astype(np.float32))


def hide_originals(pieces):
    """Keep the merged objects out of the render; whatever refers to them stays intact."""
    for piece in pieces:
        piece.obj.hide_render = True
