# SPDX-License-Identifier: GPL-3.0-or-later
"""Ajar: bakes light for games. This file only registers; importing it does not need Blender."""

bl_info = {
    "name": "Ajar Lightmaps",
    "author": "The Ajar authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > Ajar; Properties > Render, Object, Light, World",
    "description": "Bake lightmaps whose lights and doors still change in the game",
    "category": "Render",
}


def _modules():
    """Modules with register() and unregister(), in order."""
    from . import job, operators, panels, properties, versioning
    from .apply import live

    return properties, job, operators, panels, versioning, live


def register():
    """Registers everything, in order."""
    for module in _modules():
        module.register()


def unregister():
    """Undoes register(), in reverse."""
    for module in reversed(_modules()):
        module.unregister()
