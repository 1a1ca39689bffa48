# SPDX-License-Identifier: GPL-3.0-or-later
"""Small tileable pictures made with numpy; arrays are (height, width, 3 or 4), bottom row first.

Colours are sRGB values in [0, 1], as painted; `sky` alone is linear radiance.
"""
import numpy as np

SIZE = 256


def noise(height, width, smoothness=(1.0, 1.0), seed=1):
    """Tileable noise with mean 0 and deviation 1; larger smoothness means larger features (v, u)."""
    spectrum = np.fft.rfft2(np.random.default_rng(seed).normal(size=(height, width)))
    v = np.fft.fftfreq(height)[:, None] * height * smoothness[0]
    u = np.fft.rfftfreq(width)[None, :] * width * smoothness[1]
    field = np.fft.irfft2(spectrum / (1.0 + v * v + u * u) ** 0.75, s=(height, width))
    return (field - field.mean()) / field.std()


def grid():
    """Texel centres v, u in [0, 1)."""
    centres = (np.arange(SIZE) + 0.5) / SIZE
    return np.meshgrid(centres, centres, indexing="ij")


def paint(color, brightness):
    return np.clip(np.asarray(color) * np.asarray(brightness)[..., None], 0.0, 1.0)


def blend(first, second, mask):
    return first * (1.0 - mask[..., None]) + second * mask[..., None]


def edge_distance(cell):
    """Distance of a coordinate in units of cells to the nearest cell border."""
    fraction = cell % 1.0
    return np.minimum(fraction, 1.0 - fraction)


def plaster(color=(0.86, 0.83, 0.77)):
    return paint(
        color, 1.0 + 0.015 * noise(SIZE, SIZE, (0.5, 0.5), 3) + 0.012 * noise(SIZE, SIZE, (0.05, 0.05), 4)
    )


def floor_tiles():
    """4 x 4 tiles, light and terracotta in turn."""
    v, u = grid()
    row, column = (v * 4).astype(int), (u * 4).astype(int)
    tone = np.random.default_rng(5).normal(1.0, 0.035, (4, 4))[row, column]
    tone = tone + 0.03 * noise(SIZE, SIZE, (0.3, 0.3), 6)
    light, dark = paint((0.84, 0.79, 0.70), tone), paint((0.62, 0.36, 0.26), tone)
    tiles = blend(light, dark, ((row + column) % 2).astype(float))
    grout = np.minimum(edge_distance(v * 4), edge_distance(u * 4)) < 0.025
    return blend(tiles, np.broadcast_to((0.45, 0.42, 0.38), tiles.shape), grout.astype(float))


def planks(color=(0.60, 0.42, 0.27), rows=6, seed=7):
    """Boards along u with staggered joints."""
    v, u = grid()
    rng = np.random.default_rng(seed)
    row = (v * rows).astype(int)
    shifted = u + rng.random(rows)[row]
    grain = noise(SIZE, SIZE, (0.04, 1.5), seed + 1)
    tone = rng.normal(1.0, 0.09, rows)[row] + 0.07 * grain
    gap = (edge_distance(v * rows) < 0.035) | (edge_distance(shifted) * rows < 0.02)
    return blend(paint(color, tone), paint(color, 0.35 * np.ones_like(u)), gap.astype(float))


def bricks():
    """8 courses of 4 bricks in running bond."""
    v, u = grid()
    row = (v * 8).astype(int)
    across = u * 4 + 0.5 * (row % 2)
    column = across.astype(int) % 4
    tone = np.random.default_rng(9).normal(1.0, 0.10, (8, 4))[row, column] + 0.06 * noise(
        SIZE, SIZE, (0.1, 0.1), 10
    )
    mortar = (edge_distance(v * 8) < 0.07) | (edge_distance(across) < 0.035)
    return blend(
        paint((0.62, 0.36, 0.28), tone), paint((0.66, 0.63, 0.58), np.ones_like(u)), mortar.astype(float)
    )


def crate():
    """One face of a wooden crate: boards inside a frame with a brace."""
    v, u = grid()
    boards = planks((0.66, 0.50, 0.31), 5, 11)
    border = np.minimum(np.minimum(u, 1 - u), np.minimum(v, 1 - v))
    frame = (border < 0.11) | (np.abs(u - v) < 0.07)
    line = (np.abs(border - 0.11) < 0.008) | ((np.abs(np.abs(u - v) - 0.07) < 0.008) & (border > 0.11))
    timber = paint((0.55, 0.39, 0.23), 1.0 + 0.05 * noise(SIZE, SIZE, (1.0, 0.05), 12))
    return blend(blend(boards, timber, frame.astype(float)), 0.3 * timber, line.astype(float))


def rug():
    """Woven stripes with a plain border."""
    v, u = grid()
    colors = np.array([(0.46, 0.20, 0.17), (0.74, 0.64, 0.50), (0.36, 0.38, 0.44), (0.78, 0.74, 0.68)])
    zigzag = (u * 9 + np.abs((v * 12) % 1.0 - 0.5) * 0.8).astype(int) % 4
    border = np.minimum(np.minimum(u, 1 - u), np.minimum(v, 1 - v))
    woven = colors[zigzag]
    woven = np.where((border < 0.07)[..., None], colors[0] * 0.8, woven)
    return np.clip(woven * (1.0 + 0.05 * noise(SIZE, SIZE, (0.02, 0.02), 13))[..., None], 0, 1)


def painting():
    """A low sun over hills."""
    v, u = grid()
    sky_part = blend(
        np.broadcast_to((0.93, 0.55, 0.28), v.shape + (3,)),
        np.broadcast_to((0.25, 0.35, 0.60), v.shape + (3,)),
        v,
    )
    sun = (u - 0.62) ** 2 + (v - 0.52) ** 2 < 0.012
    picture = blend(sky_part, np.broadcast_to((0.99, 0.87, 0.55), sky_part.shape), sun.astype(float))
    for height, color, phase in (
        (0.45, (0.42, 0.30, 0.42), 0.0),
        (0.32, (0.25, 0.22, 0.33), 1.9),
        (0.18, (0.12, 0.15, 0.20), 4.0),
    ):
        ridge = height + 0.06 * np.sin(7 * u + phase) + 0.03 * np.sin(17 * u + 2 * phase)
        picture = blend(picture, np.broadcast_to(color, picture.shape), (v < ridge).astype(float))
    return picture


def lattice():
    """Iron bars, crossing diagonally; alpha 0 between them."""
    v, u = grid()
    bars = np.minimum(edge_distance((u + v) * 4), edge_distance((u - v) * 4)) < 0.065
    iron = paint((0.20, 0.20, 0.22), 1.0 + 0.1 * noise(SIZE, SIZE, (0.05, 0.05), 14))
    return np.concatenate([iron, bars[..., None].astype(float)], axis=-1)


def stained_glass():
    """Transmittance of a leaded pane: coloured diamonds between dark lead."""
    v, u = grid()
    colors = np.array(
        [(0.98, 0.75, 0.25), (0.90, 0.25, 0.20), (0.25, 0.55, 0.92), (0.35, 0.80, 0.45), (0.95, 0.93, 0.88)]
    )
    a, b = ((u * 2 + v * 3) * 2), ((u * 2 - v * 3) * 2)
    pick = np.random.default_rng(15).integers(0, 5, (32, 32))[
        a.astype(int) % 32, np.floor(b).astype(int) % 32
    ]
    lead = np.minimum(edge_distance(a), edge_distance(b)) < 0.06
    return blend(colors[pick], np.full(v.shape + (3,), 0.02), lead.astype(float))


def sky(toward_sun, width=256):
    """Radiance by Blender's equirectangular mapping: a clear sky with clouds and a glow at the sun."""
    height = width // 2
    azimuth = (0.5 - (np.arange(width) + 0.5) / width) * 2 * np.pi
    elevation = ((np.arange(height) + 0.5) / height - 0.5) * np.pi
    elevation, azimuth = np.meshgrid(elevation, azimuth, indexing="ij")
    direction = np.stack(
        [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)], -1
    )
    up = np.clip(direction[..., 2], 0.0, 1.0)
    clear = blend(
        np.broadcast_to((0.95, 1.05, 1.15), direction.shape),
        np.broadcast_to((0.18, 0.40, 0.95), direction.shape),
        up**0.45,
    )
    clouds = noise(height, width, (0.12, 0.06), 16)
    cover = np.clip(clouds * 0.6 - 0.1, 0.0, 0.8) * np.clip(up * 4.0, 0.0, 1.0)
    glow = np.clip(direction @ np.asarray(toward_sun), 0.0, 1.0) ** 24
    radiance = blend(clear, np.full(direction.shape, 1.5), cover) + glow[..., None] * (1.6, 1.3, 0.9)
    ground = np.broadcast_to((0.22, 0.21, 0.16), direction.shape)
    return blend(ground, radiance, (direction[..., 2] > 0.0).astype(float))
