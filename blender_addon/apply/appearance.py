# SPDX-License-Identifier: GPL-3.0-or-later
"""What else than the pages follows the weights in the preview: toggles, leaves and open poses come
and go at 0.5, glowing meshes and primary lamps of light sets dim.

Lamps and glowing meshes inside of instanced collections keep the strength of their own data.
"""
import bpy

from ..extract.objects import GEOMETRY
from ..extract.tags import Tags
from . import ghosts, lamps
from .materials import GLOW


class Looks:
    """Who belongs to which source, by name."""

    def __init__(self, scene, sources):
        self.scene_name = scene.name
        self.closed, self.open, self.glows, self.lamps = {}, {}, {}, {}
        self._shown = {}
        by_owner = {source.owner(): source for source in sources.values()}
        tags = Tags(scene)
        self._find_parts(scene, tags, by_owner)
        self._find_lights(scene, tags, by_owner)

    def _find_parts(self, scene, tags, by_owner):
        poses = tags.poses()
        for obj in tags.objects.values():
            part = tags.part(obj)
            source = by_owner.get(part.owner) if part is not None else None
            if source is None or obj.library is not None or not _can_vanish(obj):
                continue
            if not part.open_pose:
                self.closed.setdefault(source, []).append(obj.name)
            elif obj.name_full in poses:
                self.open.setdefault(source, []).append(obj.name)

    def _find_lights(self, scene, tags, by_owner):
        sets = {source.entry: source for source in by_owner.values() if source.kind == "light_set"}
        for obj in scene.objects:
            source = sets.get(tags.light_set(obj)[0])
            if source is None or obj.library is not None:
                continue
            if obj.type in GEOMETRY:
                self.glows.setdefault(source, []).append(obj.name)
            elif obj.type == "LIGHT" and obj.ajar.light_role == "PRIMARY":
                self.lamps.setdefault(source, []).append(obj.name)

    def glowing(self):
        """Names of surfaces whose emission is scaled."""
        return {name for names in self.glows.values() for name in names}

    def prepare(self):
        """Takes over what it changes; done again, it changes nothing."""
        scene = bpy.data.scenes.get(self.scene_name)
        for obj in _objects(name for names in self.open.values() for name in names):
            ghosts.bring_on_stage(scene, obj)
        for obj in _objects(name for names in self.lamps.values() for name in names):
            lamps.take(obj)

    def show(self, weights, everything=False):
        """Shows the scene at these weights, {source: (weight, colour)}."""
        for source, state in weights.items():
            if everything or self._shown.get(source) != state:
                self._shown[source] = state
                self._show(source, *state)

    def _show(self, source, weight, color):
        gone = weight >= 0.5 if source.kind == "door" else weight < 0.5
        for obj in _objects(self.closed.get(source, ())):
            ghosts.set_ghost(obj, gone)
        for obj in _objects(self.open.get(source, ())):
            ghosts.set_ghost(obj, not gone)
        for obj in _objects(self.glows.get(source, ())):
            obj[GLOW] = [weight * channel for channel in color] + [1.0]
            obj.update_tag()
        for obj in _objects(self.lamps.get(source, ())):
            lamps.set_strength(obj, weight, color)


def _can_vanish(obj):
    return obj.type in GEOMETRY or (obj.instance_type == "COLLECTION" or obj.ajar.saved_instance_type)


def _objects(names):
    """The objects of these names that there are."""
    return [obj for obj in map(bpy.data.objects.get, names) if obj is not None]
