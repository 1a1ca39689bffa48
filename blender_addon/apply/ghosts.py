# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that the preview shows or hides for a while, and gives back exactly as they were.

Toggles and leaves become ghosts: rays pass them and their slots are clear. They stay in the
dependency graph, so that keyframes and drivers of their weights go on working, which they would not
on hidden objects.
"""
import bpy

_RAYS = (
    "visible_camera",
    "visible_diffuse",
    "visible_glossy",
    "visible_transmission",
    "visible_volume_scatter",
    "visible_shadow",
)
_HIDDEN = "AjarPreview.Hidden"
STAGE = "AjarPreview.Stage"  # collection that shows open poses whose own collections are hidden


def hold_flags(obj, hidden):
    """Takes over an object's hide flags and sets them."""
    saved = obj.ajar
    if not saved.preview_hidden:
        saved.preview_hidden = True
        saved.saved_hide_viewport, saved.saved_hide_render = obj.hide_viewport, obj.hide_render
    obj.hide_viewport = obj.hide_render = hidden


def set_ghost(obj, ghost):
    """Makes an object a ghost, or shows it again. Instancers stop or go on instancing."""
    if obj.library is not None or ghost == (obj.ajar.saved_rays >= 0):
        return
    if ghost:
        obj.ajar.saved_rays = sum(getattr(obj, ray) << bit for bit, ray in enumerate(_RAYS))
        if obj.instance_type == "COLLECTION":
            obj.ajar.saved_instance_type, obj.instance_type = obj.instance_type, "NONE"
        for ray in _RAYS:
            setattr(obj, ray, False)
    else:
        _restore_rays(obj)
    for slot, entry in zip(obj.material_slots, obj.ajar.preview_slots):
        if slot.material is not None and slot.material in (entry.preview, bpy.data.materials.get(_HIDDEN)):
            slot.material = _clear_material() if ghost else entry.preview


def bring_on_stage(scene, obj):
    """Shows an object whatever hid it: its flags, the eye, or its collections."""
    hold_flags(obj, False)
    eyes = [layer.name for layer in scene.view_layers if obj.name in layer.objects and _shut(obj, layer)]
    if eyes and not obj.ajar.saved_eyes:
        obj.ajar.saved_eyes = "\n".join(eyes)
    for name in eyes:
        obj.hide_set(False, view_layer=scene.view_layers[name])
    if obj.name not in scene.objects:
        return  # part of an instanced collection: its instancer shows it
    stage = bpy.data.collections.get(STAGE)
    if stage is None:
        stage = bpy.data.collections.new(STAGE)
        scene.collection.children.link(stage)
    if obj.name not in stage.objects:
        stage.objects.link(obj)


def restore(obj):
    """Gives an object back. Slots are the preview's to restore."""
    if obj.ajar.saved_rays >= 0:
        _restore_rays(obj)
    if obj.ajar.preview_hidden:
        obj.hide_viewport, obj.hide_render = obj.ajar.saved_hide_viewport, obj.ajar.saved_hide_render
        obj.ajar.preview_hidden = False
    if obj.ajar.saved_eyes:
        names = obj.ajar.saved_eyes.split("\n")
        for layer in (layer for scene in bpy.data.scenes for layer in scene.view_layers):
            if layer.name in names and obj.name in layer.objects:
                obj.hide_set(True, view_layer=layer)
        obj.ajar.saved_eyes = ""


def clear_stage():
    """Removes the collection of open poses; before objects are restored."""
    stage = bpy.data.collections.get(STAGE)
    if stage is not None:
        bpy.data.collections.remove(stage)


def _shut(obj, layer):
    return obj.hide_get(view_layer=layer)


def _restore_rays(obj):
    for bit, ray in enumerate(_RAYS):
        setattr(obj, ray, bool(obj.ajar.saved_rays >> bit & 1))
    obj.ajar.saved_rays = -1
    if obj.ajar.saved_instance_type:
        obj.instance_type, obj.ajar.saved_instance_type = obj.ajar.saved_instance_type, ""


def _clear_material():
    """A material that is not there, for renderers that know no ray visibility."""
    material = bpy.data.materials.get(_HIDDEN)
    if material is not None:
        return material
    material = bpy.data.materials.new(_HIDDEN)
    material.ajar.is_preview, material.ajar.key = True, "hidden"
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    clear, output = tree.nodes.new("ShaderNodeBsdfTransparent"), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(clear.outputs[0], output.inputs["Surface"])
    for name, value in (("blend_method", "BLEND"), ("shadow_method", "NONE")):
        if name in material.bl_rna.properties:
            setattr(material, name, value)
    return material
