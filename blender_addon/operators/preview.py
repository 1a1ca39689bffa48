# SPDX-License-Identifier: GPL-3.0-or-later
"""ajar.preview_toggle and ajar.show_overlap."""
from bpy.props import EnumProperty
from bpy.types import Operator

from ..apply import images, preview
from ..apply.record import absolute_path, read_record
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


class AJAR_OT_show_overlap(Operator):
    """Load the pictures of how many light sets, doors and toggles meet at each texel of the last bake, or of the bytes that this takes, into the image editor"""

    bl_idname = "ajar.show_overlap"
    bl_label = "Show Overlap"

    what: EnumProperty(
        items=(
            ("overlap", "Overlap", "Terms at each texel"),
            ("bytes", "Bytes", "Bytes of each texel in terms.bin"),
        ),
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context):
        """Needs a bake."""
        if not context.scene.ajar.last_bake:
            cls.poll_message_set("Nothing is baked yet: press Bake")
            return False
        return common.poll_idle(cls, context)

    def execute(self, context):
        """Loads the pictures; shows the first where an image editor is open."""
        try:
            pictures = images.load_overlap(absolute_path(read_record(context.scene)["package"]), self.what)
        except (OSError, ValueError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if not pictures:
            self.report(
                {"ERROR"},
                "The last bake has no such pictures: tick Overlap pictures under Advanced, bake again",
            )
            return {"CANCELLED"}
        for area in context.screen.areas if context.screen else ():
            if area.type == "IMAGE_EDITOR":
                area.spaces.active.image = pictures[0]
        self.report({"INFO"}, "In the image editor: " + ", ".join(image.name for image in pictures))
        return {"FINISHED"}


CLASSES = (AJAR_OT_preview_toggle, AJAR_OT_show_overlap)
