# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes Cycles' viewport show images whose pixels changed.

Cycles keeps the pixels that it has read until no texture uses them, and tells textures apart by image and by
what lies beyond its edge. Charts stay clear of that, so switching it changes nothing but that Cycles reads again.
EEVEE and renders read again by themselves.
"""
import bpy

_OTHER_EDGE = {"EXTEND": "REPEAT", "REPEAT": "EXTEND"}


class Reloader:
    """Switches each image's edge once until the viewports have looked: twice would go unnoticed."""

    def __init__(self):
        self._asked = set()

    def ask(self, image):
        """The image has new pixels."""
        if image.name in self._asked or not _watched():
            return
        self._asked.add(image.name)
        for material in bpy.data.materials:
            if material.ajar.is_preview:
                _switch_edge(material.node_tree, image)

    def seen(self):
        """The viewports have been brought up to the scene."""
        self._asked.clear()


def _switch_edge(tree, image):
    for node in tree.nodes:
        if node.bl_idname == "ShaderNodeTexImage" and node.image == image:
            node.extension = _OTHER_EDGE.get(node.extension, "EXTEND")


def _watched():
    """Whether a viewport shows the scene with Cycles."""
    return any(
        space.type == "VIEW_3D" and space.shading.type == "RENDERED"
        for window in bpy.context.window_manager.windows
        if window.scene.render.engine == "CYCLES"
        for area in window.screen.areas
        for space in area.spaces
    )
