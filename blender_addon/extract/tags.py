# SPDX-License-Identifier: GPL-3.0-or-later
"""Which tag an object answers to: its own, its collections' or its parents', the nearest first."""

from collections import namedtuple

import bpy

from .compat import ajar

KINDS = {"DOOR": "door", "TOGGLE": "toggle"}
_WIREFRAMES = {"WIRE", "BOUNDS"}

# owner: the tagged object or collection; open_pose: belongs to its open state.
Part = namedtuple("Part", "owner open_pose")


class Tags:
    """The movable and light set tags of a scene and of the collections that it instances."""

    def __init__(self, scene):
        self.objects, self.collections = reachable(scene)
        self._collections = _collections_by_object()
        self._parents = _parents_by_collection()
        self._poses, self.shared_poses = {}, []
        for owner in self.owners():
            self._note_pose(owner)

    def owners(self):
        """Tagged objects, then tagged collections, in order of name."""
        return [o for o in (*self.objects.values(), *self.collections.values()) if kind_of(o)]

    def part(self, obj):
        """Part that an original object is of, or None."""
        return next(self.parts(obj), None)

    def parts(self, obj):
        """Every Part that an original object is of, the nearest first; only that one counts."""
        holder = obj
        while holder is not None:
            door = self._poses.get(holder.name_full)
            if door is not None:
                yield Part(door, True)
            elif kind_of(holder):
                yield Part(holder, False)
            for collection in self._around(holder):
                if kind_of(collection):
                    yield Part(collection, False)
            holder = holder.parent

    def light_set(self, obj):
        """(name of the light set that an original object is in or '', whether by a tag of its own)."""
        own = ajar(obj, "light_set")
        if own:
            return own, True
        return next((n for n in (ajar(c, "light_set") for c in self._around(obj)) if n), ""), False

    def poses(self):
        """Names of objects that are there while a door is open, whether they render or not. Parts of a
        pose that renders may be hidden on their own, and wireframe helpers stay hidden."""
        if not self._poses:
            return frozenset()
        return frozenset(name for name, obj in self.objects.items() if self._stands_open(obj))

    def _stands_open(self, obj):
        root = obj
        while root is not None and root.name_full not in self._poses:
            root = root.parent
        part = self.part(obj) if root is not None else None
        if part is None or not part.open_pose:
            return False
        return obj == root or (root.hide_render and obj.display_type not in _WIREFRAMES)

    def _note_pose(self, owner):
        pose = ajar(owner, "open_pose")
        if kind_of(owner) != "door" or pose is None or pose == owner:
            return
        first = self._poses.setdefault(pose.name_full, owner)
        if first != owner:
            self.shared_poses.append((owner, pose, first))

    def _around(self, obj):
        """Collections that hold an object, inner ones first."""
        for collection in self._collections.get(obj.name_full, ()):
            yield collection
            yield from self._upwards(collection)

    def _upwards(self, collection):
        for parent in self._parents.get(collection.name_full, ()):
            yield parent
            yield from self._upwards(parent)


def kind_of(owner):
    """'door' or 'toggle' by an object's or collection's own tag, else None."""
    return KINDS.get(ajar(owner, "movable"))


def reachable(scene):
    """({name: object}, {name: collection}) of the scene and of the collections that it instances, in
    order of name."""
    objects, found, waiting = {}, [], [scene.collection]
    while waiting:
        collection = waiting.pop()
        if collection in found:
            continue
        found.append(collection)
        waiting += collection.children
        for obj in collection.objects:
            objects[obj.name_full] = obj
            if obj.instance_type == "COLLECTION" and obj.instance_collection is not None:
                waiting.append(obj.instance_collection)
    collections = {c.name_full: c for c in found[1:]}
    return dict(sorted(objects.items())), dict(sorted(collections.items()))


def _collections_by_object():
    """{object name: collections that link it, in order of name}."""
    found = {}
    for collection in sorted(bpy.data.collections, key=lambda c: c.name_full):
        for obj in collection.objects:
            found.setdefault(obj.name_full, []).append(collection)
    return found


def _parents_by_collection():
    found = {}
    for collection in sorted(bpy.data.collections, key=lambda c: c.name_full):
        for child in collection.children:
            found.setdefault(child.name_full, []).append(collection)
    return found
