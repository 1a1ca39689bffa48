# SPDX-License-Identifier: GPL-3.0-or-later
"""ajar.flipped: what to do with objects that the last bake found to look flipped."""
from bpy.props import EnumProperty
from bpy.types import Operator

from .. import checks


class AJAR_OT_flipped(Operator):
    """Objects whose front, by the last bake, faces what nobody sees: select them, bake their back, or flip their \
normals. Objects that look flipped in part are only selected: their faces are for you to choose"""

    bl_idname = "ajar.flipped"
    bl_label = "Objects that Look Flipped"
    bl_options = {"REGISTER", "UNDO"}

    action: EnumProperty(
        name="Action",
        items=(
            ("SELECT", "Select", "Select them"),
            ("BACK", "Bake Back", "Set Bake side to Back; meshes stay as they are"),
            ("FLIP", "Flip Normals", "Flip the normals of their meshes"),
        ),
    )

    @classmethod
    def poll(cls, context):
        if context.mode != "OBJECT" or not checks.flipped_objects(context.scene):
            cls.poll_message_set("The last bake found none, or an object is being edited")
            return False
        return True

    def execute(self, context):
        """Does it to all of them, and says which are left."""
        found = checks.flipped_objects(context.scene)
        for obj in context.view_layer.objects:
            obj.select_set(obj in found)
        if self.action == "SELECT":
            return {"FINISHED"}
        left, meshes = [], set()
        for obj, whole in found.items():
            shared = self.action == "FLIP" and obj.data.users > 1 and obj.data not in meshes
            if not whole or shared or obj.data.library or obj.library:
                left.append(obj.name)
            elif self.action == "BACK":
                obj.ajar.bake_side = "BACK"
            elif obj.data not in meshes:
                meshes.add(obj.data)
                obj.data.flip_normals()
        if left:
            self.report(
                {"WARNING"}, "Left as they are (in part, linked, or a shared mesh): " + ", ".join(left)
            )
        return {"FINISHED"}


CLASSES = (AJAR_OT_flipped,)
