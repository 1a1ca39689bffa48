# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields: what a colour or scalar socket is worth over a surface, in the engine's terms (no bpy).

A field is value * texture * vertex colour, reduced to a channel, then 1 - x if invert. What
cannot be written so raises Inexact; point-wise functions of one texture are worked out texel by
texel, which is exact at texel centres (and between them too if the function is affine).
"""

from dataclasses import dataclass, replace

import numpy as np

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # Rec.709, what Blender uses for colour -> float
IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0)


class Inexact(Exception):
    """A node or combination that fields cannot express; the text names it."""


@dataclass(frozen=True)
class Sampler:
    """How a texture is read. uv None: the active render layer; transform: row-major 2x3."""

    uv: str | None = None
    transform: tuple = IDENTITY
    extend: str = "repeat"
    nearest: bool = False


@dataclass(frozen=True)
class Field:
    """value * texture * colour layer. texture is a key of the TextureStore; color a layer name."""

    value: tuple = (1.0, 1.0, 1.0)
    texture: object = None
    sampler: Sampler | None = None
    color: str | None = None
    channel: str = "rgb"
    invert: bool = False

    @property
    def is_constant(self):
        return self.texture is None and self.color is None

    @property
    def constant(self):
        """RGB of a constant field."""
        return tuple(1.0 - v for v in self.value) if self.invert else self.value

    @property
    def is_zero(self):
        return self.is_constant and not any(self.constant) or (not self.invert and not any(self.value))


def constant(value):
    """Field of a number or an RGB."""
    if np.ndim(value) == 0:
        value = (value,) * 3
    return Field(tuple(float(v) for v in value[:3]))


ZERO, ONE = constant(0.0), constant(1.0)


def apply(store, name, function, *fields):
    """function over (N, 3) arrays, one per field; name (hashable) tells it from other functions."""
    if all(f.is_constant for f in fields):
        arrays = [np.array([f.constant], dtype=np.float64) for f in fields]
        return constant(np.broadcast_to(function(*arrays), (1, 3))[0])
    samplers = {f.sampler for f in fields if f.texture is not None}
    if any(f.color is not None for f in fields):
        raise Inexact(f"{name if isinstance(name, str) else name[0]} of a vertex colour")
    if len(samplers) != 1:
        raise Inexact("a mix of textures with different mappings")
    sampler = samplers.pop()
    if sampler.extend == "clip":
        _check_clip(function, fields)
    key = ("derived", name, fields)
    store.derive(key, lambda: function(*texel_arrays(store, fields)))
    return Field(texture=key, sampler=sampler)


def _check_clip(function, fields):
    """Outside a clipped image all is zero; so must the function of zero be."""
    outside = [
        np.array([f.constant if f.is_constant else replace(f, texture=None, value=(0.0,) * 3).constant])
        for f in fields
    ]
    if np.any(np.broadcast_to(function(*outside), (1, 3)) != 0.0):
        raise Inexact("a clipped image changed outside its border")


def texel_arrays(store, fields):
    """The fields' values at each texel, (N, 3) or (1, 3) each; textures must have one size."""
    sizes = {store.size(f.texture) for f in fields if f.texture is not None}
    if len(sizes) > 1:
        raise Inexact("a mix of images of different sizes")
    return [_texels(store, f) for f in fields]


def _texels(store, field):
    if field.texture is None:
        return np.array([field.constant], dtype=np.float32)
    pixels = store.linear(field.texture)
    rgb = pixels[:, :3] if field.channel == "rgb" else pixels[:, ["rgba".index(field.channel)]]
    result = rgb * np.array(field.value, dtype=np.float32)
    return 1.0 - result if field.invert else result


def scale(store, field, rgb):
    """field * rgb (three numbers)."""
    if all(v == 1.0 for v in rgb):
        return field
    if field.invert and not field.is_constant:
        return apply(store, ("scale", tuple(rgb)), lambda x: x * np.array(rgb), field)
    value = field.constant if field.is_constant else field.value
    return replace(field, value=tuple(float(a * b) for a, b in zip(value, rgb)), invert=False)


def multiply(store, a, b):
    """a * b."""
    if a.is_constant:
        return scale(store, b, a.constant)
    if b.is_constant:
        return scale(store, a, b.constant)
    if a.texture is None and b.texture is not None:
        a, b = b, a
    # Now a has the texture if one has; a texture times a vertex colour needs no new texels.
    if a.texture is not None and a.color is None and b.texture is None and not (a.invert or b.invert):
        if a.channel != b.channel:
            a = apply(store, "channel", lambda x: x, a)
        if a.channel == b.channel:
            return replace(a, color=b.color, value=tuple(x * y for x, y in zip(a.value, b.value)))
    return apply(store, "multiply", lambda x, y: x * y, a, b)


def inverted(field):
    """1 - field."""
    if field.is_constant:
        return constant(tuple(1.0 - v for v in field.constant))
    return replace(field, invert=not field.invert)


def as_scalar(store, field):
    """The field as Blender turns a colour into a float: by luminance. The engine reads red."""
    if field.is_constant:
        return constant(float(np.dot(field.constant, LUMINANCE)))
    grey = len(set(field.value)) == 1
    if field.channel != "rgb" and grey:
        return field
    if field.texture is not None and field.color is None and grey and store.is_grey(field.texture):
        return replace(field, channel="r")
    return apply(store, "luminance", lambda x: (x @ LUMINANCE)[:, None], field)
