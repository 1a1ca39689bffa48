# SPDX-License-Identifier: GPL-3.0-or-later
"""Direct light of primary lamps in light sets: the game adds it at the set's weight, so the preview
does too, on a copy of the lamp's data. What an artist changes on the copy meanwhile is kept."""
import bpy

_MARK = "ajar_preview"
_SIMPLE = {"BOOLEAN", "INT", "FLOAT", "ENUM"}


def take(obj):
    """Gives a lamp data of its own for the preview."""
    if obj.ajar.saved_light is not None or obj.library is not None:
        return
    original = obj.data
    copy = original.copy()
    copy.name = "AjarPreview." + original.name
    copy.animation_data_clear()
    copy[_MARK] = [float(original.energy), *original.color]
    obj.ajar.saved_light, obj.data = original, copy


def set_strength(obj, weight, color):
    """Scales a lamp that was taken."""
    original, copy = obj.ajar.saved_light, obj.data
    if original is None or _MARK not in copy:
        return
    keep_edits(obj)
    copy.energy = original.energy * weight
    copy.color = [base * tint for base, tint in zip(original.color, color)]
    copy[_MARK] = [float(copy.energy), *copy.color]


def keep_edits(obj):
    """What an artist changed on the copy goes to the lamp's own data."""
    original, copy = obj.ajar.saved_light, obj.data
    energy, *color = copy[_MARK]
    if original.library is not None:
        return
    for name, prop in original.bl_rna.properties.items():
        if prop.type in _SIMPLE and not prop.is_readonly and name not in ("energy", "color"):
            if _value(copy, name) != _value(original, name):
                setattr(original, name, getattr(copy, name))
    if copy.energy != energy:
        original.energy *= copy.energy / energy if energy > 0.0 else 1.0
    if list(copy.color) != list(color):
        original.color = [o * c / m if m > 0.0 else c for o, c, m in zip(original.color, copy.color, color)]


def restore(obj):
    """Gives a lamp its own data back."""
    if obj.ajar.saved_light is None:
        return
    if obj.data is not None and _MARK in obj.data:
        keep_edits(obj)
        copy, obj.data = obj.data, obj.ajar.saved_light
        if not copy.users:
            bpy.data.lights.remove(copy)
    obj.ajar.saved_light = None


def _value(data, name):
    value = getattr(data, name)
    return tuple(value) if hasattr(value, "__len__") and not isinstance(value, str) else value
