# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels: they draw properties, progress and the last report, and hold no logic."""
import textwrap

import bpy
from bpy.types import Panel, UIList

from . import job
from .apply import record

_SURFACES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}


def _duration(seconds):
    minutes, seconds = divmod(int(round(seconds)), 60)
    return f"{minutes} min {seconds} s" if minutes else f"{seconds} s"


def draw_progress(layout, context):
    """Bar, stage, remaining time and cancel button of the running job."""
    status = job.manager.status
    state = context.window_manager.ajar
    remaining = f", {_duration(status.remaining)} left" if status.remaining >= 0.0 else ""
    text = f"{status.stage.capitalize()}{remaining}"
    column = layout.column(align=True)
    if hasattr(column, "progress"):
        column.progress(factor=state.percent / 100.0, text=f"{state.percent:.0f}%")
    else:
        row = column.row()
        row.enabled = False
        row.prop(state, "percent", slider=True)
    column.label(text=text)
    layout.operator("ajar.cancel", icon="CANCEL")


def draw_bake(layout, context):
    """Bake or progress, and the preview toggle."""
    ajar = context.scene.ajar
    if job.manager.running:
        draw_progress(layout, context)
    else:
        column = layout.column(align=True)
        column.scale_y = 1.3
        column.operator("ajar.bake", icon="RENDER_STILL")
    layout.operator(
        "ajar.preview_toggle",
        icon="HIDE_OFF" if ajar.preview else "HIDE_ON",
        text="Preview Baked Light",
        depress=ajar.preview,
    )
    layout.operator("ajar.check", icon="CHECKMARK")


def draw_last_bake(layout, context):
    """Time, error and warnings of the last bake."""
    last = job.manager.last
    if last and last.result == "failed":
        _draw_text(layout, last.message, "ERROR", context)
    bake = record.read_record(context.scene)
    if not bake:
        layout.label(text="Nothing is baked yet", icon="INFO")
        return
    column = layout.column(align=True)
    column.label(text=f"{bake.get('preset', '').capitalize()} in {_duration(bake.get('seconds', 0.0))}")
    if bake.get("time_limited"):
        column.label(text="Stopped by the time limit", icon="TIME")
    for line in _error_lines(bake.get("error", {})):
        column.label(text=line)
    warnings = bake.get("warnings", [])
    if warnings:
        layout.label(text=f"{len(warnings)} warnings", icon="ERROR")
    for culprit, text in warnings[:12]:
        _draw_text(layout.box(), f"{culprit}: {text}" if culprit else text, "DOT", context)


def _error_lines(error):
    if "estimated_rms" in error:
        yield f"Error: {error['estimated_rms']:.1%} (95% of texels within {error.get('p95', 0.0):.1%})"
    if error.get("target"):
        yield f"Target: {error['target']:.1%}, reached by {error.get('share_reached', 0.0):.0%} of texels"
    following = error.get("next_step")
    if following:
        yield f"{following['noise']:.1%} would take about {_duration(following['seconds'])}"


def _draw_text(layout, text, icon, context):
    """Wraps text to the width of the region, at about seven pixels a letter."""
    width = int(context.region.width / (7.5 * context.preferences.system.ui_scale)) - 5
    column = layout.column(align=True)
    for index, line in enumerate(textwrap.wrap(text, max(width, 16))):
        column.label(text=line, icon=icon if index == 0 else "BLANK1")


class AJAR_UL_light_sets(UIList):
    """Light sets with their weights."""

    def draw_item(self, _context, layout, _data, item, _icon, _active_data, _active_property):
        """One set."""
        row = layout.row(align=True)
        row.prop(item, "name", text="", emboss=False, icon="OUTLINER_OB_LIGHT")
        row.prop(item, "weight", text="")


class _Sidebar:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Ajar"


class AJAR_PT_sidebar(_Sidebar, Panel):
    """Daily use: bake, cancel, preview."""

    bl_label = "Ajar"

    def draw(self, context):
        """Draws the panel."""
        layout = self.layout
        ajar = context.scene.ajar
        layout.prop(ajar, "preset", text="")
        draw_bake(layout, context)
        shading = context.space_data.shading
        if ajar.preview and shading.type != "RENDERED":
            # Other modes add light of their own, or show none.
            _draw_text(layout, "Use Rendered shading to see the baked light", "INFO", context)


class AJAR_PT_sidebar_last(_Sidebar, Panel):
    """What the last bake reached."""

    bl_label = "Last Bake"
    bl_parent_id = "AJAR_PT_sidebar"

    def draw(self, context):
        """Draws the panel."""
        draw_last_bake(self.layout, context)


class AJAR_PT_sidebar_sets(_Sidebar, Panel):
    """Light sets of the scene."""

    bl_label = "Light Sets"
    bl_parent_id = "AJAR_PT_sidebar"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        """Draws the panel."""
        ajar = context.scene.ajar
        row = self.layout.row()
        row.template_list("AJAR_UL_light_sets", "", ajar, "light_sets", ajar, "light_set_index", rows=3)
        column = row.column(align=True)
        column.operator("ajar.light_set_add", icon="ADD", text="")
        column.operator("ajar.light_set_remove", icon="REMOVE", text="")
        row = self.layout.row(align=True)
        row.operator("ajar.light_set_assign", text="Assign").clear = False
        row.operator("ajar.light_set_assign", text="Clear").clear = True


class _Properties:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_label = "Ajar"
    bl_options = {"DEFAULT_CLOSED"}

    def split_layout(self):
        """The layout in Blender's two-column style."""
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        return self.layout


class AJAR_PT_render(_Properties, Panel):
    """Bake settings of the scene."""

    bl_context = "render"
    bl_label = "Ajar Lightmaps"

    def draw(self, context):
        """Draws the panel."""
        layout, ajar = self.split_layout(), context.scene.ajar
        column = layout.column()
        for name in ("preset", "noise_target", "bounces", "time_limit"):
            column.prop(ajar, name)
        column.separator()
        for name in ("texels_per_meter", "atlas_size", "output_dir"):
            column.prop(ajar, name)
        draw_bake(layout, context)


class AJAR_PT_render_more(_Properties, Panel):
    """Settings that are seldom changed."""

    bl_context = "render"
    bl_label = "Advanced"
    bl_parent_id = "AJAR_PT_render"

    def draw(self, context):
        """Draws the panel."""
        layout, ajar = self.split_layout(), context.scene.ajar
        column = layout.column()
        for name in (
            "padding",
            "chart_angle",
            "keep_uvs",
            "stitch_seams",
            "keep_sh",
            "combinations",
            "seed",
            "threads",
        ):
            column.prop(ajar, name)
        layout.operator("ajar.prepare_uvs", icon="GROUP_UVS")
        layout.operator("ajar.clear", icon="TRASH")


class AJAR_PT_object(_Properties, Panel):
    """What a surface is to the bake."""

    bl_context = "object"

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type in _SURFACES

    def draw(self, context):
        """Draws the panel."""
        layout, ajar = self.split_layout(), context.object.ajar
        column = layout.column()
        column.prop(ajar, "surface")
        row = column.row()
        row.enabled = ajar.surface in {"AUTO", "LIGHTMAP"}
        row.prop(ajar, "texel_scale")
        column.prop_search(ajar, "light_set", context.scene.ajar, "light_sets")
        column.separator()
        column.prop(ajar, "movable")
        if ajar.movable == "DOOR":
            for name in ("open_pose", "bounce_when_closed", "openness"):
                column.prop(ajar, name)
        elif ajar.movable == "TOGGLE":
            column.prop(ajar, "presence")


class AJAR_PT_light(_Properties, Panel):
    """What is baked of a lamp. Light tabs have the context 'data'."""

    bl_context = "data"

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type == "LIGHT"

    def draw(self, context):
        """Draws the panel."""
        layout, ajar = self.split_layout(), context.object.ajar
        layout.prop(ajar, "light_role")
        layout.prop_search(ajar, "light_set", context.scene.ajar, "light_sets")


class AJAR_PT_world(_Properties, Panel):
    """Whether the sky is baked."""

    bl_context = "world"

    @classmethod
    def poll(cls, context):
        return context.world is not None

    def draw(self, context):
        """Draws the panel. While the preview is on, the artist's world waits in the record."""
        world = context.scene.ajar.preview_world or context.world
        self.split_layout().prop(world.ajar, "sky_role")


CLASSES = (
    AJAR_UL_light_sets,
    AJAR_PT_sidebar,
    AJAR_PT_sidebar_last,
    AJAR_PT_sidebar_sets,
    AJAR_PT_render,
    AJAR_PT_render_more,
    AJAR_PT_object,
    AJAR_PT_light,
    AJAR_PT_world,
)


def register():
    """Registers the panels."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    """Undoes register()."""
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
