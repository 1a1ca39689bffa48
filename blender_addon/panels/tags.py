# SPDX-License-Identifier: GPL-3.0-or-later
"""Tags of objects, lamps, collections and worlds."""
from bpy.types import Panel

from ..extract.objects import GEOMETRY
from .common import Properties
from .elements import movable_owner


def _draw_movable(column, ajar):
    """What an object or collection is at run time."""
    column.prop(ajar, "movable")
    if ajar.movable == "DOOR":
        for name in ("open_pose", "bounce_when_closed"):
            column.prop(ajar, name)
        column.prop(ajar, "openness", slider=True)
    elif ajar.movable == "TOGGLE":
        column.prop(ajar, "presence", slider=True)
    if ajar.movable != "FIXED":
        column.prop(ajar, "combine")


def _draw_light_set(column, ajar, context):
    column.prop_search(ajar, "light_set", context.scene.ajar, "light_sets")


class AJAR_PT_object(Properties, Panel):
    """What a surface, or an empty with what hangs on it, is to the bake."""

    bl_context = "object"

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type in GEOMETRY | {"EMPTY"}

    def draw(self, context):
        """Draws the panel."""
        obj, column = context.object, self.split_layout().column()
        if obj.type != "EMPTY":
            column.prop(obj.ajar, "surface")
            row = column.row()
            row.enabled = obj.ajar.surface in {"AUTO", "LIGHTMAP"}
            row.prop(obj.ajar, "texel_scale")
            row = column.row()
            row.enabled = obj.ajar.surface in {"AUTO", "LIGHTMAP"}
            row.prop(obj.ajar, "bake_side")
        if obj.type != "EMPTY" or obj.instance_type == "COLLECTION":
            _draw_light_set(column, obj.ajar, context)
        column.separator()
        _draw_movable(column, obj.ajar)
        owner = movable_owner(obj)
        if owner not in (None, obj):
            column.label(text=f"Moves with {owner.name}", icon="LINKED")


class AJAR_PT_light(Properties, Panel):
    """What is baked of a lamp. Light tabs have the context 'data'."""

    bl_context = "data"

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type == "LIGHT"

    def draw(self, context):
        """Draws the panel."""
        column = self.split_layout().column()
        column.prop(context.object.ajar, "light_role")
        _draw_light_set(column, context.object.ajar, context)


class AJAR_PT_collection(Properties, Panel):
    """Tags that the members of a collection inherit."""

    bl_context = "collection"

    @classmethod
    def poll(cls, context):
        return context.collection is not None and context.collection != context.scene.collection

    def draw(self, context):
        """Draws the panel."""
        column = self.split_layout().column()
        _draw_light_set(column, context.collection.ajar, context)
        column.separator()
        _draw_movable(column, context.collection.ajar)
        if context.collection.ajar.movable != "FIXED":
            column.label(text="The whole collection is one element", icon="INFO")


class AJAR_PT_world(Properties, Panel):
    """Whether the sky is baked."""

    bl_context = "world"

    @classmethod
    def poll(cls, context):
        return context.world is not None

    def draw(self, context):
        """Draws the panel. While the preview is on, the artist's world waits in the record."""
        world = context.scene.ajar.preview_world or context.world
        self.split_layout().prop(world.ajar, "sky_role")


CLASSES = (AJAR_PT_object, AJAR_PT_light, AJAR_PT_collection, AJAR_PT_world)
