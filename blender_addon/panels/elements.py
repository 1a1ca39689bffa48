# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of light sets, and the weight of the active object's door or toggle."""
from bpy.types import Menu, Panel, UIList

from .. import light_sets
from ..extract.tags import kind_of
from .common import Properties, Sidebar

WEIGHTS = {"door": "openness", "toggle": "presence"}


class AJAR_UL_light_sets(UIList):
    """Light sets with their colours and weights."""

    def draw_item(self, _context, layout, _data, item, _icon, _active_data, _active_property):
        """One set."""
        row = layout.row(align=True)
        row.prop(item, "name", text="", emboss=False, icon="OUTLINER_OB_LIGHT")
        tint = row.row(align=True)
        tint.scale_x = 0.4
        tint.prop(item, "color", text="")
        row.prop(item, "weight", text="")


class AJAR_MT_light_sets(Menu):
    """What is seldom done with light sets."""

    bl_label = "Light Set Specials"

    def draw(self, _context):
        """Draws the menu."""
        self.layout.operator("ajar.light_set_per_light", icon="OUTLINER_DATA_LIGHT")
        self.layout.operator("ajar.light_set_import", icon="IMPORT")


def draw_light_sets(layout, context):
    """The list with its buttons."""
    ajar = context.scene.ajar
    row = layout.row()
    row.template_list("AJAR_UL_light_sets", "", ajar, "light_sets", ajar, "light_set_index", rows=4)
    column = row.column(align=True)
    column.operator("ajar.light_set_add", icon="ADD", text="").from_selection = False
    column.operator("ajar.light_set_remove", icon="REMOVE", text="")
    column.separator()
    column.menu("AJAR_MT_light_sets", icon="DOWNARROW_HLT", text="")
    layout.operator("ajar.light_set_add", icon="LIGHT", text="New from Selection").from_selection = True
    row = layout.row(align=True)
    row.operator("ajar.light_set_assign", text="Assign").clear = False
    row.operator("ajar.light_set_assign", text="Clear").clear = True


class AJAR_PT_sidebar_sets(Sidebar, Panel):
    """Light sets of the scene."""

    bl_label = "Light Sets"
    bl_parent_id = "AJAR_PT_sidebar"

    def draw(self, context):
        """Draws the panel."""
        draw_light_sets(self.layout, context)


class AJAR_PT_sidebar_movables(Sidebar, Panel):
    """Doors and toggles: marks, and the weight of the one that the active object is part of."""

    bl_label = "Doors and Toggles"
    bl_parent_id = "AJAR_PT_sidebar"

    def draw(self, context):
        """Draws the panel."""
        layout = self.layout
        row = layout.row(align=True)
        row.operator("ajar.door_mark", text="Door", icon="MOD_HUE_SATURATION")
        row.operator("ajar.toggle_mark", text="Toggle", icon="HIDE_OFF").clear = False
        row.operator("ajar.toggle_mark", text="", icon="X").clear = True
        owner = movable_owner(context.object)
        if owner is None:
            layout.label(text="The active object is fixed")
            return
        kind = kind_of(owner)
        layout.label(text=f"{kind.capitalize()} {owner.name}")
        layout.prop(owner.ajar, WEIGHTS[kind], slider=True)


def movable_owner(obj):
    """The tagged object or collection that moves an object, by its own or an inherited tag, or None.
    Cheap enough to draw: open poses and outer collections are not looked through."""
    holder = obj
    while holder is not None:
        for owner in (holder, *holder.users_collection):
            if kind_of(owner):
                return owner
        holder = holder.parent
    return None


class AJAR_PT_render_sets(Properties, Panel):
    """Light sets of the scene and what is baked of their combinations."""

    bl_context = "render"
    bl_label = "Light Sets"
    bl_parent_id = "AJAR_PT_render"

    def draw(self, context):
        """Draws the panel."""
        layout = self.layout
        draw_light_sets(layout, context)
        entry = light_sets.active(context.scene)
        if entry is not None:
            column = self.split_layout().column()
            for name in ("weight", "color", "combine"):
                column.prop(entry, name)


CLASSES = (
    AJAR_UL_light_sets,
    AJAR_MT_light_sets,
    AJAR_PT_sidebar_sets,
    AJAR_PT_sidebar_movables,
    AJAR_PT_render_sets,
)
