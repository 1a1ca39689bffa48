# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluates colour and scalar sockets of a shader tree to fields."""

from . import node_color, node_math
from .compat import rec709
from .images import MissingImage
from .tree import find_input, resolve
from .values import IDENTITY, ZERO, Field, Inexact, Sampler, apply, as_scalar, constant, scale

MISSING_IMAGE = 0.5  # reflectance of a surface whose image is missing: neutral, with a warning
_EXTEND = {"REPEAT": "repeat", "EXTEND": "edge", "CLIP": "clip"}


class Evaluator:
    """Evaluates sockets of one tree (a material's, a light's or a world's).

    store holds textures; warn(text) notes an approximation; fallback(scope, socket, scalar,
    reason) makes a field of what is Inexact, or is None: Inexact goes to the caller.
    """

    def __init__(self, store, warn, fallback=None):
        self.store, self.warn, self.fallback = store, warn, fallback

    def color(self, scope, node, *names, default=(0.0, 0.0, 0.0)):
        """Field of a colour input by name; default if there is no such socket."""
        return self._input(scope, node, names, False, default)

    def scalar(self, scope, node, *names, default=0.0):
        """Field of a float input by name (the engine reads its red)."""
        return self._input(scope, node, names, True, default)

    def number(self, scope, node, *names, default=0.0):
        """A float input that must be constant; raises Inexact if it is not."""
        field = self.scalar(scope, node, *names, default=default)
        if not field.is_constant:
            raise Inexact(f"a varying {names[0]}")
        return field.constant[0]

    def _input(self, scope, node, names, scalar, default):
        socket = find_input(node, *names)
        if socket is None:
            return constant(default)
        try:
            return self.socket(scope, socket, scalar)
        except Inexact as reason:
            if self.fallback is None:
                raise
            return self.fallback(scope, socket, scalar, str(reason))

    def socket(self, scope, socket, scalar=None):
        """Field of an input socket; raises Inexact."""
        source = resolve(scope, socket)
        if source.node is None:
            field, types = default_of(source.socket), source.types
        else:
            field = self.output(source.scope, source.node, source.socket)
            types = source.types + (source.socket.type,)
        for target, origin in zip(types[-2::-1], types[:0:-1]):
            field = self._convert(field, origin, target)
        return as_scalar(self.store, field) if scalar and types[0] == "RGBA" else field

    def _convert(self, field, origin, target):
        if origin == "RGBA" and target in {"VALUE", "INT", "BOOLEAN"}:
            return as_scalar(self.store, field)
        if origin == "VECTOR" and target in {"VALUE", "INT", "BOOLEAN"}:
            return apply(self.store, "average", lambda x: x.mean(axis=1, keepdims=True), field)
        if (
            origin in {"VALUE", "INT", "BOOLEAN"}
            and target in {"RGBA", "VECTOR"}
            and field.channel == "rgb"
            and not field.is_constant
        ):
            return apply(self.store, "channel", lambda x: x[:, :1], field)
        return field

    def output(self, scope, node, socket):
        """Field of a node's output socket; raises Inexact."""
        if node.bl_idname == "ShaderNodeTexImage":
            return self._image(scope, node, socket)
        for table in (node_color.NODES, node_math.NODES):
            function = table.get(node.bl_idname)
            if function is not None:
                return function(self, scope, node, socket)
        raise Inexact(f"node {node.bl_label or node.bl_idname}")

    def _image(self, scope, node, socket):
        if node.projection != "FLAT":
            raise Inexact(f"{node.projection.lower()} projection of an image")
        if node.extension not in _EXTEND:
            raise Inexact(f"image extension {node.extension.lower()}")
        uv, matrix = self.mapping(scope, find_input(node, "Vector"))
        alpha = next((s for s in node.outputs if s.name == "Alpha"), None)
        try:
            key = self.store.image(node.image, alpha is not None and alpha.is_linked)
        except MissingImage as reason:
            name = node.image.name if node.image else node.name
            self.warn(f"image '{name}': {reason}; mid grey is used")
            return constant(1.0 if socket.name == "Alpha" else MISSING_IMAGE)
        sampler = Sampler(uv, matrix, _EXTEND[node.extension], node.interpolation == "Closest")
        return Field(texture=key, sampler=sampler, channel="a" if socket.name == "Alpha" else "rgb")

    def mapping(self, scope, socket):
        """(UV layer name or None for the active one, 2x3 transform) of a Vector input.

        Raises Inexact for coordinates that are no affine function of one UV layer.
        """
        source = resolve(scope, socket)
        if source.node is None:
            if source.socket is not socket and not source.socket.hide_value:
                x, y = default_of(source.socket).constant[:2]
                return None, (0.0, 0.0, x, 0.0, 0.0, y)
            return None, IDENTITY
        node = source.node
        if node.bl_idname == "ShaderNodeUVMap" and not node.from_instancer:
            return node.uv_map or None, IDENTITY
        if node.bl_idname == "ShaderNodeTexCoord" and source.socket.name == "UV" and not node.from_instancer:
            return None, IDENTITY
        if (
            node.bl_idname == "ShaderNodeAttribute"
            and node.attribute_type == "GEOMETRY"
            and source.socket.name in {"Vector", "Color"}
        ):
            return node.attribute_name, IDENTITY
        if node.bl_idname in {"ShaderNodeMapping", "ShaderNodeVectorMath"}:
            uv, inner = self.mapping(source.scope, node.inputs[0])
            return uv, compose(node_math.affine(self, source.scope, node), inner)
        raise Inexact(f"texture coordinates of {node.bl_label or node.bl_idname}")

    def tinted(self, field, rgb):
        """field * rgb."""
        return scale(self.store, field, rgb)


def default_of(socket):
    """Field of a socket's default_value; black if it has none."""
    value = getattr(socket, "default_value", None)
    if value is None:
        return ZERO
    if socket.type == "RGBA":
        return constant(rec709(value))
    return constant(tuple(value)[:3] if hasattr(value, "__len__") else float(value))


def compose(outer, inner):
    """2x3 affine outer after inner."""
    a, b, c, d, e, f = outer
    g, h, i, j, k, l = inner
    return (a * g + b * j, a * h + b * k, a * i + b * l + c, d * g + e * j, d * h + e * k, d * i + e * l + f)
