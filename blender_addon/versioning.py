# SPDX-License-Identifier: GPL-3.0-or-later
"""Brings settings saved by older versions of the add-on up to date when a file is loaded."""
import bpy
from bpy.app.handlers import persistent

DATA_VERSION = 1
_STEPS = ()  # (version, function(scene)): applied to scenes saved before that version


def migrate(scene):
    """Applies the steps that a scene saved by an older version lacks. Files of newer versions are
    left alone."""
    saved = scene.ajar.data_version
    for entry in scene.ajar.light_sets if scene.library is None else ():
        entry.known_name = entry.known_name or entry.name
    for version, step in _STEPS:
        if 0 < saved < version:
            step(scene)
    if scene.library is None and saved < DATA_VERSION and scene.ajar.is_property_set("last_bake"):
        scene.ajar.data_version = DATA_VERSION


@persistent
def _after_load(*_):
    for scene in bpy.data.scenes:
        migrate(scene)


def register():
    """Adds the load handler."""
    bpy.app.handlers.load_post.append(_after_load)


def unregister():
    """Removes the load handler."""
    bpy.app.handlers.load_post.remove(_after_load)
