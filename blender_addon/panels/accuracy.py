# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of the accuracy measurement."""
from bpy.types import Panel

from .. import job
from .common import Sidebar, draw_text


def draw_accuracy(layout, context):
    """Buttons of the measurement, and what the last one said."""
    row = layout.row(align=True)
    row.operator("ajar.accuracy", text="Quick", icon="VIEWZOOM").quick = True
    row.operator("ajar.accuracy", text="All Settings").quick = False
    layout.operator("ajar.accuracy_show", icon="URL")
    last = job.manager.last
    if last and last.title == "Accuracy" and last.result == "done":
        draw_text(layout, last.message, "INFO", context)


class AJAR_PT_sidebar_accuracy(Sidebar, Panel):
    """How wrong bakes are here, and what less error costs."""

    bl_label = "Accuracy"
    bl_parent_id = "AJAR_PT_sidebar"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        """Draws the panel."""
        draw_accuracy(self.layout, context)


CLASSES = (AJAR_PT_sidebar_accuracy,)
