# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels: they draw properties, progress and the last report, and hold no logic."""
import bpy

from . import accuracy, bake, elements, tags

CLASSES = (*bake.CLASSES, *elements.CLASSES, *accuracy.CLASSES, *tags.CLASSES)


def register():
    """Registers the panels."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    """Undoes register()."""
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
