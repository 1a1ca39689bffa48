# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels of the bake: settings, progress and the last report."""
from bpy.types import Panel

from .. import checks, job
from ..apply import record
from .common import Properties, Sidebar, draw_text


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
    draw_prediction(layout, context)


def draw_prediction(layout, context):
    """What a bake would take, once that was asked for this scene."""
    layout.operator("ajar.predict", icon="TIME")
    found = job.manager.predicted
    if found is None or found.scene != context.scene.name:
        return
    column = layout.column(align=True)
    column.label(text=f"At {found.density:g} texels per metre, {found.texels} texels:")
    for line in found.lines():
        column.label(text=line)
    for line in found.plan(context.scene.ajar.preset):
        draw_text(column, line, "DOT", context)


def draw_last_bake(layout, context):
    """Time, error and warnings of the last bake."""
    last = job.manager.last
    if last and last.result == "failed":
        draw_text(layout, last.message, "ERROR", context)
    bake = record.read_record(context.scene)
    if not bake:
        layout.label(text="Nothing is baked yet", icon="INFO")
        return
    column = layout.column(align=True)
    column.label(text=f"{bake.get('preset', '').capitalize()} in {_duration(bake.get('seconds', 0.0))}")
    shares = ", ".join(f"{name} {share:.0%}" for name, share in bake.get("time_shares", ()))
    if shares:
        draw_text(column, f"Time: {shares}", "TIME", context)
    if bake.get("time_limited"):
        column.label(text="Stopped by the time limit", icon="TIME")
    for line in _error_lines(bake.get("error", {})):
        column.label(text=line)
    check = bake.get("self_check")
    if check and "not_checked" in check:
        column.label(text=f"Not checked by brute force: {check['not_checked']}")
    elif check:
        column.label(
            text=f"Brute force agrees: {check['ratio']:.1%} ± {check['ratio_error']:.1%} of its light"
        )
    warnings = bake.get("warnings", [])
    if warnings:
        layout.label(text=f"{len(warnings)} warnings", icon="ERROR")
    for culprit, text in warnings[:12]:
        draw_text(layout.box(), f"{culprit}: {text}" if culprit else text, "DOT", context)


def _error_lines(error):
    if "unknown" in error:
        yield f"Error: unknown, {error['unknown']} (about {error['estimated_rms']:.0%} ± {error['spread']:.0%} of it)"
    elif "estimated_rms" in error:
        yield f"Error: {error['estimated_rms']:.1%} (95% of texels within {error.get('p95', 0.0):.1%})"
    if error.get("target"):
        yield f"Target: {error['target']:.1%}, reached by {error.get('share_reached', 0.0):.0%} of texels"
    following = error.get("next_step")
    if following:
        yield f"{following['noise']:.1%} would take about {_duration(following['seconds'])}"


class AJAR_PT_sidebar(Sidebar, Panel):
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
            draw_text(layout, "Use Rendered shading to see the baked light", "INFO", context)


class AJAR_PT_sidebar_last(Sidebar, Panel):
    """What the last bake reached."""

    bl_label = "Last Bake"
    bl_parent_id = "AJAR_PT_sidebar"

    def draw(self, context):
        """Draws the panel."""
        draw_last_bake(self.layout, context)
        if checks.flipped_objects(context.scene):
            row = self.layout.row(align=True)
            row.label(text="Look flipped:")
            row.operator("ajar.flipped", text="Select").action = "SELECT"
            row.operator("ajar.flipped", text="Bake Back").action = "BACK"
            row.operator("ajar.flipped", text="Flip").action = "FLIP"
        if context.scene.ajar.last_bake and context.scene.ajar.overlap_pictures:
            row = self.layout.row(align=True)
            row.operator("ajar.show_overlap", text="Show Overlap", icon="IMAGE_DATA").what = "overlap"
            row.operator("ajar.show_overlap", text="Show Bytes", icon="IMAGE_DATA").what = "bytes"


class AJAR_PT_render(Properties, Panel):
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


class AJAR_PT_render_more(Properties, Panel):
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
            "term_threshold",
            "light_patches",
            "overlap_pictures",
            "memory_limit",
            "seed",
            "threads",
        ):
            column.prop(ajar, name)
        layout.operator("ajar.prepare_uvs", icon="GROUP_UVS")
        layout.operator("ajar.clear", icon="TRASH")


CLASSES = (AJAR_PT_sidebar, AJAR_PT_sidebar_last, AJAR_PT_render, AJAR_PT_render_more)
