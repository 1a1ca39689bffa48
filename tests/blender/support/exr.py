# SPDX-License-Identifier: GPL-3.0-or-later
"""Read scanline OpenEXR files (none, ZIPS, ZIP) with numpy alone, so comparisons need no bindings."""
import struct
import zlib

import numpy as np

_LINES = {0: 1, 2: 1, 3: 16}  # scanlines per chunk by compression
_TYPES = {0: np.dtype('<u4'), 1: np.dtype('<f2'), 2: np.dtype('<f4')}


def read_exr(path):
    """{channel name: (height, width) float32 array, BOTTOM row first}."""
    with open(path, 'rb') as file:
        data = file.read()
    magic, version = struct.unpack_from('<II', data)
    if magic != 20000630 or version & 0x1A00:
        raise ValueError(f"{path}: not a plain scanline OpenEXR file")
    header, at = _read_header(data, 8)
    channels = _read_channels(header['channels'])
    compression = header['compression'][0]
    if compression not in _LINES:
        raise ValueError(f"{path}: compression {compression} is not supported")
    x0, y0, x1, y1 = struct.unpack('<4i', header['dataWindow'])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    planes = {name: np.empty((height, width), np.float32) for name, _ in channels}
    lines = _LINES[compression]
    for offset in struct.unpack_from(f'<{-(-height // lines)}Q', data, at):
        y, size = struct.unpack_from('<iI', data, offset)
        _read_chunk(
            data[offset + 8 : offset + 8 + size],
            compression,
            y - y0,
            min(lines, height - (y - y0)),
            width,
            channels,
            planes,
        )
    return {name: plane[::-1].copy() for name, plane in planes.items()}


def read_rgb(path):
    """(height, width, 3) array of a file's R, G, B channels, bottom row first."""
    planes = read_exr(path)
    return np.stack([planes[name] for name in 'RGB'], axis=-1)


def _read_header(data, at):
    """Attributes up to the empty name, and the position behind them."""
    header = {}
    while data[at]:
        name, at = _read_text(data, at)
        _, at = _read_text(data, at)
        (size,) = struct.unpack_from('<i', data, at)
        header[name] = data[at + 4 : at + 4 + size]
        at += 4 + size
    return header, at + 1


def _read_text(data, at):
    end = data.index(b'\0', at)
    return data[at:end].decode(), end + 1


def _read_channels(data):
    """[(name, dtype)] in file order."""
    channels, at = [], 0
    while data[at]:
        name, at = _read_text(data, at)
        channels.append((name, _TYPES[struct.unpack_from('<i', data, at)[0]]))
        at += 16
    return channels


def _read_chunk(raw, compression, y, count, width, channels, planes):
    size = count * width * sum(kind.itemsize for _, kind in channels)
    if compression and len(raw) < size:
        raw = _undo_predictor(zlib.decompress(raw))
    at = 0
    for row in range(y, y + count):
        for name, kind in channels:
            planes[name][row] = np.frombuffer(raw, kind, width, at)
            at += width * kind.itemsize


def _undo_predictor(raw):
    """Inverse of OpenEXR's byte differences and even/odd split."""
    deltas = np.frombuffer(raw, np.uint8).astype(np.int64)
    deltas[1:] -= 128
    values = (np.cumsum(deltas) & 255).astype(np.uint8)
    half = (len(values) + 1) // 2
    out = np.empty_like(values)
    out[0::2], out[1::2] = values[:half], values[half:]
    return out.tobytes()
