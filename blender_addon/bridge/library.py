# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds, loads and version-checks the native library; result codes become BakeError."""

import ctypes
import os
import sys
from pathlib import Path

from . import abi


class BakeError(Exception):
    """A failure of the engine: code (AJAR_ERROR_*), message, culprit (object, image or file)."""

    def __init__(self, code, message, culprit=""):
        super().__init__(f"{culprit}: {message}" if culprit else message)
        self.code, self.message, self.culprit = code, message, culprit


def library_file_name():
    """File name of the library on this system."""
    return {"win32": "ajar.dll", "darwin": "libajar.dylib"}.get(sys.platform, "libajar.so")


def library_path():
    """Where the library is: $AJAR_LIBRARY, the packaged one, or the repository's release build.

    Raises BakeError(IO) that lists the places looked at if there is none.
    """
    given = os.environ.get("AJAR_LIBRARY")
    addon = Path(__file__).resolve().parent.parent
    name = library_file_name()
    places = (
        [Path(given)] if given else [addon / "lib" / name, addon.parent / "build" / "release" / "lib" / name]
    )
    for place in places:
        if place.is_file():
            return place
    looked = ", ".join(str(p) for p in places)
    raise BakeError(abi.ERROR_IO, f"the Ajar engine is not installed (looked for {looked})", name)


def load_library(path=None):
    """ctypes.CDLL with every argtypes and restype set; refuses another ABI version."""
    path = path or library_path()
    try:
        library = ctypes.CDLL(str(path))
    except OSError as error:
        raise BakeError(abi.ERROR_IO, f"cannot load the engine: {error}", str(path)) from error
    for name, (result, arguments) in abi.FUNCTIONS.items():
        try:
            function = getattr(library, name)
        except AttributeError:
            raise BakeError(abi.ERROR_IO, f"the engine lacks {name}", str(path)) from None
        function.restype, function.argtypes = result, arguments
    version = library.ajar_abi_version()
    if version != abi.ABI_VERSION:
        raise BakeError(
            abi.ERROR_IO, f"engine has ABI {version}, the add-on needs {abi.ABI_VERSION}", str(path)
        )
    return library


def check(library, result):
    """Raises BakeError with this thread's message and culprit unless result is a success."""
    if result >= 0:
        return result
    text = decode(library.ajar_error_message()) or decode(library.ajar_result_text(result))
    raise BakeError(result, text, decode(library.ajar_error_culprit()))


def decode(text):
    """UTF-8 bytes of the engine as str; bad bytes are replaced, None is ''."""
    return (text or b"").decode("utf-8", "replace")


def read_warnings(library, handle, kind):
    """Warnings of a 'scene' or 'layout' handle as [(culprit, text)]."""
    count = ctypes.c_uint32()
    check(library, getattr(library, f"ajar_{kind}_warning_count")(handle, ctypes.byref(count)))
    text, culprit = ctypes.create_string_buffer(1024), ctypes.create_string_buffer(512)
    found = []
    for index in range(count.value):
        check(
            library,
            getattr(library, f"ajar_{kind}_warning")(handle, index, text, len(text), culprit, len(culprit)),
        )
        found.append((decode(culprit.value), decode(text.value)))
    return found
