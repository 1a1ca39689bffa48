# SPDX-License-Identifier: GPL-3.0-or-later
"""Snapshot and layout directories: <name>.json beside <name>.bin (standard library only).

An array reference is {"offset": bytes, "count": scalars, "type": "f32"|"u32"|"u8"|"f64"}, its
offset aligned to 64 bytes.
"""

import ctypes
import json
import mmap
import os
from array import array
from pathlib import Path

VERSION = 1
ALIGNMENT = 64
_TYPES = {"f32": ctypes.c_float, "u32": ctypes.c_uint32, "u8": ctypes.c_uint8, "f64": ctypes.c_double}
_CODES = {"f32": "f", "u32": "I", "u8": "B", "f64": "d"}


class SnapshotError(ValueError):
    """A snapshot or layout directory that cannot be read; the message says where."""


class Reader:
    """Reads <name>.json and maps <name>.bin privately; pointers are valid until close()."""

    def __init__(self, directory, name="snapshot"):
        directory = Path(directory)
        try:
            self.data = json.loads((directory / f"{name}.json").read_text(encoding="utf-8"))
            with open(directory / f"{name}.bin", "rb") as file:
                # A private copy-on-write map: ctypes only takes addresses of writable buffers.
                self._map = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_COPY)
        except (OSError, ValueError) as error:
            raise SnapshotError(f"cannot read {name} in {directory}: {error}") from error
        self._anchor = ctypes.c_char.from_buffer(self._map)
        self._base = ctypes.addressof(self._anchor)
        version = self.data.get("version") if isinstance(self.data, dict) else None
        if version != VERSION:
            raise SnapshotError(f"{name}.json has version {version}, not {VERSION}")

    def check(self, reference, kind, count=None):
        """Byte offset of an array after checking its type, bounds and (if given) scalar count."""
        try:
            offset, found, type_ = reference["offset"], reference["count"], reference["type"]
        except (TypeError, KeyError) as error:
            raise SnapshotError(f"bad array reference {reference!r}") from error
        if type_ != kind:
            raise SnapshotError(f"array at {offset} is {type_}, not {kind}")
        if count is not None and found != count:
            raise SnapshotError(f"array at {offset} has {found} scalars, not {count}")
        size = ctypes.sizeof(_TYPES[kind])
        if offset < 0 or found < 0 or offset % size or offset + found * size > len(self._map):
            raise SnapshotError(f"array at {offset} leaves the file")
        return offset

    def pointer(self, reference, kind, count=None):
        """ctypes pointer to an array, or None for a null reference."""
        if reference is None:
            return None
        offset = self.check(reference, kind, count)
        return ctypes.cast(self._base + offset, ctypes.POINTER(_TYPES[kind]))

    def values(self, reference, kind, count=None):
        """A copy of an array as array.array."""
        offset = self.check(reference, kind, count)
        end = offset + reference["count"] * ctypes.sizeof(_TYPES[kind])
        return array(_CODES[kind], self._map[offset:end])

    def close(self):
        """Unmaps the file; pointers handed out become invalid."""
        self._anchor = None
        self._map.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


class Writer:
    """Writes <name>.bin array by array, then <name>.json; the JSON appears last and whole."""

    def __init__(self, directory, name="snapshot"):
        self.directory, self.name = Path(directory), name
        self.directory.mkdir(parents=True, exist_ok=True)
        json_path = self.directory / f"{name}.json"
        json_path.unlink(missing_ok=True)  # an older answer must not pair with the new arrays
        self._file = open(self.directory / f"{name}.bin", "wb")
        self._offset = 0

    def add_bytes(self, data, kind):
        """Appends a bytes-like object of scalars of kind; returns its array reference."""
        view = memoryview(data).cast("B")
        self._pad()
        reference = {"offset": self._offset, "type": kind, "count": len(view) // ctypes.sizeof(_TYPES[kind])}
        self._file.write(view)
        self._offset += len(view)
        return reference

    def _pad(self):
        padding = -self._offset % ALIGNMENT
        self._file.write(bytes(padding))
        self._offset += padding

    def finish(self, data):
        """Closes the arrays and writes data (a dict, version added) as JSON."""
        self._file.write(bytes(ALIGNMENT))  # never empty: an empty file cannot be mapped
        self._file.close()
        write_text_whole(
            self.directory / f"{self.name}.json", json.dumps({"version": VERSION, **data}, ensure_ascii=False)
        )

    def abandon(self):
        """Closes and removes what was written."""
        self._file.close()
        (self.directory / f"{self.name}.bin").unlink(missing_ok=True)

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        if kind is not None:
            self.abandon()


def write_text_whole(path, text):
    """Writes a text file so that path holds either the old content or all of the new one."""
    path = Path(path)
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        with open(temporary, "w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)
