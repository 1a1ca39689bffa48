# SPDX-License-Identifier: GPL-3.0-or-later
"""Lightmap pages of a package as Blender images that refer to the files on disk."""
import os

import bpy
import numpy

from .record import absolute_path, load_json, relative_path

_LINEAR = ("Linear Rec.709", "Linear")
_DATA = ("Non-Color", "Raw")
_COLOR = ("sRGB",)
NOT_LIVE, MEAN = -1, -2  # Image.ajar.live_page of other images, and of the mean of all pages


class PageLight:
    """One page for the preview: its image and the mean irradiance of all pages. image None stands
    for surfaces without a lightmap."""

    def __init__(self, index, image, mean, mean_image=None):
        self.index = index
        self.image = image
        self.mean = mean
        self.mean_image = mean_image  # one texel that follows the weights, in place of mean


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


def load_overlap(package, what):
    """The pictures of all pages of what ("overlap" or "bytes") texels take; none if the bake made none."""
    manifest = load_json(os.path.join(package, "manifest.json"))
    names = [page[what] for page in manifest.get("pages", []) if what in page]
    return [load_image(os.path.join(package, name), _COLOR) for name in names]


def _sum_of_lit_texels(image):
    """(red, green, blue, count) over texels that hold light; empty ones are exactly black."""
    count = image.size[0] * image.size[1] * image.channels
    pixels = numpy.empty(count, dtype=numpy.float32)
    image.pixels.foreach_get(pixels)
    colors = pixels.reshape(-1, image.channels)[:, :3]
    lit = colors[colors.any(axis=1) & numpy.isfinite(colors).all(axis=1)]
    return numpy.append(lit.sum(axis=0, dtype=numpy.float64), len(lit))


# ---- images that follow the weights ---------------------------------------------------------


def live_images():
    """All of them; one that no material shows is not saved with the file."""
    return [i for i in bpy.data.images if i.library is None and i.ajar.live_page != NOT_LIVE]


def find_live(page):
    """The image of a page (or MEAN) that follows the weights, or None."""
    return next((image for image in live_images() if image.ajar.live_page == page), None)


def make_live(page, size):
    """find_live(page), made first if there is none. ValueError if it has another size."""
    image = find_live(page)
    if image is None:
        name = "Ajar.live.mean" if page == MEAN else f"Ajar.live.{page}"
        image = bpy.data.images.new(name, *size, alpha=False, float_buffer=True)
        image.ajar.is_page, image.ajar.live_page = True, page
        set_color_space(image, _LINEAR)
    if tuple(image.size) != tuple(size):
        raise ValueError(f"the package has pages of another size than this file: bake again ({image.name})")
    return image


def fill(page, pixels):
    """Writes RGBA floats, bottom row first."""
    image = find_live(page)
    image.pixels.foreach_set(pixels)
    image.update()


def fill_mean(count):
    """Brings the mean image up to the pages."""
    sums = sum(_sum_of_lit_texels(find_live(page)) for page in range(count))
    fill(MEAN, numpy.append(sums[:3] / max(sums[3], 1.0), 1.0).astype(numpy.float32))


def live_pages(count):
    """PageLight of every page, and one for surfaces without a lightmap, that follow the weights."""
    mean = find_live(MEAN)
    color = tuple(mean.pixels[:3])
    return [PageLight(i, find_live(i), color) for i in range(count)], PageLight(-1, None, color, mean)


def pack_live():
    """Puts what the images show into the file, so that it is there when the file is opened again."""
    for image in live_images():
        if image.is_dirty:
            image.pack()


def remove_live():
    """Removes the images."""
    for image in live_images():
        bpy.data.images.remove(image)
