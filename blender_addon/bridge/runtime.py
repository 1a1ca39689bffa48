# SPDX-License-Identifier: GPL-3.0-or-later
"""A baked package whose light sets, doors and toggles can be turned, for the live preview.

    with Runtime("baked/package") as light:
        light.set_weight("corridor lamps", 0.3)
        for page in light.update():
            image.pixels.foreach_set(light.page_irradiance(page))

ctypes mirror of native/runtime/include/ajar_runtime.h (tests compare the two). The library is small and
runs in the calling process; it needs the standard library only.
"""
import ctypes as c
import os
import sys
from dataclasses import dataclass
from pathlib import Path

ABI_VERSION = 1
OK = 0
ERROR_ARGUMENT, ERROR_STRUCT_SIZE, ERROR_HANDLE, ERROR_NOT_FOUND, ERROR_DATA = -1, -2, -3, -4, -5
ERROR_MEMORY, ERROR_IO, ERROR_BUFFER, ERROR_INTERNAL = -6, -7, -8, -10
KINDS = ("light_set", "door", "toggle")
GROUP_SIZE = 64

Handle = c.c_void_p
Result = c.c_int32
u32, u64, f32 = c.c_uint32, c.c_uint64, c.c_float
floats, uints = c.POINTER(f32), c.POINTER(u32)


class ElementInfo(c.Structure):
    _fields_ = [
        ("struct_size", u32),
        ("kind", u32),
        ("name", c.c_char_p),
        ("weight", f32),
        ("start_weight", f32),
        ("color", f32 * 3),
        ("dispatches", u32),
        ("texels", u64),
    ]


class Stats(c.Structure):
    _fields_ = [("struct_size", u32), ("dispatches", u32), ("texels", u64), ("pages", u32)]


class Rect(c.Structure):
    _fields_ = [("x", u32), ("y", u32), ("width", u32), ("height", u32)]


class Patch(c.Structure):
    _fields_ = [
        ("struct_size", u32),
        ("page_x", u32),
        ("page_y", u32),
        ("width", u32),
        ("height", u32),
        ("atlas_x", u32),
        ("atlas_y", u32),
        ("channel", u32),
    ]


class Buffers(c.Structure):
    _fields_ = [
        ("struct_size", u32),
        ("dispatch_count", u32),
        ("term_count", u32),
        ("dispatches", uints),
        ("palette", uints),
        ("data", uints),
        ("palette_words", u64),
        ("data_words", u64),
    ]


class Work(c.Structure):
    _fields_ = [
        ("struct_size", u32),
        ("group_count", u32),
        ("groups", uints),
        ("term_weights", floats),
        ("stats", Stats),
    ]


# struct name in the header -> mirror; used by the tests as well.
STRUCTS = {
    "ajar_runtime_element": ElementInfo,
    "ajar_runtime_stats": Stats,
    "ajar_runtime_rect": Rect,
    "ajar_runtime_patch": Patch,
    "ajar_runtime_buffers": Buffers,
    "ajar_runtime_work": Work,
}

P = c.POINTER

# function -> (restype, argtypes)
FUNCTIONS = {
    "ajar_runtime_abi_version": (u32, []),
    "ajar_runtime_result_text": (c.c_char_p, [Result]),
    "ajar_runtime_error_message": (c.c_char_p, []),
    "ajar_runtime_open": (Result, [c.c_char_p, P(Handle)]),
    "ajar_runtime_release": (Result, [P(Handle)]),
    "ajar_runtime_element_init": (None, [P(ElementInfo)]),
    "ajar_runtime_element_count": (Result, [Handle, uints]),
    "ajar_runtime_get_element": (Result, [Handle, u32, P(ElementInfo)]),
    "ajar_runtime_find_element": (Result, [Handle, c.c_char_p, uints]),
    "ajar_runtime_set_weight": (Result, [Handle, u32, f32]),
    "ajar_runtime_set_color": (Result, [Handle, u32, floats]),
    "ajar_runtime_door_openness": (f32, [f32, f32]),
    "ajar_runtime_stats_init": (None, [P(Stats)]),
    "ajar_runtime_update": (Result, [Handle, P(Stats)]),
    "ajar_runtime_page_count": (Result, [Handle, uints]),
    "ajar_runtime_page_size": (Result, [Handle, u32, uints, uints]),
    "ajar_runtime_page_dirty": (Result, [Handle, u32, P(Rect)]),
    "ajar_runtime_page_texels": (Result, [Handle, u32, P(uints), P(uints)]),
    "ajar_runtime_page_scale": (Result, [Handle, u32, floats]),
    "ajar_runtime_read_irradiance": (Result, [Handle, u32, u32, floats, u64]),
    "ajar_runtime_patch_init": (None, [P(Patch)]),
    "ajar_runtime_add_patch": (Result, [P(Patch), P(c.c_uint16), u32, u32, floats, floats, u32, u32]),
    "ajar_runtime_buffers_init": (None, [P(Buffers)]),
    "ajar_runtime_get_buffers": (Result, [Handle, P(Buffers)]),
    "ajar_runtime_work_init": (None, [P(Work)]),
    "ajar_runtime_plan_update": (Result, [Handle, P(Work)]),
}


class LightError(Exception):
    """A failure of the run-time library: code (ERROR_*) and message."""

    def __init__(self, code, message):
        super().__init__(message)
        self.code, self.message = code, message


@dataclass(frozen=True)
class Element:
    """A light set, door or toggle as it stands. texels: how many a change of it updates."""

    index: int
    name: str
    kind: str
    weight: float
    start_weight: float
    color: tuple
    texels: int


def library_file_name():
    """File name of the library on this system."""
    return {"win32": "ajar_runtime.dll", "darwin": "libajar_runtime.dylib"}.get(
        sys.platform, "libajar_runtime.so"
    )


def library_path():
    """Where the library is: $AJAR_RUNTIME_LIBRARY, the packaged one, or the repository's release build.

    Raises LightError(IO) that lists the places looked at if there is none.
    """
    given = os.environ.get("AJAR_RUNTIME_LIBRARY")
    addon, name = Path(__file__).resolve().parent.parent, library_file_name()
    places = (
        [Path(given)] if given else [addon / "lib" / name, addon.parent / "build" / "release" / "lib" / name]
    )
    for place in places:
        if place.is_file():
            return place
    looked = ", ".join(str(p) for p in places)
    raise LightError(ERROR_IO, f"the Ajar run-time library is not installed (looked for {looked})")


def load_library(path=None):
    """ctypes.CDLL with every argtypes and restype set; refuses another ABI version."""
    path = path or library_path()
    try:
        library = c.CDLL(str(path))
        for name, (result, arguments) in FUNCTIONS.items():
            function = getattr(library, name)
            function.restype, function.argtypes = result, arguments
    except (OSError, AttributeError) as error:
        raise LightError(ERROR_IO, f"cannot load {path}: {error}") from error
    version = library.ajar_runtime_abi_version()
    if version != ABI_VERSION:
        raise LightError(ERROR_IO, f"{path} has ABI {version}, the add-on needs {ABI_VERSION}")
    return library


class Runtime:
    """An open package. Elements are named by index or by name; a context manager closes it."""

    def __init__(self, directory, library=None):
        """Opens the package in directory; pages show the base light until the first update()."""
        self._library = library or load_library()
        self._handle = Handle()
        self._call("open", os.fsencode(directory), c.byref(self._handle))

    def close(self):
        """Frees the package; safe to call twice."""
        if self._handle:
            self._call("release", c.byref(self._handle))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __del__(self):
        if getattr(self, "_handle", None):
            self._library.ajar_runtime_release(c.byref(self._handle))

    def elements(self):
        """[Element] in the package's order."""
        count = u32()
        self._call("element_count", self._handle, c.byref(count))
        return [self.element(index) for index in range(count.value)]

    def element(self, index):
        """Element of an index as it stands."""
        info = self._struct(ElementInfo, "element")
        self._call("get_element", self._handle, index, c.byref(info))
        return Element(
            index,
            info.name.decode("utf-8", "replace"),
            KINDS[info.kind],
            info.weight,
            info.start_weight,
            tuple(info.color),
            info.texels,
        )

    def find(self, name):
        """Index of the element of that name; raises LightError(NOT_FOUND) without one."""
        index = u32()
        self._call("find_element", self._handle, name.encode("utf-8"), c.byref(index))
        return index.value

    def set_weight(self, element, weight):
        """Strength of a light set (0 and up), openness of a door or presence of a toggle (0 to 1)."""
        self._call("set_weight", self._handle, self._index(element), weight)

    def set_color(self, element, color):
        """Colour of a light set, 3 numbers from 0, relative to the bake."""
        self._call("set_color", self._handle, self._index(element), (f32 * 3)(*color))

    def door_openness(self, angle, open_angle):
        """Openness of a hinged door at an angle, relative to the one it was baked open at; radians."""
        return self._library.ajar_runtime_door_openness(angle, open_angle)

    def update(self):
        """Brings the pages up to the weights; returns the indices of the pages that changed."""
        self._call("update", self._handle, None)
        return [page for page in range(self.page_count()) if self.page_dirty(page)[2] > 0]

    def page_count(self):
        """Number of lightmap pages."""
        count = u32()
        self._call("page_count", self._handle, c.byref(count))
        return count.value

    def page_size(self, page):
        """(width, height) in texels."""
        width, height = u32(), u32()
        self._call("page_size", self._handle, page, c.byref(width), c.byref(height))
        return width.value, height.value

    def page_dirty(self, page):
        """(x, y, width, height) of the box that the last update may have changed, from the top left."""
        rect = Rect()
        self._call("page_dirty", self._handle, page, c.byref(rect))
        return rect.x, rect.y, rect.width, rect.height

    def page_irradiance(self, page, channels=4):
        """Irradiance in W/m^2 as a ctypes float array, bottom row first, RGBA (alpha 1) or RGB.

        It goes as it is into image.pixels.foreach_set; numpy.frombuffer reads it without a copy.
        """
        width, height = self.page_size(page)
        buffer = (f32 * (width * height * channels))()
        self._call("read_irradiance", self._handle, page, channels, buffer, len(buffer))
        return buffer

    def _index(self, element):
        return self.find(element) if isinstance(element, str) else element

    def _struct(self, kind, name):
        value = kind()
        getattr(self._library, f"ajar_runtime_{name}_init")(c.byref(value))
        return value

    def _call(self, name, *arguments):
        result = getattr(self._library, f"ajar_runtime_{name}")(*arguments)
        if result != OK:
            text = self._library.ajar_runtime_error_message() or self._library.ajar_runtime_result_text(
                result
            )
            raise LightError(result, text.decode("utf-8", "replace"))
