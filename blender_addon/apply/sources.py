# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the weights of a package's elements are set in the open file."""
import re
from dataclasses import dataclass

import bpy

from ..extract.compat import ajar
from ..extract.elements import movable_names
from ..extract.tags import Tags, kind_of

_OCCURRENCE = re.compile(r"\.\d+(_\d+)*$")
_WEIGHTS = {"door": "openness", "toggle": "presence"}
_WHITE = (1.0, 1.0, 1.0)


@dataclass(frozen=True)
class Source:
    """Names a data block that holds a weight; names outlive undo, references do not."""

    kind: str  # 'light_set', 'door' or 'toggle'
    holder: str  # 'scenes', 'objects' or 'collections'
    name: str
    library: str | None = None
    entry: str = ""  # name of the light set in the scene's list

    def owner(self):
        """What holds the weight now, or None if it is gone or renamed."""
        found = getattr(bpy.data, self.holder).get((self.name, self.library))
        if found is None or self.kind != "light_set":
            return found
        return found.ajar.light_sets.get(self.entry)

    def read(self, depsgraph=None):
        """(weight, colour), or None without an owner. Only the graph of a render has animated values
        that the data blocks of the file lack."""
        if depsgraph is not None and depsgraph.mode == "RENDER" and self.holder != "collections":
            found = getattr(bpy.data, self.holder).get((self.name, self.library))
            owner = found and self._of(found.evaluated_get(depsgraph))
        else:
            owner = self.owner()
        if owner is None:
            return None
        if self.kind == "light_set":
            return float(owner.weight), tuple(owner.color)
        return float(getattr(owner.ajar, _WEIGHTS[self.kind])), _WHITE

    def _of(self, block):
        return block.ajar.light_sets.get(self.entry) if self.kind == "light_set" else block


def find_sources(scene, elements, warnings):
    """{element index: Source} of a package's elements. Owners remember their element's name, so that
    they are found again when they are renamed. Elements without an owner are named in warnings."""
    owners = _owners_by_name(scene)
    found, lost = {}, []
    for element in elements:
        owner = owners.get((element.kind, element.name)) or _instanced(owners, element)
        if owner is None:
            lost.append(element)
            continue
        found[element.index] = _source(scene, element.kind, owner)
        if getattr(owner, "library", None) is None:
            _memory(owner).baked_name = element.name
    for element in lost:
        owner = _renamed(scene, element)
        if owner is not None:
            found[element.index] = _source(scene, element.kind, owner)
        else:
            text = f"is a {element.kind.replace('_', ' ')} of the bake and not in the scene now: it stays as baked"
            warnings.append((element.name, text))
    return found


def _owners_by_name(scene):
    owners = {}
    for entry in ajar(scene, "light_sets"):
        owners.setdefault(("light_set", entry.name), entry)
    for owner, name in movable_names(scene, Tags(scene)).items():
        owners.setdefault((kind_of(owner), name), owner)
    return owners


def _instanced(owners, element):
    """Owner inside of an instanced collection: the element is named instancer/owner.occurrence."""
    for cut in (m.end() for m in re.finditer("/", element.name)):
        rest = element.name[cut:]
        for name in (rest, _OCCURRENCE.sub("", rest)):
            if element.name[: cut - 1] in bpy.data.objects and (element.kind, name) in owners:
                return owners[element.kind, name]
    return None


def _renamed(scene, element):
    if element.kind == "light_set":
        candidates = list(ajar(scene, "light_sets"))
    else:
        candidates = [owner for owner in Tags(scene).owners() if kind_of(owner) == element.kind]
    return next((owner for owner in candidates if _memory(owner).baked_name == element.name), None)


def _memory(owner):
    """What holds baked_name: the entry of a light set itself, or the tags of a data block."""
    return owner.ajar if hasattr(owner, "ajar") else owner


def _source(scene, kind, owner):
    if kind == "light_set":
        return Source(kind, "scenes", scene.name, None, owner.name)
    holder = "collections" if owner.bl_rna.identifier == "Collection" else "objects"
    return Source(kind, holder, owner.name, owner.library.filepath if owner.library else None)
