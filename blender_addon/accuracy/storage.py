# SPDX-License-Identifier: GPL-3.0-or-later
"""Ways to store directional light, read back at normals that a normal map tilts."""
import numpy as np

from .bakes import LUMINANCE, lookup

TILT = 0.7  # radians
NORMALS = tuple((np.sin(TILT) * np.cos(a), np.sin(TILT) * np.sin(a), np.cos(TILT)) for a in (0.4, 2.5, 4.6))
_K0, _K1 = 0.5 / np.sqrt(np.pi), np.sqrt(3 / (4 * np.pi))
_K2, _K3, _K4 = np.sqrt(15 / (4 * np.pi)), np.sqrt(5 / (16 * np.pi)), np.sqrt(15 / (16 * np.pi))


def sh_basis(n):
    """Nine real spherical harmonics of a unit direction."""
    x, y, z = n
    return np.array(
        [
            _K0,
            -_K1 * y,
            _K1 * z,
            -_K1 * x,
            _K2 * x * y,
            -_K2 * y * z,
            _K3 * (3 * z * z - 1),
            -_K2 * x * z,
            _K4 * (x * x - y * y),
        ]
    )


def sh_irradiance(sh, n, bands):
    """Irradiance from radiance coefficients [..., 9], cosine convolved, from 1 + bands bands."""
    cosine = np.array([np.pi] + [2 * np.pi / 3] * 3 + [np.pi / 4] * 5)
    count = (bands + 1) ** 2
    return np.maximum(sh[..., :count] @ (sh_basis(n) * cosine)[:count], 0.0)


def small_float(bits, mantissa):
    """Unsigned floats of 5 exponent bits."""
    exponent, fraction = bits >> mantissa, (bits & ((1 << mantissa) - 1)) / (1 << mantissa)
    return np.where(
        exponent == 0, fraction * 2.0**-14, (1.0 + fraction) * 2.0 ** (exponent.astype(int) - 15.0)
    )


def unpack(words):
    """(irradiance [..., 3], direction [..., 3], ambient share [...]) of a layer of two packed words."""
    raw = np.ascontiguousarray(words).view(np.uint32)
    first, second = raw[..., 0], raw[..., 1]
    irradiance = np.stack(
        [
            small_float(first & 0x7FF, 6),
            small_float((first >> 11) & 0x7FF, 6),
            small_float(first >> 22, 5),
        ],
        axis=-1,
    )
    byte = lambda shift: ((second >> shift) & 0xFF) / 255.0  # noqa: E731
    return irradiance, np.stack([byte(s) * 2 - 1 for s in (0, 8, 16)], axis=-1), byte(24)


def ahd(maps, pages, uv, n):
    """Luminance of the packed textures, filtered and decoded as a game does."""
    parts = [unpack(words) for words in maps.packed]
    irradiance = lookup([p[0] @ LUMINANCE for p in parts], pages, uv)
    d = lookup([p[1] for p in parts], pages, uv)
    r = lookup([p[2] for p in parts], pages, uv)
    return irradiance * (r + (1 - r) * np.maximum(0.0, d @ np.array(n)) / np.maximum(d[:, 2], 0.1))


def formats(maps, pages, uv, n):
    """Luminance at points for normal n by format, with the bytes a texel takes."""
    sh = lookup([page.reshape(page.shape[:2] + (9, 3)) @ LUMINANCE for page in maps.sh], pages, uv)
    return {
        "flat (no direction), 4 bytes": maps.luminance(pages, uv),
        "AHD as packed, 8 bytes": ahd(maps, pages, uv, n),
        "SH of 4 coefficients, 24 bytes": sh_irradiance(sh, n, 1),
        "SH of 9 coefficients, 54 bytes": sh_irradiance(sh, n, 2),
    }
