# SPDX-License-Identifier: GPL-3.0-or-later
"""Feeds a snapshot directory to the library, item by item (standard library only)."""

import ctypes as c

from . import abi
from .library import BakeError, check
from .snapshot_io import SnapshotError


# What wrong types, missing keys and numbers out of range raise on the way to the library.
MALFORMED = (
    SnapshotError,
    KeyError,
    IndexError,
    TypeError,
    AttributeError,
    ValueError,
    OverflowError,
    c.ArgumentError,
)


class SceneBuilder:
    """Builds one ajar_scene. release() frees it; a job that runs keeps its own reference."""

    def __init__(self, library, reader):
        self.library, self.reader, self.data = library, reader, reader.data
        self.scene = abi.Handle()
        check(library, library.ajar_scene_create(_text(self.data.get("name", "")), c.byref(self.scene)))

    def build(self, cancelled=lambda: False):
        """Adds everything and commits; False if cancelled() turned true on the way.

        Raises BakeError with the culprit's name, also for a malformed snapshot.
        """
        steps = (
            ("pages", self._page),
            ("textures", self._texture),
            ("materials", self._material),
            ("meshes", self._mesh),
            ("elements", self._element),
            ("instances", self._instance),
            ("lights", self._light),
        )
        for key, add in steps:
            for item in self._items(key):
                if cancelled():
                    return False
                self._guarded(add, item)
        sky = self.data.get("sky") or {"type": "none"}
        self._guarded(self._sky, self._object("sky", sky))
        check(self.library, self.library.ajar_scene_commit(self.scene))
        return True

    def release(self):
        """Frees the scene."""
        self.library.ajar_scene_release(c.byref(self.scene))

    def _items(self, key):
        items = self.data.get(key) or []
        if not isinstance(items, list):
            raise BakeError(abi.ERROR_INPUT, f"bad snapshot: {key} is no list", key)
        return [self._object(key, item) for item in items]

    @staticmethod
    def _object(key, item):
        if not isinstance(item, dict):
            raise BakeError(abi.ERROR_INPUT, f"bad snapshot: {item!r} is no object", key)
        return item

    def _guarded(self, add, item):
        try:
            add(item)
        except MALFORMED as error:
            text = f"missing {error}" if isinstance(error, KeyError) else str(error)
            raise BakeError(abi.ERROR_INPUT, f"bad snapshot: {text}", item.get("name", "")) from error

    def _desc(self, kind, item):
        desc = abi.STRUCTS[f"ajar_{kind}_desc"]()
        getattr(self.library, f"ajar_{kind}_desc_init")(c.byref(desc))
        if hasattr(desc, "name"):
            desc.name = _text(item.get("name", ""))
        return desc

    def _add(self, kind, desc):
        identifier = c.c_uint32()
        function = getattr(self.library, f"ajar_scene_add_{kind}")
        check(self.library, function(self.scene, c.byref(desc), c.byref(identifier)))

    def _page(self, item):
        identifier = c.c_uint32()
        check(
            self.library,
            self.library.ajar_scene_add_page(self.scene, item["width"], item["height"], c.byref(identifier)),
        )

    def _texture(self, item):
        desc = self._desc("texture", item)
        desc.width, desc.height = item["width"], item["height"]
        desc.texel, desc.color = abi.TEXEL[item["texel"]], abi.COLOR[item["color"]]
        desc.extend, desc.nearest = abi.EXTEND[item["extend"]], int(item.get("nearest", False))
        count = item["width"] * item["height"] * 4
        desc.texels = c.cast(self.reader.pointer(item["texels"], item["texel"], count), c.c_void_p)
        desc.texel_bytes = count * (1 if item["texel"] == "u8" else 4)
        self._add("texture", desc)

    def _material(self, item):
        desc = self._desc("material", item)
        closures = item["closures"]
        array = (abi.Closure * max(1, len(closures)))()
        for closure, values in zip(array, closures):
            self._closure(closure, values)
        desc.closures, desc.closure_count = array, len(closures)
        desc.one_sided = int(item.get("one_sided", False))
        self._add("material", desc)

    def _closure(self, closure, values):
        self.library.ajar_closure_init(c.byref(closure))
        closure.type = abi.CLOSURE[values["type"]]
        for key in ("weight_a", "weight_b", "color", "strength", "metallic", "roughness"):
            if key in values:
                self._input(getattr(closure, key), values[key])
        closure.specular = values.get("specular", closure.specular)

    def _input(self, target, values):
        self.library.ajar_input_init(c.byref(target))
        if "value" in values:
            target.value[:] = values["value"]
        for key in ("texture", "color_layer"):
            if values.get(key) is not None:
                setattr(target, key, values[key])
        target.uv_layer = values.get("uv_layer") or 0
        target.channel = abi.CHANNEL[values.get("channel", "rgb")]
        target.invert = int(values.get("invert", False))
        if "uv_transform" in values:
            target.uv_transform[:] = values["uv_transform"]

    def _mesh(self, item):
        desc = self._desc("mesh", item)
        vertices, corners = item["vertex_count"], 3 * item["triangle_count"]
        desc.vertex_count, desc.triangle_count = vertices, item["triangle_count"]
        pointer = self.reader.pointer
        desc.positions = pointer(item["positions"], "f32", 3 * vertices)
        desc.corner_vertex = pointer(item["corner_vertex"], "u32", corners)
        desc.corner_normals = pointer(item.get("corner_normals"), "f32", 3 * corners)
        desc.triangle_slot = pointer(item.get("triangle_slot"), "u32", item["triangle_count"])
        for key, width in (("uv_layers", 2), ("color_layers", 4)):
            layers = item.get(key) or []
            array = (abi.floats * max(1, len(layers)))(
                *(pointer(layer, "f32", width * corners) for layer in layers)
            )
            setattr(desc, key, array)
            setattr(desc, key[:-1] + "_count", len(layers))
        self._add("mesh", desc)

    def _element(self, item):
        desc = self._desc("element", item)
        desc.kind = abi.ELEMENT[item["kind"]]
        desc.weight = item["weight"]
        desc.combine = int(item.get("combine", True))
        desc.bounce = int(item.get("bounce", True))
        self._add("element", desc)

    def _instance(self, item):
        desc = self._desc("instance", item)
        desc.mesh = item["mesh"]
        desc.transform[:] = item["transform"]
        materials = item["materials"]
        desc.materials = (c.c_uint32 * max(1, len(materials)))(*materials)
        desc.material_count = len(materials)
        desc.surface = abi.SURFACE[item["surface"]]
        desc.visibility = sum(abi.VISIBLE[v] for v in item.get("visibility", abi.VISIBLE))
        desc.lightmap_layer = _id(item.get("lightmap_layer"))
        desc.page = _id(item.get("page"))
        desc.uv_scale[:] = item.get("uv_scale", (1, 1))
        desc.uv_offset[:] = item.get("uv_offset", (0, 0))
        desc.element, desc.open_pose = _id(item.get("element")), int(item.get("open_pose", False))
        desc.light_set = _id(item.get("light_set"))
        desc.bake_side = abi.SIDE[item.get("bake_side", "front")]
        self._add("instance", desc)

    def _light(self, item):
        desc = self._desc("light", item)
        desc.type, desc.role = abi.LIGHT[item["type"]], abi.ROLE[item["role"]]
        desc.transform[:] = item["transform"]
        desc.color[:] = item["color"]
        for key in (
            "energy",
            "radius",
            "spot_angle",
            "spot_blend",
            "sun_angle",
            "size_x",
            "size_y",
            "spread",
        ):
            if key in item:
                setattr(desc, key, item[key])
        desc.casts_shadow = int(item.get("casts_shadow", True))
        desc.light_set = _id(item.get("light_set"))
        self._add("light", desc)

    def _sky(self, item):
        desc = self._desc("sky", item)
        desc.type = abi.SKY[item["type"]]
        desc.color[:] = item.get("color", (1, 1, 1))
        desc.texture = _id(item.get("texture"))
        check(self.library, self.library.ajar_scene_set_sky(self.scene, c.byref(desc)))


def fill_settings(library, values, kind="settings"):
    """ajar_settings (or kind 'layout_settings') with defaults, overridden by values by name."""
    settings = abi.STRUCTS[f"ajar_{kind}"]()
    getattr(library, f"ajar_{kind}_init")(c.byref(settings))
    if not isinstance(values, dict):
        raise BakeError(abi.ERROR_ARGUMENT, f"{values!r} is no object", "settings")
    kinds = dict(settings._fields_)
    for key, value in values.items():
        if key == "struct_size" or key not in kinds:
            raise BakeError(abi.ERROR_ARGUMENT, f"unknown setting {key}", "settings")
        try:
            number = _number(key, value)
            # ctypes would take the low bits of a larger number.
            if kinds[key] is c.c_uint32 and not 0 <= number < 1 << 32:
                raise ValueError(f"{number} is not in 0..{(1 << 32) - 1}")
            setattr(settings, key, number)
        except (TypeError, ValueError, OverflowError) as error:
            raise BakeError(abi.ERROR_ARGUMENT, f"{key}: {error}", "settings") from error
    return settings


def _number(key, value):
    """A setting as ctypes takes it: words of an enum and booleans become numbers."""
    if isinstance(value, str):
        if value not in abi.CHOICES.get(key, {}):
            raise ValueError(f"no such choice: {value}")
        return abi.CHOICES[key][value]
    return int(value) if isinstance(value, bool) else value


def _id(value):
    return abi.NONE if value is None else value


def _text(value):
    return str(value).encode("utf-8", "replace").replace(b"\0", b"?")
