# SPDX-License-Identifier: GPL-3.0-or-later
"""Which objects give light and which render, as far as can be told without baking."""


def shines(obj):
    """True for a lamp that is baked, and for a surface with a material that emits."""
    if obj.type == "LIGHT":
        return obj.ajar.light_role != "OFF"
    return any(emits(material) for material in materials([obj]))


def hidden(obj):
    """Whether the artist hid an object in renders; the preview hides some for a while."""
    return obj.ajar.saved_hide_render if obj.ajar.preview_hidden else obj.hide_render


def materials(objects):
    """Materials of the objects' slots, each once; the artist's own while the preview is on."""
    found = {}
    for obj in objects:
        for index, slot in enumerate(obj.material_slots):
            records = obj.ajar.preview_slots
            shown = slot.material
            if shown and shown.ajar.is_preview and index < len(records):
                shown = shown.ajar.source
            if shown:
                found[shown.name] = shown
    return found.values()


def emits(material):
    """True if some emission input of the material is linked or not black."""
    if not material.use_nodes:
        return False
    for node in material.node_tree.nodes:
        if node.bl_idname == "ShaderNodeGroup":
            return True  # not looked into: better no warning than a false one
        color = node.inputs.get("Emission Color") or node.inputs.get("Emission")
        if node.bl_idname == "ShaderNodeEmission":
            color = node.inputs["Color"]
        strength = node.inputs.get("Emission Strength") or node.inputs.get("Strength")
        if color is None or color.type != "RGBA":
            continue
        lit = color.is_linked or any(tuple(color.default_value)[:3])
        if lit and (strength is None or strength.is_linked or strength.default_value > 0.0):
            return True
    return False
