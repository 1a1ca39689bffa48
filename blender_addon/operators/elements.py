# SPDX-License-Identifier: GPL-3.0-or-later
"""Light sets and doors: ajar.light_set_add, _remove, _assign, ajar.door_mark."""
from bpy.props import BoolProperty, StringProperty
from bpy.types import Operator

_UNDO = {"REGISTER", "UNDO"}


def _needs_selection(cls, context):
    if context.selected_objects:
        return True
    cls.poll_message_set("Select objects first")
    return False


def _needs_set(cls, context):
    if context.scene.ajar.light_sets:
        return True
    cls.poll_message_set("The scene has no light sets: add one first")
    return False


class AJAR_OT_light_set_add(Operator):
    """Add a light set: lights that share one weight at run time"""

    bl_idname = "ajar.light_set_add"
    bl_label = "Add Light Set"
    bl_options = _UNDO

    name: StringProperty(name="Name", default="Set")

    def execute(self, context):
        """Adds a set with a name of its own."""
        ajar = context.scene.ajar
        taken, name, number = {entry.name for entry in ajar.light_sets}, self.name or "Set", 1
        while name in taken:
            name = f"{self.name or 'Set'}.{number:03d}"
            number += 1
        ajar.light_sets.add().name = name
        ajar.light_set_index = len(ajar.light_sets) - 1
        return {"FINISHED"}


class AJAR_OT_light_set_remove(Operator):
    """Remove the active light set; its lights belong to no set afterwards"""

    bl_idname = "ajar.light_set_remove"
    bl_label = "Remove Light Set"
    bl_options = _UNDO

    @classmethod
    def poll(cls, context):
        return _needs_set(cls, context)

    def execute(self, context):
        """Removes the set and its name on objects."""
        ajar = context.scene.ajar
        index = min(ajar.light_set_index, len(ajar.light_sets) - 1)
        name = ajar.light_sets[index].name
        for obj in context.scene.objects:
            if obj.ajar.light_set == name and obj.library is None:
                obj.ajar.light_set = ""
        ajar.light_sets.remove(index)
        ajar.light_set_index = max(0, index - 1)
        return {"FINISHED"}


class AJAR_OT_light_set_assign(Operator):
    """Put the selected lights and emissive meshes into the active light set"""

    bl_idname = "ajar.light_set_assign"
    bl_label = "Assign to Light Set"
    bl_options = _UNDO

    name: StringProperty(name="Set", description="Name of the set; empty for the active one")
    clear: BoolProperty(name="Clear", description="Take the objects out of their sets instead")

    @classmethod
    def poll(cls, context):
        return _needs_selection(cls, context)

    def execute(self, context):
        """Writes the set's name on the selected objects."""
        ajar = context.scene.ajar
        name = self.name
        if not name and not self.clear:
            if not ajar.light_sets:
                self.report({"ERROR"}, "The scene has no light sets: add one first")
                return {"CANCELLED"}
            name = ajar.light_sets[min(ajar.light_set_index, len(ajar.light_sets) - 1)].name
        if not self.clear and name not in ajar.light_sets:
            self.report({"ERROR"}, f"The scene has no light set {name}")
            return {"CANCELLED"}
        for obj in context.selected_objects:
            obj.ajar.light_set = "" if self.clear else name
        return {"FINISHED"}


class AJAR_OT_door_mark(Operator):
    """Mark the active object as a door. A second selected object becomes its open pose"""

    bl_idname = "ajar.door_mark"
    bl_label = "Mark as Door"
    bl_options = _UNDO

    @classmethod
    def poll(cls, context):
        if context.object is None or context.object.type != "MESH":
            cls.poll_message_set("Make the closed leaf (a mesh) the active object")
            return False
        return True

    def execute(self, context):
        """Marks the active object."""
        door = context.object
        others = [obj for obj in context.selected_objects if obj != door and obj.type == "MESH"]
        door.ajar.movable = "DOOR"
        if len(others) == 1:
            door.ajar.open_pose = others[0]
        elif others:
            self.report({"WARNING"}, "Several open poses are selected: none was set")
        return {"FINISHED"}


CLASSES = (AJAR_OT_light_set_add, AJAR_OT_light_set_remove, AJAR_OT_light_set_assign, AJAR_OT_door_mark)
