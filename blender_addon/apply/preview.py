# SPDX-License-Identifier: GPL-3.0-or-later
"""The preview overlay: on and off, exactly.

Only material slots of objects are swapped, through links of the object, so meshes keep their
materials. What stood in a slot is remembered on the object by pointer: renaming, saving and
reloading do not break the way back.
"""
import bpy

from . import ghosts, lamps, live, world
from .images import live_pages, load_pages, remove_live
from .materials import GLOW, PLACEMENT, UV_LAYER, preview_material
from .record import absolute_path, read_record

_SURFACES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}


def show(context):
    """Turns the preview on from the scene's last bake. Returns warnings as (culprit, text);
    ValueError says what is missing."""
    scene = context.scene
    record = read_record(scene)
    if not record.get("package"):
        raise ValueError("nothing is baked yet: press Bake")
    hide()
    warnings = []
    session = live.start(scene, warnings)
    if session is None:
        pages, unmapped = load_pages(absolute_path(record["package"]))
    else:
        pages, unmapped = live_pages(session.runtime.page_count())
    glowing = session.looks.glowing() if session is not None else ()
    for obj in _shown_objects(context):
        if obj.type in _SURFACES and obj.library:
            warnings.append((obj.name, "linked from a library: shown without baked light"))
        elif obj.type in _SURFACES:
            _swap_slots(obj, _page_of(obj, pages, unmapped), scene, warnings, obj.name in glowing)
        elif obj.type == "LIGHT" and obj.library is None and obj.ajar.light_role in ("STATIC", "OFF"):
            ghosts.hold_flags(obj, True)
    world.show_camera_only(scene)
    scene.ajar.preview = True
    if session is not None:
        session.looks.prepare()
        session.refresh(everything=True)
    return warnings


def _shown_objects(context):
    """Objects of the scene and those it shows as instances, each once, in a fixed order."""
    found = {obj.name_full: obj for obj in context.scene.objects}
    for instance in context.evaluated_depsgraph_get().object_instances:
        if instance.is_instance:
            original = instance.object.original
            found.setdefault(original.name_full, original)
    return list(found.values())


def hide():
    """Turns the preview off: every slot, lamp and world as it was. Safe to call at any time."""
    live.stop()
    ghosts.clear_stage()
    for obj in bpy.data.objects:
        if obj.library is None:
            _restore_slots(obj)
            ghosts.restore(obj)
            lamps.restore(obj)
    for scene in bpy.data.scenes:
        for entry in scene.ajar.preview_meshes:
            _drop_added_slot(entry.data)
        scene.ajar.preview_meshes.clear()
        world.restore(scene, bpy.data.worlds.remove)
        scene.ajar.preview = False
    for collection in (bpy.data.materials, bpy.data.node_groups):
        for block in [block for block in collection if _is_preview(block)]:
            collection.remove(block)
    remove_live()


def _is_preview(block):
    if isinstance(block, bpy.types.Material):
        return block.ajar.is_preview
    return bool(block.get("ajar_preview"))


def _page_of(obj, pages, unmapped):
    page = obj.ajar.lightmap_page
    mapped = obj.type == "MESH" and UV_LAYER in obj.data.uv_layers
    return pages[page] if mapped and 0 <= page < len(pages) else unmapped


def _swap_slots(obj, page, scene, warnings, glow):
    if not obj.material_slots and not _add_slot(obj, scene):
        return
    placed = page.image is not None and is_placed(obj)
    if placed:
        obj[PLACEMENT] = [*obj.ajar.uv_scale, *obj.ajar.uv_offset]
    obj.ajar.preview_slots.clear()
    for slot in obj.material_slots:
        shown, entry = slot.material, obj.ajar.preview_slots.add()
        entry.link = slot.link
        slot.link = "OBJECT"
        entry.material = slot.material
        entry.preview = preview_material(shown, page, placed, warnings, glow)
        slot.material = entry.preview


def is_placed(obj):
    """True if the object's lightmap UVs need its own scale and offset."""
    return tuple(obj.ajar.uv_scale) != (1.0, 1.0) or tuple(obj.ajar.uv_offset) != (0.0, 0.0)


def _restore_slots(obj):
    """A slot that the artist filled anew while the preview was on keeps the new material."""
    for slot, entry in zip(obj.material_slots, obj.ajar.preview_slots):
        if slot.link == "OBJECT" and _ours(slot.material, entry):
            slot.material = entry.material
            slot.link = entry.link
    obj.ajar.preview_slots.clear()
    for name in (PLACEMENT, GLOW):
        if name in obj:
            del obj[name]


def _ours(material, entry):
    return material is None or material == entry.preview or material.ajar.is_preview


def _add_slot(obj, scene):
    """An object without slots gets an empty one, noted so that it can be taken away again."""
    materials = getattr(obj.data, "materials", None)
    if materials is None or obj.data.library:
        return False
    if not len(materials):
        materials.append(None)
        scene.ajar.preview_meshes.add().data = obj.data
    return True


def _drop_added_slot(data):
    if data is not None and len(data.materials) == 1 and data.materials[0] is None:
        data.materials.clear()
