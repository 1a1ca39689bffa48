# SPDX-License-Identifier: GPL-3.0-or-later
"""Image pixels as the engine wants them, and the table of textures of a snapshot."""

from dataclasses import dataclass

import numpy as np

from .compat import working_space_matrix
from .values import Inexact

MAX_SIZE = 1024  # edge, texels: bounced light does not show more
_LINEAR = {"Linear", "Linear Rec.709", "Non-Color", "Raw", "Generic Data", "scene_linear", ""}
_DATA = {"Non-Color", "Raw", "Generic Data"}


class MissingImage(Exception):
    """The image has no pixels: its file is missing or it was never made."""


@dataclass
class Texels:
    """(height, width, 4) array, bottom row first: u8 (linear or sRGB coded) or f32 linear."""

    name: str
    data: np.ndarray
    srgb: bool = False


def srgb_to_linear(x):
    """sRGB decoding of an array in [0, 1]."""
    return np.where(x <= 0.04045, x / 12.92, ((np.maximum(x, 0.0) + 0.055) / 1.055) ** 2.4)


def linear_to_srgb(x):
    """sRGB encoding of an array in [0, 1]."""
    return np.where(x <= 0.0031308, x * 12.92, 1.055 * np.maximum(x, 0.0) ** (1 / 2.4) - 0.055)


_DECODE = srgb_to_linear(np.arange(256) / 255.0).astype(np.float32)


def to_linear(texels):
    """(height, width, 4) float32, scene-linear, straight alpha."""
    if texels.data.dtype != np.uint8:
        return texels.data
    result = texels.data.astype(np.float32) / np.float32(255.0)
    if texels.srgb:
        result[..., :3] = _DECODE[texels.data[..., :3]]
    return result


def load_image(image, alpha_used, max_size=MAX_SIZE):
    """Texels of a Blender image as Cycles shows it.

    alpha_used: the node's alpha output is linked; if not, Cycles keeps colours associated
    (multiplied by alpha). Raises MissingImage, or Inexact for kinds that only Blender can read.
    """
    if image is None:
        raise MissingImage("no image is chosen")
    if image.source not in {"FILE", "GENERATED"}:
        raise Inexact(f"image source {image.source.lower()}")
    loaded_here = not image.has_data
    pixels = _read_pixels(image)
    if loaded_here and image.source == "FILE" and not image.is_dirty:
        image.buffers_free()
    space = image.colorspace_settings.name
    pixels = _alpha(pixels, image, alpha_used, space in _DATA)
    if image.is_float:
        return downscale(Texels(image.name, _rec709(pixels, space)), max_size)
    if space not in _LINEAR and space != "sRGB":
        raise Inexact(f"image colour space {space}")
    data = np.clip(np.rint(pixels * 255.0), 0, 255).astype(np.uint8)
    return downscale(Texels(image.name, data, srgb=space == "sRGB"), max_size)


def _read_pixels(image):
    width, height = image.size
    channels = image.channels
    if width == 0 or height == 0 or channels == 0:
        raise MissingImage("its file is missing or cannot be read")
    flat = np.empty(width * height * channels, dtype=np.float32)
    image.pixels.foreach_get(flat)
    flat = flat.reshape(height, width, channels)
    if channels == 4:
        return flat
    result = np.ones((height, width, 4), dtype=np.float32)
    result[..., :3] = flat[..., :3] if channels == 3 else flat[..., :1]
    if channels == 2:
        result[..., 3] = flat[..., 1]
    return result


def _alpha(pixels, image, alpha_used, is_data):
    """Associates or separates alpha; byte buffers of Blender are straight, float ones associated."""
    if image.alpha_mode == "NONE":
        pixels[..., 3] = 1.0
        return pixels
    if image.alpha_mode == "CHANNEL_PACKED" or is_data or not np.any(pixels[..., 3] < 1.0):
        return pixels
    alpha = pixels[..., 3:]
    if not alpha_used and not image.is_float:
        pixels[..., :3] *= alpha
    elif alpha_used and image.is_float:
        pixels[..., :3] /= np.where(alpha > 0.0, alpha, 1.0)
    return pixels


def _rec709(pixels, space):
    matrix = None if space in _DATA else working_space_matrix()
    if matrix is not None:
        pixels[..., :3] = pixels[..., :3] @ np.array(matrix, dtype=np.float32).T
    return pixels


def downscale(texels, max_size):
    """Texels no larger than max_size, by a box filter in linear light, colours weighted by alpha."""
    height, width = texels.data.shape[:2]
    factor = max(width, height) / max_size
    if factor <= 1.0:
        return texels
    size = (max(1, round(height / factor)), max(1, round(width / factor)))
    linear = to_linear(texels)
    alpha = linear[..., 3:]
    cutout = bool(np.any(alpha < 1.0))
    if cutout:
        linear = np.concatenate([linear[..., :3] * alpha, alpha], axis=2)
    small = box_resize(linear, size)
    if cutout:
        small[..., :3] /= np.where(small[..., 3:] > 0.0, small[..., 3:], 1.0)
    if texels.data.dtype != np.uint8:
        return Texels(texels.name, small)
    coded = np.concatenate(
        [linear_to_srgb(small[..., :3]) if texels.srgb else small[..., :3], small[..., 3:]], axis=2
    )
    return Texels(texels.name, np.clip(np.rint(coded * 255.0), 0, 255).astype(np.uint8), texels.srgb)


def box_resize(values, size):
    """(height, width, c) averaged over boxes to size (height, width), never larger than the input."""
    for axis, count in enumerate(size):
        edges = np.arange(count + 1) * values.shape[axis] // count
        sums = np.add.reduceat(values, edges[:-1], axis=axis, dtype=np.float64)
        shape = [1, 1, 1]
        shape[axis] = count
        values = sums / np.diff(edges).reshape(shape)
    return values.astype(np.float32)


class TextureStore:
    """Texels by key, and the snapshot's texture list (one entry per key and way of reading)."""

    def __init__(self, writer=None):
        self._writer = writer
        self._texels, self._linear, self._references = {}, {}, {}
        self._ids, self.items = {}, []

    def image(self, image, alpha_used, max_size=MAX_SIZE):
        """Key of an image's texels; loads it the first time."""
        key = ("image", getattr(image, "name_full", None), bool(alpha_used))
        if key not in self._texels:
            self._texels[key] = load_image(image, alpha_used, max_size)
        return key

    def put(self, key, texels):
        """Stores texels made elsewhere under a key."""
        self._texels[key] = texels
        return key

    def derive(self, key, compute):
        """Stores compute() -> (N, 3) or (N, 1) under key, sized as the texture it came from."""
        if key in self._texels:
            return
        height, width = self.size(next(f.texture for f in key[2] if f.texture is not None))
        data = np.ones((height * width, 4), dtype=np.float32)
        data[:, :3] = compute()
        source = next(f.texture for f in key[2] if f.texture is not None)
        self._texels[key] = Texels(self._texels[source].name, data.reshape(height, width, 4))

    def size(self, key):
        """(height, width) of a texture."""
        return self._texels[key].data.shape[:2]

    def linear(self, key):
        """(N, 4) linear float32 texels of a texture."""
        return to_linear(self._texels[key]).reshape(-1, 4)

    def is_grey(self, key):
        """Whether red, green and blue are equal in every texel."""
        data = self._texels[key].data
        return bool(np.all(data[..., 0] == data[..., 1]) and np.all(data[..., 0] == data[..., 2]))

    def mean(self, key, channel="rgb"):
        """Mean RGB of a texture (of one channel if named)."""
        pixels = self.linear(key).mean(axis=0, dtype=np.float64)
        return tuple(pixels[:3]) if channel == "rgb" else (pixels["rgba".index(channel)],) * 3

    def lookup(self, key, sampler, uv):
        """RGBA at one place: nearest texel, for surfaces without UVs."""
        height, width = self.size(key)
        m = sampler.transform
        x, y = m[0] * uv[0] + m[1] * uv[1] + m[2], m[3] * uv[0] + m[4] * uv[1] + m[5]
        if sampler.extend == "clip" and not (0 <= x < 1 and 0 <= y < 1):
            return np.zeros(4)
        if sampler.extend == "repeat":
            x, y = x % 1.0, y % 1.0
        column, row = (int(np.clip(v * n, 0, n - 1)) for v, n in ((x, width), (y, height)))
        return self.linear(key)[row * width + column]

    def index(self, key, sampler):
        """Id of a texture in the snapshot; writes its texels the first time."""
        name = (key, sampler.extend, sampler.nearest)
        if name not in self._ids:
            self._ids[name] = len(self.items)
            self.items.append(self._item(key, sampler))
        return self._ids[name]

    def _item(self, key, sampler):
        texels = self._texels[key]
        kind = "u8" if texels.data.dtype == np.uint8 else "f32"
        if key not in self._references:
            self._references[key] = self._writer.add(texels.data, kind)
        height, width = texels.data.shape[:2]
        return {
            "name": texels.name,
            "width": width,
            "height": height,
            "texel": kind,
            "color": "srgb" if texels.srgb else "linear",
            "extend": sampler.extend,
            "nearest": sampler.nearest,
            "texels": self._references[key],
        }
