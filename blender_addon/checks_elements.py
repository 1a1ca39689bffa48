# SPDX-License-Identifier: GPL-3.0-or-later
"""Findings about light sets, doors and toggles."""
from collections import Counter

from .extract.objects import GEOMETRY
from .extract.tags import Tags, kind_of
from .findings import error, warning
from .shine import hidden, shines

MAX_ELEMENTS = 65000  # as in the engine


def check(context):
    """All of them for the scene in context."""
    context.view_layer.update()  # scripts may just have linked objects
    scene, tags = context.scene, Tags(context.scene)
    shown = Shown(scene, context.view_layer, tags)
    yield from _sets(scene, tags, shown)
    parts = _count_parts(tags, shown)
    for owner in tags.owners():
        yield from _owner(owner, parts)
        if kind_of(owner) == "door" and owner.ajar.open_pose is not None:
            yield from _pose(context, shown, owner, owner.ajar.open_pose)
    for owner, pose, first in tags.shared_poses:
        yield warning(
            owner.name,
            f"has the open pose {pose.name}, which belongs to {first.name}",
            "Give each door an open pose of its own",
        )
    count = len(scene.ajar.light_sets) + len(tags.owners())
    if count > MAX_ELEMENTS:
        text = f"the scene has {count} light sets, doors and toggles, more than {MAX_ELEMENTS}"
        yield error("", text, "Put lights or props that change together into one")


class Shown:
    """Which objects are there, and which of them render."""

    def __init__(self, scene, view_layer, tags):
        self.placed = {obj.name_full for obj in view_layer.objects}
        self.instanced = tags.objects.keys() - {obj.name_full for obj in scene.objects}
        self._hidden = set(tags.objects) - self.instanced
        self._look_into(view_layer.layer_collection)

    def _look_into(self, layer_collection):
        if layer_collection.exclude or layer_collection.collection.hide_render:
            return
        self._hidden -= {obj.name_full for obj in layer_collection.collection.objects}
        for child in layer_collection.children:
            self._look_into(child)

    def hidden(self, obj):
        """Whether an object, or every collection that holds it, is hidden in renders."""
        return obj.name_full in self._hidden or hidden(obj)

    def is_here(self, obj):
        """Whether an object is in the scene and view layer, or instanced in it."""
        return obj.name_full in self.placed or obj.name_full in self.instanced


def _sets(scene, tags, shown):
    names = Counter(entry.name for entry in scene.ajar.light_sets)
    for name, count in names.items():
        if count > 1:
            yield warning(
                name, "is the name of several light sets; only the first counts", "Rename the others"
            )
    lit = set()
    for obj in tags.objects.values():
        name, own = tags.light_set(obj)
        if not name:
            continue
        if name not in names:
            text = f"is in light set {name}, which does not exist"
            yield warning(obj.name, text, "Assign it to a set of the scene's list")
        elif shown.hidden(obj):
            continue
        elif shines(obj) or _instances(obj):
            lit.add(name)
        elif own:
            text = f"is in light set {name} but gives no light"
            yield warning(obj.name, text, "Give it an emissive material or a role, or clear its light set")
    for name in names:
        if name not in lit:
            text = "is a light set without lights or glowing meshes"
            yield warning(name, text, "Assign lights to it, or remove it")


def _instances(obj):
    return obj.instance_type == "COLLECTION" and obj.instance_collection is not None


def _count_parts(tags, shown):
    """{(owner, open pose): how many objects with geometry are that part of it}."""
    found = Counter()
    for obj in tags.objects.values():
        part = tags.part(obj)
        solid = obj.type in GEOMETRY and obj.ajar.surface != "IGNORE"
        if part is not None and (solid or _instances(obj)) and (part.open_pose or not shown.hidden(obj)):
            found[part.owner, part.open_pose] += 1
    return found


def _owner(owner, parts):
    kind, ignored = kind_of(owner), getattr(owner.ajar, "surface", "") == "IGNORE"
    if ignored:
        text = f"is a {kind}, but its surface is set to Ignore"
        yield warning(owner.name, text, "Set the surface to Occluder, or Movable to Fixed")
    elif not parts[owner, False]:
        text = f"is a {kind} without geometry that renders"
        yield warning(
            owner.name, text, "Show it in renders, parent its meshes to it, or set Movable to Fixed"
        )
    if owner.ajar.open_pose == owner:
        yield warning(owner.name, "is its own open pose", "Choose the object of the open leaf")


def _pose(context, shown, owner, pose):
    if pose == owner:
        return
    if not shown.is_here(pose):
        elsewhere = [other.name for other in pose.users_scene if other != context.scene]
        place = (
            f"stands in scene {elsewhere[0]}" if elsewhere else "is deleted or excluded from the view layer"
        )
        yield warning(owner.name, f"has the open pose {pose.name}, which {place}", "Bring it into this scene")
    elif not shown.hidden(pose):
        text = f"is the open pose of {owner.name} and renders too, so that renders show the door twice"
        yield warning(pose.name, text, "Hide it in renders: the bake takes it for the open door all the same")
    if pose.ajar.surface == "IGNORE":
        text = f"is the open pose of {owner.name}, but its surface is set to Ignore"
        yield warning(pose.name, text, "Set its surface to Occluder or Auto")
    if pose.ajar.movable != "FIXED":
        text = f"is the open pose of {owner.name} and marked movable itself, which is not used"
        yield warning(pose.name, text, "Set its Movable to Fixed")
