# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators, one file per concept."""
import bpy

from . import accuracy, bake, check, flipped, light_sets, movables, predict, preview, uvs

CLASSES = (
    *accuracy.CLASSES,
    *bake.CLASSES,
    *check.CLASSES,
    *flipped.CLASSES,
    *light_sets.CLASSES,
    *movables.CLASSES,
    *predict.CLASSES,
    *preview.CLASSES,
    *uvs.CLASSES,
)


def register():
    """Registers the operators."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    """Undoes register()."""
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
