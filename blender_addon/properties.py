# SPDX-License-Identifier: GPL-3.0-or-later
"""What artists set, stored in the .blend: one property group per kind of data block.

The names are public: scripts, batch bakes and saved files rely on them.
"""
import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)
from bpy.types import PropertyGroup

from . import fields, light_sets
from .apply import live

_HIDDEN = {"HIDDEN"}
_NUMBERS = {"int": IntProperty, "float": FloatProperty}
_ENGINE_EXTRAS = tuple(
    field for field in fields.ENGINE_FIELDS if field.name in ("stitch_seams", "keep_sh", "overlap_pictures")
)


def _property(field):
    """The bpy property of a row of the field table."""
    about = {"name": field.label, "description": field.description, "default": field.default}
    if field.kind in _NUMBERS:
        about.update(min=field.minimum, max=field.maximum)
        if field.unit == "rad":
            about["subtype"] = "ANGLE"
        elif field.name in ("openness", "presence"):
            about.update(subtype="FACTOR", update=live.weight_changed)
        elif field.name == "noise_target":
            about.update(precision=4, step=0.1)
        return _NUMBERS[field.kind](**about)
    if field.kind == "bool":
        return BoolProperty(**about)
    if field.kind == "enum":
        return EnumProperty(items=field.items, **about)
    if field.name == "output_dir":
        about["subtype"] = "DIR_PATH"
    return StringProperty(**about)


def _properties(rows):
    return {field.name: _property(field) for field in rows}


class AJAR_LightSet(PropertyGroup):
    """Lights that share one weight at run time."""

    name: StringProperty(name="Name", default="Set", update=light_sets.keep_name)
    known_name: StringProperty(options=_HIDDEN, description="Name that objects are tagged with")
    baked_name: StringProperty(options=_HIDDEN, description="Its name in the last bake")
    weight: FloatProperty(
        name="Weight",
        default=1.0,
        min=0.0,
        soft_max=2.0,
        update=live.weight_changed,
        description="Strength of this set's light, 1 as baked",
    )
    color: FloatVectorProperty(
        name="Color",
        subtype="COLOR",
        size=3,
        default=(1.0, 1.0, 1.0),
        min=0.0,
        soft_max=1.0,
        update=live.weight_changed,
        description="Tint of this set's light at run time, white as baked",
    )
    combine: BoolProperty(
        name="Combine",
        default=True,
        description="Bake the combinations of this set with doors and toggles too, where they overlap",
    )


class AJAR_SlotRecord(PropertyGroup):
    """What stood in a material slot before the preview took it."""

    material: PointerProperty(type=bpy.types.Material)
    preview: PointerProperty(type=bpy.types.Material)
    link: StringProperty(default="DATA")


class AJAR_DataRecord(PropertyGroup):
    """Object data that got an empty slot for the preview."""

    data: PointerProperty(type=bpy.types.ID)


class AJAR_SceneSettings(PropertyGroup):
    """Scene.ajar: settings of the bake."""

    __annotations__ = {
        **_properties(fields.SCENE_FIELDS + _ENGINE_EXTRAS),
        "keep_uvs": BoolProperty(
            name="Keep Lightmap UVs",
            default=False,
            description="Keep the charts of existing AjarLightmap layers and only pack them anew",
        ),
        "light_sets": CollectionProperty(type=AJAR_LightSet),
        "light_set_index": IntProperty(options=_HIDDEN),
        "last_bake": StringProperty(options=_HIDDEN, description="Record of the last bake, JSON"),
        "data_version": IntProperty(options=_HIDDEN),
        "preview": BoolProperty(options=_HIDDEN, description="The preview is on"),
        "preview_world": PointerProperty(type=bpy.types.World, options=_HIDDEN),
        "preview_meshes": CollectionProperty(type=AJAR_DataRecord, options=_HIDDEN),
    }


class AJAR_ObjectSettings(PropertyGroup):
    """Object.ajar: what the object is to the bake, and where its lightmap lies."""

    __annotations__ = {
        **_properties(fields.OBJECT_FIELDS),
        "open_pose": PointerProperty(
            name="Open Pose",
            type=bpy.types.Object,
            description="Object that stands where this door is when it is open",
        ),
        "lightmap_page": IntProperty(default=-1, min=-1, options=_HIDDEN),
        "uv_scale": FloatVectorProperty(size=2, default=(1.0, 1.0), options=_HIDDEN),
        "uv_offset": FloatVectorProperty(size=2, default=(0.0, 0.0), options=_HIDDEN),
        "preview_slots": CollectionProperty(type=AJAR_SlotRecord, options=_HIDDEN),
        "preview_hidden": BoolProperty(options=_HIDDEN),
        "saved_hide_viewport": BoolProperty(options=_HIDDEN),
        "saved_hide_render": BoolProperty(options=_HIDDEN),
        "saved_eyes": StringProperty(options=_HIDDEN),
        "saved_rays": IntProperty(default=-1, options=_HIDDEN),
        "saved_instance_type": StringProperty(options=_HIDDEN),
        "saved_light": PointerProperty(type=bpy.types.Light, options=_HIDDEN),
        "baked_name": StringProperty(options=_HIDDEN, description="Name of its element in the last bake"),
    }


class AJAR_CollectionSettings(PropertyGroup):
    """Collection.ajar: tags that the members inherit. A movable collection is one element."""

    __annotations__ = {
        **_properties(fields.COLLECTION_FIELDS),
        "open_pose": PointerProperty(
            name="Open Pose",
            type=bpy.types.Object,
            description="Object that stands where this door is when it is open, with its children",
        ),
        "baked_name": StringProperty(options=_HIDDEN, description="Name of its element in the last bake"),
    }


class AJAR_WorldSettings(PropertyGroup):
    """World.ajar."""

    __annotations__ = {
        **_properties(fields.WORLD_FIELDS),
        "is_preview": BoolProperty(options=_HIDDEN),
    }


class AJAR_MaterialSettings(PropertyGroup):
    """Material.ajar: marks the materials that the preview made."""

    is_preview: BoolProperty(options=_HIDDEN)
    source: PointerProperty(type=bpy.types.Material, options=_HIDDEN)
    key: StringProperty(options=_HIDDEN)


class AJAR_ImageSettings(PropertyGroup):
    """Image.ajar: marks the images that a bake made."""

    is_page: BoolProperty(options=_HIDDEN)
    live_page: IntProperty(default=-1, min=-2, options=_HIDDEN)


class AJAR_JobState(PropertyGroup):
    """WindowManager.ajar: the running bake as the panels show it; never saved."""

    percent: FloatProperty(name="Progress", min=0.0, max=100.0, precision=0, subtype="PERCENTAGE")


CLASSES = (
    AJAR_LightSet,
    AJAR_SlotRecord,
    AJAR_DataRecord,
    AJAR_SceneSettings,
    AJAR_ObjectSettings,
    AJAR_CollectionSettings,
    AJAR_WorldSettings,
    AJAR_MaterialSettings,
    AJAR_ImageSettings,
    AJAR_JobState,
)
_OWNERS = (
    (bpy.types.Scene, AJAR_SceneSettings),
    (bpy.types.Object, AJAR_ObjectSettings),
    (bpy.types.Collection, AJAR_CollectionSettings),
    (bpy.types.World, AJAR_WorldSettings),
    (bpy.types.Material, AJAR_MaterialSettings),
    (bpy.types.Image, AJAR_ImageSettings),
    (bpy.types.WindowManager, AJAR_JobState),
)


def register():
    """Registers the groups and hangs them on their data blocks as `.ajar`."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    for owner, group in _OWNERS:
        owner.ajar = PointerProperty(type=group)


def unregister():
    """Undoes register()."""
    for owner, _group in reversed(_OWNERS):
        del owner.ajar
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
