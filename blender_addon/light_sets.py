# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene's list of light sets and the names on objects and collections that refer to it."""

from .extract.tags import reachable


def add(scene, name):
    """A new entry with a name of its own; becomes the active one."""
    ajar = scene.ajar
    name = unique_name(scene, name or "Set")
    entry = ajar.light_sets.add()
    entry.name = name
    ajar.light_set_index = len(ajar.light_sets) - 1
    return entry


def unique_name(scene, name, but=None):
    """name, or name.001 and so on if another entry than but has it."""
    taken = {entry.name for entry in scene.ajar.light_sets if entry != but}
    result, number = name, 1
    while result in taken:
        result = f"{name}.{number:03d}"
        number += 1
    return result


def active(scene):
    """The active entry, or None."""
    sets = scene.ajar.light_sets
    return sets[min(scene.ajar.light_set_index, len(sets) - 1)] if sets else None


def retag(scene, old, new):
    """Objects and collections tagged with a set's old name get the new one ('': none)."""
    objects, collections = reachable(scene)
    for owner in (*objects.values(), *collections.values()):
        if owner.ajar.light_set == old and owner.library is None:
            owner.ajar.light_set = new


def keep_name(entry, _context=None):
    """Update of an entry's name: keeps it unique and takes the tags along."""
    scene, old = entry.id_data, entry.known_name
    wanted = unique_name(scene, entry.name or "Set", entry)
    if wanted != entry.name:
        entry.name = wanted  # calls this again, with a name that is free
        return
    entry.known_name = wanted
    if old and old != wanted:
        retag(scene, old, wanted)
