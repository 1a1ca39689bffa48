# SPDX-License-Identifier: GPL-3.0-or-later
"""Write 8-bit PNG files with numpy alone."""
import struct
import zlib

import numpy as np


def srgb(linear):
    """sRGB transfer of linear values, clipped to 0..1 (Blender's view transform 'Standard')."""
    linear = np.clip(linear, 0.0, 1.0)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def write_png(path, pixels):
    """Write an (h, w, 3) array of display values 0..1, BOTTOM row first."""
    rows = (np.clip(np.nan_to_num(pixels), 0, 1) * 255 + 0.5).astype(np.uint8)[::-1]
    height, width, _ = rows.shape
    raw = np.concatenate([np.zeros((height, 1), np.uint8), rows.reshape(height, -1)], axis=1)
    with open(path, 'wb') as file:
        file.write(b'\x89PNG\r\n\x1a\n')
        for kind, body in (
            (b'IHDR', struct.pack('>IIBBBBB', width, height, 8, 2, 0, 0, 0)),
            (b'IDAT', zlib.compress(raw.tobytes(), 6)),
            (b'IEND', b''),
        ):
            file.write(
                struct.pack('>I', len(body)) + kind + body + struct.pack('>I', zlib.crc32(kind + body))
            )
