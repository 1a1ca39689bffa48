# SPDX-License-Identifier: GPL-3.0-or-later
"""Elements of a snapshot: the light sets, doors and toggles that something in it belongs to."""

from dataclasses import dataclass, field

from .compat import ajar
from .tags import Tags, kind_of

_ORDER = ("light_set", "door", "toggle")
_WEIGHTS = {"door": "openness", "toggle": "presence"}


@dataclass(eq=False)
class Element:
    """One element. parts holds what was found of it: 'light', 'glow', 'closed' and 'open'."""

    name: str
    kind: str
    owner: object  # what holds its weight: object, collection or entry of the light set list
    weight: float
    combine: bool = True
    bounce: bool = True
    parts: set = field(default_factory=set)
    index: int | None = None

    def record(self):
        """The snapshot's dict."""
        record = {"name": self.name, "kind": self.kind, "weight": self.weight, "combine": self.combine}
        return {**record, "bounce": self.bounce} if self.kind == "door" else record


class ElementTable:
    """Finds the element of each instance and light; finish() numbers those that are used."""

    def __init__(self, scene, warnings):
        self.tags, self.warnings = Tags(scene), warnings
        self._sets = {}
        for entry in ajar(scene, "light_sets") or ():
            self._sets.setdefault(entry.name, light_set_element(entry))
        self._movables = {}
        self._names = movable_names(scene, self.tags)
        self._links = []

    def link_movable(self, record, obj, instancer=None, occurrence=""):
        """Notes the door or toggle that a snapshot instance of an original object is a part of."""
        part, place = self.tags.part(obj), f"{instancer.name_full}/" if instancer is not None else ""
        if part is None and instancer is not None:
            part, place, occurrence = self.tags.part(instancer), "", ""
        if part is None:
            return
        element = self._movable(part.owner, place, occurrence)
        element.parts.add("open" if part.open_pose else "closed")
        self._links.append((record, "element", element))
        if part.open_pose:
            record["open_pose"] = True

    def link_glow(self, record, obj, instancer, glows):
        """Notes the light set of an instance whose materials emit (glows)."""
        name, own = self._set_name(obj, instancer)
        if name and glows:
            self._link_set(record, name, obj, "glow")
        elif name and own:
            self.warnings.add(obj.name, f"is in light set '{name}' but nothing of it glows")

    def link_light(self, record, obj, instancer=None):
        """Notes the light set of a lamp."""
        name, _own = self._set_name(obj, instancer)
        part = self.tags.part(obj) or (instancer is not None and self.tags.part(instancer)) or None
        if name:
            self._link_set(record, name, obj, "light")
        elif part is not None:
            kind = kind_of(part.owner)
            self.warnings.add(
                obj.name, f"shines whatever {kind} '{part.owner.name}' does: put it into a light set"
            )

    def finish(self):
        """Numbers the used elements, completes the records linked to them, and returns theirs."""
        used = [e for e in self._sets.values() if e.parts]
        used += sorted(self._movables.values(), key=lambda e: (_ORDER.index(e.kind), e.name))
        for index, element in enumerate(used):
            element.index = index
        for record, key, element in self._links:
            record[key] = element.index
        self._warn_of_sets()
        self._warn_of_movables()
        return [element.record() for element in used]

    def _set_name(self, obj, instancer):
        """An instancer's own tag is about this one place, so it goes before the object's."""
        if instancer is not None and ajar(instancer, "light_set"):
            return ajar(instancer, "light_set"), False
        name, own = self.tags.light_set(obj)
        if not name and instancer is not None:
            name, _own = self.tags.light_set(instancer)
        return name, own

    def _link_set(self, record, name, obj, how):
        element = self._sets.get(name)
        if element is None:
            text = f"is in light set '{name}', which the scene does not have: baked as always on"
            self.warnings.add(obj.name, text)
            return
        element.parts.add(how)
        self._links.append((record, "light_set", element))

    def _movable(self, owner, place, occurrence):
        key = (type(owner).__name__, owner.name_full, place, occurrence)
        if key not in self._movables:
            name = place + self._names.get(owner, owner.name_full) + occurrence
            self._movables[key] = movable_element(owner, name)
        return self._movables[key]

    def _warn_of_sets(self):
        for element in self._sets.values():
            if not element.parts:
                text = "is a light set without lights or glowing meshes: left out"
                self.warnings.add(element.name, text)

    def _warn_of_movables(self):
        found = {}
        for element in self._movables.values():
            found.setdefault(element.owner, set()).update(element.parts)
        for owner in self.tags.owners():
            self._warn_of_owner(owner, found.get(owner, set()))
        for obj in self.tags.objects.values():
            self._warn_of_nesting(obj)
        for owner, pose, first in self.tags.shared_poses:
            self.warnings.add(
                owner.name, f"shares its open pose '{pose.name}' with '{first.name}', which has it"
            )

    def _warn_of_owner(self, owner, parts):
        kind, pose = kind_of(owner), ajar(owner, "open_pose")
        if not parts:
            self.warnings.add(owner.name, f"is a {kind} without geometry that renders: left out")
        elif kind == "door" and "closed" not in parts:
            self.warnings.add(
                owner.name, "is a door whose closed leaf does not render: only its open pose is baked"
            )
        elif kind == "door" and pose is not None and "open" not in parts:
            text = f"its open pose '{pose.name}' has no geometry in this scene and view layer: left out"
            self.warnings.add(owner.name, text)

    def _warn_of_nesting(self, obj):
        parts = list(self.tags.parts(obj))
        if len(parts) < 2 or parts[0].owner != obj or parts[1].owner == obj:
            return
        outer = parts[1].owner
        text = (
            f"is a {kind_of(obj)} of its own inside {kind_of(outer)} '{outer.name}', which does not move it"
        )
        self.warnings.add(obj.name, text)


def movable_names(scene, tags):
    """{tagged object or collection: name of its element}. Games look elements up by name, so it says
    more where a light set, or an object and a collection, have the same."""
    taken, names = {entry.name for entry in ajar(scene, "light_sets") or ()}, {}
    for owner in tags.owners():
        name = owner.name_full
        if name in taken:
            held = owner.bl_rna.identifier == "Collection"
            name += " (collection)" if held else f" ({kind_of(owner)})"
        names[owner] = name
        taken.add(name)
    return names


def light_set_element(entry):
    """Element of an entry of the scene's light set list."""
    return Element(entry.name, "light_set", entry, float(entry.weight), bool(entry.combine))


def movable_element(owner, name):
    """Element of a tagged object or collection."""
    kind = kind_of(owner)
    weight = float(ajar(owner, _WEIGHTS[kind]))
    return Element(
        name, kind, owner, weight, bool(ajar(owner, "combine")), bool(ajar(owner, "bounce_when_closed"))
    )
