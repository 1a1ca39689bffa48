# SPDX-License-Identifier: GPL-3.0-or-later
"""Lightmap pages as pictures: their light, the noise they state, and where the truth differs."""
import base64
import struct
import zlib

import numpy as np

EDGE = 640  # pixels of the longer side of a page
LEAST, MOST = 0.01, 1.0  # relative errors at the ends of the colours
MOST_PAGES = 3
_RAMP = np.array(
    [[20, 24, 82], [38, 110, 170], [70, 190, 150], [245, 220, 80], [230, 120, 40], [180, 20, 30]]
)


def png(pixels):
    """A PNG file of (height, width, 3) bytes, top row first."""
    height, width = pixels.shape[:2]
    rows = np.zeros((height, 1 + 3 * width), np.uint8)
    rows[:, 1:] = pixels.reshape(height, 3 * width)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
    return (
        b"\x89PNG\r\n\x1a\n" + header + chunk(b"IDAT", zlib.compress(rows.tobytes(), 9)) + chunk(b"IEND", b"")
    )


def colours(errors):
    """Bytes of relative errors, from LEAST in dark blue to MOST in red, by logarithm."""
    place = np.log(np.clip(errors, LEAST, MOST) / LEAST) / np.log(MOST / LEAST) * (len(_RAMP) - 1)
    low = np.minimum(place.astype(int), len(_RAMP) - 2)
    share = (place - low)[..., None]
    return (_RAMP[low] * (1 - share) + _RAMP[low + 1] * share).astype(np.uint8)


def greys(light, white):
    """Bytes of luminance on a screen, white and more as white."""
    linear = np.clip(light / max(white, 1e-30), 0.0, 1.0)
    return np.repeat((255.0 * linear ** (1 / 2.2)).astype(np.uint8)[..., None], 3, axis=-1)


def _rows(shape):
    """(rows, columns) of a page that a picture of it shows: nearest texels, top row first."""
    factor = EDGE / max(shape)
    steps = [np.minimum((np.arange(max(1, round(n * factor))) / factor).astype(int), n - 1) for n in shape]
    return np.ix_(steps[0][::-1], steps[1])


def _dots(backdrop, uv, errors):
    """Errors at points as coloured dots over the dimmed page."""
    picture = (backdrop * 0.35).astype(np.uint8)
    height, width = picture.shape[:2]
    for (u, v), colour in zip(uv, colours(errors)):
        x, y = int(u * width), int((1.0 - v) * height)
        picture[max(0, y - 2) : y + 3, max(0, x - 2) : x + 3] = colour
    return picture


def of_pages(maps, pages, uv, errors):
    """[(caption, PNG as data URI)] of the largest pages of a bake; errors: relative, at points on them."""
    out = []
    largest = sorted(range(len(maps.light)), key=lambda p: -maps.light[p].size)[:MOST_PAGES]
    white = max(float(np.percentile(maps.luminance(pages, uv), 99)), 1e-30)
    for p in sorted(largest):
        light, here = maps.luminance_page(p), pages == p
        window = _rows(light.shape)
        backdrop = greys(light[window], white)
        noise = maps.stderr[p] / (light + 0.01 * white)
        lit = np.where((maps.validity[p] > 0)[window][..., None], colours(noise[window]), 0).astype(np.uint8)
        dots = _dots(backdrop, uv[here], errors[here])
        name = f"page {p}" if len(maps.light) > 1 else "the page"
        out += [
            (f"light of {name}", backdrop),
            ("noise that the bake states", lit),
            ("error against truth", dots),
        ]
    return [(caption, data_uri(picture)) for caption, picture in out]


def data_uri(picture):
    """A picture as pages hold it."""
    return "data:image/png;base64," + base64.b64encode(png(picture)).decode("ascii")
