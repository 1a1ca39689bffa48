# SPDX-License-Identifier: GPL-3.0-or-later
"""ajar.door_mark, ajar.toggle_mark."""
from bpy.props import BoolProperty
from bpy.types import Operator

from ..extract.objects import GEOMETRY
from .light_sets import needs_selection

_UNDO = {"REGISTER", "UNDO"}
_HOLDERS = GEOMETRY | {"EMPTY"}


class AJAR_OT_door_mark(Operator):
    """Mark the active object, with its children, as the closed leaf of a door. A second selected \
object becomes its open pose"""

    bl_idname = "ajar.door_mark"
    bl_label = "Mark as Door"
    bl_options = _UNDO

    hide_pose: BoolProperty(
        name="Hide Open Pose in Renders",
        default=True,
        description="Renders then show the door closed; the bake takes the pose for the open door all the same",
    )

    @classmethod
    def poll(cls, context):
        if context.object is None or context.object.type not in _HOLDERS:
            cls.poll_message_set("Make the closed leaf the active object")
            return False
        return True

    def execute(self, context):
        """Marks the active object."""
        door = context.object
        others = [obj for obj in context.selected_objects if obj != door and obj.type in _HOLDERS]
        others = [obj for obj in others if not _has_ancestor_in(obj, [door, *others])]
        door.ajar.movable = "DOOR"
        if len(others) == 1:
            door.ajar.open_pose = others[0]
            others[0].hide_render = self.hide_pose or others[0].hide_render
        elif others:
            self.report({"WARNING"}, "Several open poses are selected: none was set")
        return {"FINISHED"}


class AJAR_OT_toggle_mark(Operator):
    """Mark each selected object, with its children, as something the game can hide"""

    bl_idname = "ajar.toggle_mark"
    bl_label = "Mark as Toggle"
    bl_options = _UNDO

    clear: BoolProperty(name="Clear", description="Make the selected doors and toggles fixed instead")

    @classmethod
    def poll(cls, context):
        return needs_selection(cls, context)

    def execute(self, context):
        """Marks the selected objects but those whose parents are marked, too."""
        chosen = [obj for obj in context.selected_objects if obj.type in _HOLDERS and obj.library is None]
        roots = [obj for obj in chosen if not _has_ancestor_in(obj, chosen)]
        for obj in chosen if self.clear else roots:
            obj.ajar.movable = "FIXED" if self.clear else "TOGGLE"
        if not chosen:
            self.report({"WARNING"}, "No mesh or empty is selected")
            return {"CANCELLED"}
        return {"FINISHED"}


def _has_ancestor_in(obj, objects):
    parent = obj.parent
    while parent is not None:
        if parent in objects:
            return True
        parent = parent.parent
    return False


CLASSES = (AJAR_OT_door_mark, AJAR_OT_toggle_mark)
