# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panels share: places, and wrapped text."""
import textwrap


class Sidebar:
    """A panel in the Ajar tab of the 3D view's sidebar."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Ajar"


class Properties:
    """A panel in the Properties editor."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_label = "Ajar"
    bl_options = {"DEFAULT_CLOSED"}

    def split_layout(self):
        """The layout in Blender's two-column style."""
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        return self.layout


def draw_text(layout, text, icon, context):
    """Wraps text to the width of the region, at about seven pixels a letter."""
    scale = context.preferences.system.ui_scale or 1.0  # 0 without a window
    width = int(context.region.width / (7.5 * scale)) - 5
    column = layout.column(align=True)
    for index, line in enumerate(textwrap.wrap(text, max(width, 16))):
        column.label(text=line, icon=icon if index == 0 else "BLANK1")
