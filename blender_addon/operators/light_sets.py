# SPDX-License-Identifier: GPL-3.0-or-later
"""ajar.light_set_add, _remove, _assign, _per_light, _import."""
from bpy.props import BoolProperty, StringProperty
from bpy.types import Operator

from .. import light_sets, shine

_UNDO = {"REGISTER", "UNDO"}


def _shining(objects):
    """Those of the objects that a light set is for."""
    return [obj for obj in objects if obj.library is None and shine.shines(obj)]


def needs_selection(cls, context):
    """Poll of operators on the selection."""
    if context.selected_objects:
        return True
    cls.poll_message_set("Select objects first")
    return False


def needs_light(cls, context):
    """Poll of operators on selected lights and glowing meshes."""
    if any(shine.shines(obj) for obj in context.selected_objects):
        return True
    cls.poll_message_set("Select lights or meshes with an emissive material first")
    return False


class AJAR_OT_light_set_add(Operator):
    """Add a light set: lights that share one weight at run time"""

    bl_idname = "ajar.light_set_add"
    bl_label = "Add Light Set"
    bl_options = _UNDO

    name: StringProperty(name="Name", description="Empty: from the first selected light, else Set")
    from_selection: BoolProperty(
        name="From Selection", description="Put the selected lights and glowing meshes into the new set"
    )

    def execute(self, context):
        """Adds a set with a name of its own."""
        chosen = _shining(context.selected_objects) if self.from_selection else []
        if self.from_selection and not chosen:
            self.report({"ERROR"}, "Select lights or meshes with an emissive material first")
            return {"CANCELLED"}
        entry = light_sets.add(context.scene, self.name or (chosen[0].name if chosen else "Set"))
        for obj in chosen:
            obj.ajar.light_set = entry.name
        return {"FINISHED"}


class AJAR_OT_light_set_remove(Operator):
    """Remove the active light set; its lights belong to no set afterwards"""

    bl_idname = "ajar.light_set_remove"
    bl_label = "Remove Light Set"
    bl_options = _UNDO

    @classmethod
    def poll(cls, context):
        if not context.scene.ajar.light_sets:
            cls.poll_message_set("The scene has no light sets")
        return bool(context.scene.ajar.light_sets)

    def execute(self, context):
        """Removes the set and its name on objects and collections."""
        ajar = context.scene.ajar
        name = light_sets.active(context.scene).name
        index = ajar.light_sets.find(name)
        ajar.light_sets.remove(index)
        light_sets.retag(context.scene, name, "")
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
        return needs_selection(cls, context)

    def execute(self, context):
        """Writes the set's name on the selected objects."""
        entry = light_sets.active(context.scene)
        if not self.clear and not self.name and entry is None:
            self.report({"ERROR"}, "The scene has no light sets: add one first")
            return {"CANCELLED"}
        name = "" if self.clear else self.name or entry.name
        if name and name not in context.scene.ajar.light_sets:
            self.report({"ERROR"}, f"The scene has no light set {name}")
            return {"CANCELLED"}
        for obj in context.selected_objects:
            obj.ajar.light_set = name
        return {"FINISHED"}


class AJAR_OT_light_set_per_light(Operator):
    """Give each selected light or glowing mesh a light set of its own, named after it"""

    bl_idname = "ajar.light_set_per_light"
    bl_label = "One Set per Light"
    bl_options = _UNDO

    @classmethod
    def poll(cls, context):
        return needs_light(cls, context)

    def execute(self, context):
        """Adds the sets in order of name."""
        chosen = sorted(_shining(context.selected_objects), key=lambda obj: obj.name)
        for obj in chosen:
            obj.ajar.light_set = light_sets.add(context.scene, obj.name).name
        self.report({"INFO"}, f"Added {len(chosen)} light sets")
        return {"FINISHED"}


class AJAR_OT_light_set_import(Operator):
    """Make light sets of Blender's Light Groups. Lights that have a set keep it"""

    bl_idname = "ajar.light_set_import"
    bl_label = "Import Light Groups"
    bl_options = _UNDO

    @classmethod
    def poll(cls, context):
        if any(getattr(obj, "lightgroup", "") for obj in context.scene.objects):
            return True
        cls.poll_message_set("No object is in a Light Group (Object Properties > Shading)")
        return False

    def execute(self, context):
        """Tags lights and glowing meshes with sets named after their groups."""
        count = 0
        for obj in _shining(context.scene.objects):
            if not obj.lightgroup or obj.ajar.light_set:
                continue
            if obj.lightgroup not in context.scene.ajar.light_sets:
                light_sets.add(context.scene, obj.lightgroup)
            obj.ajar.light_set = obj.lightgroup
            count += 1
        world = context.scene.ajar.preview_world or context.scene.world
        if world is not None and getattr(world, "lightgroup", ""):
            self.report({"WARNING"}, f"{world.name}: the sky cannot be in a light set")
        self.report({"INFO"}, f"Put {count} lights into sets")
        return {"FINISHED"}


CLASSES = (
    AJAR_OT_light_set_add,
    AJAR_OT_light_set_remove,
    AJAR_OT_light_set_assign,
    AJAR_OT_light_set_per_light,
    AJAR_OT_light_set_import,
)
