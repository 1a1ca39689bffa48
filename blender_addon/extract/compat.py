# SPDX-License-Identifier: GPL-3.0-or-later
"""What differs between Blender versions or when the add-on's properties are absent."""

import bpy

from .. import fields

_DEFAULTS = {
    f.name: f.default
    for f in fields.SCENE_FIELDS + fields.OBJECT_FIELDS + fields.COLLECTION_FIELDS + fields.WORLD_FIELDS
}

# Columns map a working space of Blender 5 to Rec.709.
_TO_REC709 = {
    "Linear Rec.2020": (
        (1.660491, -0.587641, -0.072850),
        (-0.124550, 1.132900, -0.008349),
        (-0.018151, -0.100579, 1.118730),
    ),
    "ACEScg": (
        (1.705051, -0.621792, -0.083259),
        (-0.130257, 1.140805, -0.010548),
        (-0.024003, -0.128969, 1.152972),
    ),
}


def has(owner, name):
    """Whether the RNA type of owner has a property or function (hasattr on a class lies)."""
    rna = owner.bl_rna
    return name in rna.properties or name in rna.functions


def ajar(owner, name):
    """owner.ajar.<name> of a scene, object, collection or world, or its default while unregistered."""
    group = getattr(owner.original if hasattr(owner, "original") else owner, "ajar", None)
    return getattr(group, name, _DEFAULTS.get(name)) if group is not None else _DEFAULTS.get(name)


def working_space_matrix():
    """3x3 rows from the file's scene-linear space to Rec.709, or None if it is Rec.709."""
    space = getattr(getattr(bpy.data, "colorspace", None), "working_space", "")
    return _TO_REC709.get(space)


def rec709(color):
    """A scene-linear RGB of the file as Rec.709."""
    rows = working_space_matrix()
    rgb = tuple(float(v) for v in color[:3])
    return rgb if rows is None else tuple(sum(m * v for m, v in zip(row, rgb)) for row in rows)


def transform(matrix):
    """A 4x4 matrix as the 12 numbers of a row-major 3x4."""
    return [float(v) for row in matrix[:3] for v in row]
