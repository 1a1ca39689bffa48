# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluated scene -> snapshot directory (format: see bridge.snapshot_io)."""

from dataclasses import dataclass, field

import bpy

from .. import model
from ..bridge.snapshot_write import ArrayWriter
from . import objects
from .compat import ajar, transform
from .cycles_bake import SocketBaker
from .elements import ElementTable
from .images import TextureStore
from .light import extract_light
from .material import MaterialTable
from .mesh import evaluated_mesh, lightmap_uv, read_mesh, write_mesh
from .placed import Placed
from .visibility import render_view, rendered
from .world import extract_sky

GENERATOR = "Ajar Blender add-on"


@dataclass
class ExtractResult:
    """What was written: warnings [(culprit, text)], instances [(object name, 'lightmap'|'occluder')]."""

    warnings: list = field(default_factory=list)
    instances: list = field(default_factory=list)
    triangles: int = 0
    lights: int = 0


def write_snapshot(context, directory, engine_settings, layout=None):
    """Writes snapshot.json and snapshot.bin of the scene in context to directory.

    engine_settings: names of ajar_settings (model.engine_settings). layout: {"pages": [{"width",
    "height"}], "objects": {object name: {"page", "scale", "offset"}}} as made by
    layout.read_layout; objects not in it are occluders. Returns ExtractResult. Raises OSError if
    the directory cannot be written. The user's scene is as before when it returns or raises.
    """
    warnings = model.Warnings()
    elements = ElementTable(context.scene, warnings)
    shown = render_view(context, elements.tags.poses())
    with ArrayWriter(directory, "snapshot") as writer, shown as (depsgraph, visible):
        extraction = _Extraction(context.scene, depsgraph, visible, writer, warnings, layout or {}, elements)
        data = extraction.run()
        data.update(settings=dict(engine_settings), warnings=warnings.as_json())
        writer.finish(data)
    return ExtractResult(
        list(warnings.items),
        [(i["name"], i["surface"]) for i in data["instances"]],
        sum(m["triangle_count"] for m in data["meshes"]),
        len(data["lights"]),
    )


class _Extraction:
    """One pass over the instances of a depsgraph."""

    def __init__(self, scene, depsgraph, visible, writer, warnings, layout, elements):
        self.scene, self.depsgraph, self.visible = scene, depsgraph, visible
        self.writer, self.warnings = writer, warnings
        self.pages, self.places = layout.get("pages", []), layout.get("objects", {})
        self.store = TextureStore(writer)
        self._baked = {}
        self.materials = MaterialTable(self.store, warnings, self._baker)
        self.mesh_records, self._meshes, self._mesh_ids = [], [], {}
        self.placed, self.lights, self.elements = [], [], elements

    def run(self):
        """The snapshot's dict, all arrays written."""
        for instance in self.depsgraph.object_instances:
            if rendered(instance, self.visible):
                self._instance(instance)
        # Not while iterating: baking materials and sky may make Blender rebuild its graph.
        instances = [self._instance_record(p) for p in self.placed]
        sky = extract_sky(self.scene, self.store, self.warnings)
        return {
            "name": _scene_name(self.scene),
            "generator": GENERATOR,
            "pages": self.pages,
            "textures": self.store.items,
            "materials": self.materials.items,
            "meshes": self.mesh_records,
            "elements": self.elements.finish(),
            "instances": instances,
            "lights": self.lights,
            "sky": sky,
        }

    def _instance(self, instance):
        obj = instance.object
        if obj.type == "LIGHT":
            name = self._name(instance)
            light = extract_light(
                obj, instance.matrix_world, name, self.scene.render.engine, self.store, self.warnings
            )
            if light is not None:
                self.lights.append(light)
                self.elements.link_light(light, obj.original, _instancer(instance))
        elif obj.type in objects.GEOMETRY and ajar(obj, "surface") != "IGNORE":
            self._geometry(instance)
        if obj.particle_systems and any(p.settings.render_type == "PATH" for p in obj.particle_systems):
            self.warnings.add(obj.original.name, "hair is not simulated")

    def _name(self, instance):
        if not instance.is_instance:
            return instance.object.original.name
        parent = instance.parent.original.name if instance.parent is not None else ""
        index = "_".join(str(i) for i in instance.persistent_id if i != 0x7FFFFFFF)
        return f"{parent}/{instance.object.original.name}.{index}"

    def _geometry(self, instance):
        obj, name = instance.object, self._name(instance)
        mesh_id = self._mesh(obj)
        if mesh_id is None:
            self.warnings.add(obj.original.name, "has no faces: skipped")
            return
        mesh = self._meshes[mesh_id]
        if self._is_listed(instance, mesh):
            return
        placed = Placed(
            name,
            obj.original,
            mesh,
            mesh_id,
            instance.matrix_world.copy(),
            _slots(obj, mesh),
            add_layer=self._add_layer,
            instancer=_instancer(instance),
            occurrence=_occurrence(instance),
        )
        if not instance.is_instance:
            placed.depsgraph = self.depsgraph
        self._choose_surface(instance, placed)
        self.placed.append(placed)

    def _is_listed(self, instance, mesh):
        """Blender lists curves, texts and the like twice: as themselves, then as the mesh that they become."""
        source = instance.object.original
        if not instance.is_instance or source.type == "MESH":
            return False
        return any(
            p.source == source
            and p.matrix == instance.matrix_world
            and len(p.mesh.corner_vertex) == len(mesh.corner_vertex)
            for p in self.placed
        )

    def _choose_surface(self, instance, placed):
        obj = placed.source
        if not objects.wants_lightmap(obj):
            return
        why = self._obstacle(instance, placed)
        if why:
            culprit = (
                obj.name
                if not instance.is_instance or instance.parent is None
                else instance.parent.original.name
            )
            self.warnings.add(culprit, why)
            return
        placed.surface, placed.place = "lightmap", self.places[obj.name]
        page = self.pages[placed.place["page"]]
        placed.page_size = (page["width"], page["height"])

    def _obstacle(self, instance, placed):
        """Why an instance that should have a lightmap cannot, or ''."""
        obj, uv = placed.source, lightmap_uv(placed.mesh)
        if instance.is_instance:
            return f"instances of '{obj.name}' cannot carry lightmap UVs of their own: baked as occluders"
        why = objects.obstacle(obj)
        if why:
            return why + ": baked as an occluder"
        if objects.copies_overlap(obj, uv):
            return objects.copy_warning(obj)
        if obj.name not in self.places or uv is None:
            return "has no lightmap UVs: baked as an occluder"
        return ""

    def _mesh(self, obj):
        """Id of an evaluated object's mesh; shared meshes are read once. None if it is empty."""
        key = ("mesh", obj.data.as_pointer()) if obj.type == "MESH" else ("object", obj.original.name_full)
        if key not in self._mesh_ids:
            with evaluated_mesh(obj) as mesh:
                data = None
                if mesh is not None:
                    data = read_mesh(mesh, obj.data.name)
            self._mesh_ids[key] = self._write(data)
        return self._mesh_ids[key]

    def _write(self, data):
        if data is None:
            return None
        self._meshes.append(data)
        self.mesh_records.append(write_mesh(self.writer, data))
        return len(self._meshes) - 1

    def _add_layer(self, mesh_id, name, uv):
        self._meshes[mesh_id].uv_layers[name] = uv
        record = self.mesh_records[mesh_id]
        record["uv_layers"].append(self.writer.add(uv, "f32"))
        record["uv_layer_names"].append(name)

    def _baker(self, owner, material):
        return SocketBaker(owner, material, self.store, self.warnings, self._baked)

    def _instance_record(self, placed):
        obj, mesh = placed.source, placed.mesh
        record = {
            "name": placed.name,
            "mesh": placed.mesh_id,
            "transform": transform(placed.matrix),
            "materials": [self.materials.material_id(m, placed) for m in placed.materials],
            "surface": placed.surface,
            "visibility": [
                name
                for name, flag in (("gather", obj.visible_diffuse), ("shadow", obj.visible_shadow))
                if flag
            ],
        }
        if placed.surface == "lightmap":
            place = placed.place
            record.update(
                lightmap_layer=mesh.uv_index(model.LIGHTMAP_UV),
                page=place["page"],
                uv_scale=list(place["scale"]),
                uv_offset=list(place["offset"]),
            )
            if obj.ajar.bake_side == "BACK":
                record["bake_side"] = "back"
        glows = any(self.materials.emits(m) for m in record["materials"])
        self.elements.link_movable(record, obj, placed.instancer, placed.occurrence)
        self.elements.link_glow(record, obj, placed.instancer, glows)
        return record


def _instancer(instance):
    """The original object that makes an instance; None for a real object."""
    return instance.parent.original if instance.is_instance and instance.parent is not None else None


def _occurrence(instance):
    """Tells apart what an instancer places several times through instancers inside of it."""
    outer = [str(i) for i in instance.persistent_id[1:] if i != 0x7FFFFFFF] if instance.is_instance else []
    return "." + "_".join(outer) if outer else ""


def _slots(obj, mesh):
    """Original materials of an object's slots, None where a slot is empty, one per slot in use.

    Slots linked to the object win; geometry nodes may have added materials to the mesh alone.
    """
    slots = list(obj.material_slots)
    materials = []
    for index in range(max(len(slots), len(mesh.materials), 1)):
        material = mesh.materials[index] if index < len(mesh.materials) else None
        if index < len(slots) and (slots[index].link == "OBJECT" or material is None):
            material = slots[index].material
        materials.append(material.original if material is not None else None)
    # Faces with an index past the slots show the last one.
    return materials + materials[-1:] * (int(mesh.triangle_slot.max()) + 1 - len(materials))


def _scene_name(scene):
    path = bpy.data.filepath
    return bpy.path.display_name_from_filepath(path) if path else scene.name
