# SPDX-License-Identifier: GPL-3.0-or-later
"""ajar.preview_toggle."""
from bpy.types import Operator

from ..apply import preview
from . import common


class AJAR_OT_preview_toggle(Operator):
    """Show the scene with its baked light, or go back to the materials and lights as they were"""

    bl_idname = "ajar.preview_toggle"
    bl_label = "Preview Baked Light"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not context.scene.ajar.preview and not context.scene.ajar.last_bake:
            cls.poll_message_set("Nothing is baked yet: press Bake")
            return False
        return common.poll_idle(cls, context)

    def execute(self, context):
        """Turns the preview on or off."""
        if context.scene.ajar.preview:
            preview.hide()
            return {"FINISHED"}
        try:
            warnings = preview.show(context)
        except ValueError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for culprit, text in warnings[:20]:
            self.report({"WARNING"}, f"{culprit}: {text}")
        return {"FINISHED"}


CLASSES = (AJAR_OT_preview_toggle,)
