# SPDX-License-Identifier: GPL-3.0-or-later
"""Which part each object plays: lightmap, occluder or none, with the reason by name."""

from .. import model
from .compat import ajar
from .mesh import evaluated_mesh, lightmap_uv, overlap_share, read_mesh

GEOMETRY = {"MESH", "CURVE", "SURFACE", "META", "FONT", "CURVES"}
# Modifiers that make faces out of faces or anew, whose lightmap UVs then overlap. Others, such as
# Subdivision or Decimate, keep one face per place on the surface: UVs follow without overlap.
COPYING = {
    "ARRAY",
    "BOOLEAN",
    "EXPLODE",
    "MIRROR",
    "NODES",
    "OCEAN",
    "PARTICLE_INSTANCE",
    "REMESH",
    "SCREW",
    "SKIN",
    "SOLIDIFY",
    "VOLUME_TO_MESH",
    "WIREFRAME",
}
# Geometry nodes that make no new faces, as in "Smooth by Angle".
KEEPING = {"NodeGroupInput", "NodeReroute", "GeometryNodeViewer", "GeometryNodeSwitch"} | {
    "GeometryNode" + name
    for name in (
        "SetShadeSmooth",
        "SetMaterial",
        "SetMaterialIndex",
        "SetPosition",
        "SetID",
        "StoreNamedAttribute",
        "RemoveAttribute",
        "CaptureAttribute",
        "DeleteGeometry",
        "SeparateGeometry",
        "Triangulate",
        "SubdivisionSurface",
        "SubdivideMesh",
        "MergeByDistance",
        "Transform",
    )
}
MAX_OVERLAP = 0.01
MAX_UV_LAYERS = 8


def wants_lightmap(obj):
    """Whether the artist lets this object have a lightmap (not whether it can)."""
    return ajar(obj, "surface") in {"AUTO", "LIGHTMAP"}


def obstacle(obj):
    """Why an object can never carry lightmap UVs, or '' if it can (copying modifiers aside)."""
    if obj.type != "MESH":
        return f"{obj.type.lower()} objects cannot carry lightmap UVs"
    data = obj.data
    if len(data.polygons) == 0:
        return "the mesh has no faces of its own"
    if data.library is not None and model.LIGHTMAP_UV not in data.uv_layers:
        return "the mesh is linked from another file and cannot get lightmap UVs"
    if len(data.uv_layers) >= MAX_UV_LAYERS and model.LIGHTMAP_UV not in data.uv_layers:
        return f"the mesh has {MAX_UV_LAYERS} UV maps already"
    return ""


def copying_modifiers(obj):
    """Names of the rendered modifiers that copy faces."""
    return [
        m.name
        for m in obj.modifiers
        if m.show_render and m.type in COPYING and not (m.type == "NODES" and _keeps_faces(m.node_group))
    ]


def _keeps_faces(tree):
    """Whether a geometry node tree (None: no effect) leaves every face where it is or drops it."""
    return tree is None or all(_keeps(node) for node in tree.nodes)


def _keeps(node):
    if node.bl_idname in KEEPING or not any(s.type == "GEOMETRY" for s in node.outputs):
        return True
    return node.type == "GROUP" and _keeps_faces(node.node_tree)


def copies_overlap(obj, uv):
    """Whether copying modifiers made lightmap UVs (T, 3, 2) (or None) useless."""
    return bool(copying_modifiers(obj)) and (uv is None or overlap_share(uv) > MAX_OVERLAP)


def copy_warning(obj):
    """Text of the warning about copying modifiers."""
    names = ", ".join(f"'{n}'" for n in copying_modifiers(obj))
    return f"modifier {names} copies faces, which then share lightmap UVs: baked as an occluder"


def can_keep_uvs(obj, depsgraph):
    """Whether the evaluated lightmap UVs of an object with copying modifiers do not overlap."""
    if model.LIGHTMAP_UV not in obj.data.uv_layers:
        return False
    with evaluated_mesh(obj.evaluated_get(depsgraph)) as mesh:
        data = read_mesh(mesh, obj.name) if mesh is not None else None
    return data is not None and not copies_overlap(obj, lightmap_uv(data))
