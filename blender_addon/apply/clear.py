# SPDX-License-Identifier: GPL-3.0-or-later
"""Removes every trace of bakes from the open file; files on disk and artists' settings stay."""
import bpy

from . import preview, uvs

_OF_SCENE = ("last_bake", "data_version", "preview", "preview_world", "preview_meshes")
_OF_OBJECT = (
    "preview_slots",
    "preview_hidden",
    "saved_hide_viewport",
    "saved_hide_render",
    "saved_eyes",
    "saved_rays",
    "saved_instance_type",
    "saved_light",
    "baked_name",
)


def clear(scene):
    """Preview, images, lightmap UV layers and records go. Returns how many things were removed."""
    preview.hide()
    count = 0
    for mesh in bpy.data.meshes:
        if uvs.UV_LAYER in mesh.uv_layers and not mesh.library:
            uvs.remove_uv_layer(mesh)
            count += 1
    for image in [image for image in bpy.data.images if image.ajar.is_page]:
        bpy.data.images.remove(image)
        count += 1
    uvs.forget_placements(bpy.data.objects)
    for name in _OF_SCENE:
        scene.ajar.property_unset(name)
    for owner in (*scene.ajar.light_sets, *(c.ajar for c in bpy.data.collections if c.library is None)):
        owner.property_unset("baked_name")
    for obj in bpy.data.objects:
        if obj.library is None:
            for name in _OF_OBJECT:
                obj.ajar.property_unset(name)
    return count
