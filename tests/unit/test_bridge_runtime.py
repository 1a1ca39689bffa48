# SPDX-License-Identifier: GPL-3.0-or-later
"""The ctypes mirror of the run-time library against its header, and the class on a package that is
written here, byte by byte, from the description of the format."""
import ctypes
import math
import re
import shutil
import struct
import subprocess

import pytest
from test_bridge_abi import SCALARS, header_structs

from blender_addon.bridge import runtime
from blender_addon.bridge.runtime import LightError, Runtime

MASK = (1 << 64) - 1
# R11G11B10F of (1, 2, 4): exponents 15, 16, 17 and no fraction; of the direction z, all highlight.
ONE_TWO_FOUR = (15 << 6) | (16 << 6) << 11 | (17 << 5) << 22
UPWARDS = 0x00FF8080


@pytest.fixture(scope="module")
def header(root):
    text = (root / "native" / "runtime" / "include" / "ajar_runtime.h").read_text(encoding="utf-8")
    return re.sub(r"/\*.*?\*/", "", text, flags=re.S)


@pytest.fixture(scope="module")
def library(runtime_library):
    return runtime.load_library(runtime_library)


def test_every_struct_is_mirrored(header):
    assert set(header_structs(header)) == set(runtime.STRUCTS)


@pytest.mark.parametrize("name", sorted(runtime.STRUCTS))
def test_struct_fields(header, name):
    declared, mirrored = header_structs(header)[name], runtime.STRUCTS[name]._fields_
    assert [f[0] for f in declared] == [f[0] for f in mirrored]
    for (field, kind, length), (_, mirror) in zip(declared, mirrored):
        wanted = runtime.STRUCTS.get(kind) or SCALARS.get(kind)
        if wanted:
            assert mirror is (wanted * length if length else wanted), field
        else:
            assert kind.endswith("*") and ctypes.sizeof(mirror) == ctypes.sizeof(ctypes.c_void_p), field


def test_sizes_agree_with_the_compiler(root, tmp_path):
    compiler = shutil.which("cc") or shutil.which("gcc")
    assert compiler, "a C compiler is needed"
    lines = [f'printf("{n} %zu\\n", sizeof({n}));' for n in runtime.STRUCTS]
    source = tmp_path / "sizes.c"
    source.write_text(
        "#include <ajar_runtime.h>\n#include <stdio.h>\nint main(void) {" + "\n".join(lines) + "return 0; }"
    )
    program = tmp_path / "sizes"
    include = root / "native" / "runtime" / "include"
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
    subprocess.run([compiler, *flags, "-I", include, source, "-o", program], check=True)
    output = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    for name, size in (line.split() for line in output.splitlines()):
        assert int(size) == ctypes.sizeof(runtime.STRUCTS[name]), name


def test_every_function_is_mirrored(header):
    declared = {}
    pattern = r"AJAR_RUNTIME_API\s+([\w\s*]+?)\s*\b(ajar_runtime_\w+)\(([^)]*)\)"
    for result, name, arguments in re.findall(pattern, header):
        declared[name] = (result, 0 if arguments.strip() == "void" else len(arguments.split(",")))
    assert set(declared) == set(runtime.FUNCTIONS)
    results = {"void": None, "const char*": ctypes.c_char_p, "ajar_runtime_result": ctypes.c_int32}
    for name, (result, count) in declared.items():
        mirror, arguments = runtime.FUNCTIONS[name]
        assert len(arguments) == count, name
        assert mirror is results.get(result, SCALARS.get(result)), name


def test_numbers(header):
    values = {n: int(v) for n, v in re.findall(r"AJAR_RUNTIME_(\w+) = (-?\d+)", header)}
    assert int(re.search(r"ABI_VERSION (\d+)u", header)[1]) == runtime.ABI_VERSION
    assert int(re.search(r"GROUP_SIZE (\d+)u", header)[1]) == runtime.GROUP_SIZE
    assert {n for n in values if n.startswith("ERROR")} == {n for n in vars(runtime) if n.startswith("ERROR")}
    assert all(getattr(runtime, n) == v for n, v in values.items() if n.startswith("ERROR"))
    assert [values[k.upper()] for k in runtime.KINDS] == [0, 1, 2]


# ---- a package made here ------------------------------------------------------------------------


def checksum(*parts):
    """Hash of the format: numbers, and bytes 8 at a time."""
    state = 0x9E3779B97F4A7C15
    for part in parts:
        words = [part]
        if isinstance(part, bytes):
            padded = part + b"\0" * (-len(part) % 8)
            words = struct.unpack(f"<{len(padded) // 8}Q", padded)
        for word in words:
            state = (state ^ word) * 0xBF58476D1CE4E5B9 & MASK
            state ^= state >> 29
    return state


def dds(width, height, dxgi, words):
    head = [0] * 37
    head[0:6] = 0x20534444, 124, 0x100F, height, width, 4 * width
    head[19:22] = 32, 4, 0x30315844
    head[32:36] = dxgi, 3, 0, 1
    return struct.pack(f"<{37 + len(words)}I", *head, *words)


def terms_bin(page, elements, term, receivers):
    """One page, one term of all elements, one dispatch of class U with receivers {(x, y): (base, payload)}."""
    irradiance, direction, width, height = page
    names = b"".join(name.encode() for name, _, _ in elements)
    tables, offset = b"", 0
    for name, kind, weight in elements:
        tables += struct.pack("<IIIf", offset, len(name.encode()), kind, weight)
        offset += len(name.encode())
    pages = struct.pack("<IIQQ", width, height, *(checksum(len(f), f) for f in (irradiance, direction)))
    ids = ([*range(len(elements))] + 8 * [0])[:8]
    terms = struct.pack("<I8IIfI", len(elements), *ids, 2, term["scale"], len(receivers))
    n, places = len(receivers), list(receivers)
    address = [y << 16 | x for x, y in places]
    base = [receivers[p][0][i] for i in (0, 1) for p in places]
    payload = [receivers[p][1][i] for i in (0, 1) for p in places]
    data = struct.pack(f"<{5 * n}I", *address, *base, *payload)
    xs, ys = [p[0] for p in places], [p[1] for p in places]
    box = (min(ys) << 16 | min(xs), max(ys) << 16 | max(xs))
    dispatch = struct.pack("<16I", 0, 1, 2, 0, n, n, 0, 1, 0, n, 3 * n, 0, 0, 0, *box)
    sections = [names, tables, pages, terms, dispatch, struct.pack("<HH", 0, 0), data]
    body, placed = b"", []
    for section in sections:
        body += b"\0" * (-len(body) % 16)
        placed += [144 + len(body), len(section)]
        body += section
    size = 144 + len(body)
    start = b"AJARTERM" + struct.pack("<IIQ", 2, len(sections), size)
    rest = struct.pack(f"<{len(placed)}Q", *placed) + body
    return start + struct.pack("<Q", checksum(size, start, 0, rest)) + rest


@pytest.fixture
def package(tmp_path):
    """4 x 2 texels, black; "lamps" and "door" together light the texel (3, 0) of the top row."""
    irradiance, direction = dds(4, 2, 26, [0] * 8), dds(4, 2, 28, [UPWARDS] * 8)
    elements = [("lamps", 0, 1.0), ("dör", 1, 0.0)]
    receivers = {(3, 0): ((0, UPWARDS), (ONE_TWO_FOUR, UPWARDS))}
    (tmp_path / "page_0.irradiance.dds").write_bytes(irradiance)
    (tmp_path / "page_0.direction.dds").write_bytes(direction)
    (tmp_path / "terms.bin").write_bytes(
        terms_bin((irradiance, direction, 4, 2), elements, {"scale": 0.5}, receivers)
    )
    return tmp_path


def test_a_package_is_described(package, library):
    with Runtime(package, library) as light:
        lamps, door = light.elements()
        assert (lamps.name, lamps.kind, lamps.weight, lamps.texels) == ("lamps", "light_set", 1.0, 1)
        assert (door.name, door.kind, door.weight, door.color) == ("dör", "door", 0.0, (1.0, 1.0, 1.0))
        assert light.find("dör") == 1
        assert light.page_count() == 1 and light.page_size(0) == (4, 2)


def test_weights_and_colours_reach_the_page(package, library):
    with Runtime(package, library) as light:
        assert light.update() == []  # the door is closed
        light.set_weight("dör", 0.5)
        light.set_color("lamps", (1.0, 0.0, 2.0))
        light.set_weight(0, 4.0)
        assert light.update() == [0]
        assert light.page_dirty(0) == (3, 0, 1, 1)
        pixels = light.page_irradiance(0)
        assert len(pixels) == 4 * 2 * 4
        lit = 4 * (1 * 4 + 3)  # bottom row first: the top row comes second
        assert list(pixels[lit : lit + 4]) == [1.0, 0.0, 8.0, 1.0]
        assert not any(p for i, p in enumerate(pixels) if i % 4 != 3 and not lit <= i < lit + 4)
        assert list(light.page_irradiance(0, channels=3)[21:24]) == [1.0, 0.0, 8.0]
        light.set_weight("dör", 0.0)
        light.update()
        assert not any(light.page_irradiance(0, channels=3))


def test_failures_are_exceptions_with_the_message(package, library):
    with Runtime(package, library) as light:
        for call, code, word in [
            (lambda: light.set_weight("dör", 1.5), runtime.ERROR_ARGUMENT, "dör"),
            (lambda: light.set_weight("dör", math.nan), runtime.ERROR_ARGUMENT, "nan"),
            (lambda: light.set_weight("window", 1.0), runtime.ERROR_NOT_FOUND, "window"),
            (lambda: light.set_color("dör", (1, 1, 1)), runtime.ERROR_ARGUMENT, "colour"),
            (lambda: light.page_size(1), runtime.ERROR_ARGUMENT, "page 1"),
            (lambda: light.page_irradiance(0, channels=1), runtime.ERROR_ARGUMENT, "channels"),
        ]:
            with pytest.raises(LightError, match=word) as failure:
                call()
            assert failure.value.code == code
    with pytest.raises(LightError) as failure:
        light.update()
    assert failure.value.code == runtime.ERROR_HANDLE
    light.close()


def test_a_missing_package_is_named(tmp_path, library):
    with pytest.raises(LightError, match="nowhere"):
        Runtime(tmp_path / "nowhere", library)


def test_damage_is_told(package, library):
    data = bytearray((package / "terms.bin").read_bytes())
    data[200] ^= 1
    (package / "terms.bin").write_bytes(data)
    with pytest.raises(LightError, match="checksum") as failure:
        Runtime(package, library)
    assert failure.value.code == runtime.ERROR_DATA


def test_door_angles(package, library):
    with Runtime(package, library) as light:
        assert light.door_openness(math.radians(30), math.radians(90)) == pytest.approx(
            math.sin(math.radians(15)) / math.sin(math.radians(45)), rel=1e-6
        )


def test_a_missing_library_is_explained(monkeypatch, tmp_path):
    monkeypatch.setenv("AJAR_RUNTIME_LIBRARY", str(tmp_path / "none.so"))
    with pytest.raises(LightError, match="none.so"):
        runtime.load_library()
