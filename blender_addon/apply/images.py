# SPDX-License-Identifier: GPL-3.0-or-later
"""Lightmap pages of a package as Blender images that refer to the files on disk."""
import os

import bpy
import numpy

from .record import absolute_path, load_json, relative_path

_LINEAR = ("Linear Rec.709", "Linear")
_DATA = ("Non-Color", "Raw")


class PageLight:
    """One page for the preview: its image and the mean irradiance of all pages. image None stands
    for surfaces without a lightmap."""

    def __init__(self, index, image, mean):
        self.index = index
        self.image = image
        self.mean = mean


def load_pages(package):
    """PageLight of every page, and one without an image for surfaces that have no lightmap."""
    manifest = load_json(os.path.join(package, "manifest.json"))
    images, sums = [], numpy.zeros(4)
    for page in manifest.get("pages", []):
        image = load_image(os.path.join(package, page["irradiance"]), _LINEAR)
        images.append(image)
        sums += _sum_of_lit_texels(image)
    mean = tuple(float(channel) for channel in sums[:3] / max(sums[3], 1.0))
    return [PageLight(i, image, mean) for i, image in enumerate(images)], PageLight(-1, None, mean)


def load_image(path, spaces):
    """An image on disk with the first colour space that this Blender knows, reloaded if it is
    loaded already. ValueError if the file is missing or unreadable."""
    path = absolute_path(path)
    if not os.path.isfile(path):
        raise ValueError(f"{path} is missing: bake again")
    image = next(
        (image for image in bpy.data.images if image.ajar.is_page and absolute_path(image.filepath) == path),
        None,
    )
    if image is None:
        image = bpy.data.images.load(path)
        image.ajar.is_page = True
        image.name = "Ajar." + os.path.basename(path)
    else:
        image.reload()
    image.filepath = relative_path(path)
    set_color_space(image, spaces)
    if image.size[0] == 0:
        raise ValueError(f"{path} cannot be read: bake again")
    return image


def set_color_space(image, spaces):
    """Sets the first of the named colour spaces that exists here; names differ by version."""
    known = image.colorspace_settings.bl_rna.properties["name"].enum_items.keys()
    for space in spaces:
        if space in known:
            image.colorspace_settings.name = space
            return


def load_direction(package, page):
    """The highlight direction and ratio of a manifest page, as data."""
    return load_image(os.path.join(package, page["packed"]["direction_png"]), _DATA)


def _sum_of_lit_texels(image):
    """(red, green, blue, count) over texels that hold light; empty ones are exactly black."""
    count = image.size[0] * image.size[1] * image.channels
    pixels = numpy.empty(count, dtype=numpy.float32)
    image.pixels.foreach_get(pixels)
    colors = pixels.reshape(-1, image.channels)[:, :3]
    lit = colors[colors.any(axis=1) & numpy.isfinite(colors).all(axis=1)]
    return numpy.append(lit.sum(axis=0, dtype=numpy.float64), len(lit))
