# SPDX-License-Identifier: GPL-3.0-or-later
"""The ctypes mirror against the header: names, order, types, sizes, enum values."""
import ctypes
import re
import shutil
import subprocess

import pytest

from blender_addon.bridge import abi

SCALARS = {
    "uint32_t": ctypes.c_uint32,
    "uint64_t": ctypes.c_uint64,
    "float": ctypes.c_float,
    "double": ctypes.c_double,
    "ajar_result": ctypes.c_int32,
    "int32_t": ctypes.c_int32,
}


@pytest.fixture(scope="module")
def header(root):
    text = (root / "native" / "include" / "ajar" / "ajar.h").read_text(encoding="utf-8")
    return re.sub(r"/\*.*?\*/", "", text, flags=re.S)


def header_structs(header):
    """{struct: [(field, C type, array length or None)]}."""
    found = {}
    header = with_numbers(header)
    for body, name in re.findall(r"typedef struct \w+ \{(.*?)\} (\w+);", header, re.S):
        found[name] = [field for line in body.split(";") for field in fields_of(line.strip())]
    return found


def with_numbers(header):
    """The header with array lengths that are names of a #define replaced by their numbers."""
    for name, number in re.findall(r"#define (AJAR_\w+) (\d+)u\b", header):
        header = re.sub(rf"\[{name}\]", f"[{number}]", header)
    return header


def fields_of(line):
    if not line:
        return
    first, *others = line.split(",")
    kind, name = re.match(r"(.*?[\s*])(\w+(?:\[\d+\])?)$", first, re.S).groups()
    for declared in [name] + [o.strip() for o in others]:
        plain, length = re.match(r"(\w+)(?:\[(\d+)\])?$", declared).groups()
        yield plain, kind.strip(), int(length) if length else None


def test_every_struct_is_mirrored(header):
    assert set(header_structs(header)) == set(abi.STRUCTS)


@pytest.mark.parametrize("name", sorted(abi.STRUCTS))
def test_struct_fields(header, name):
    declared, mirrored = header_structs(header)[name], abi.STRUCTS[name]._fields_
    assert [f[0] for f in declared] == [f[0] for f in mirrored]
    for (field, kind, length), (_, mirror) in zip(declared, mirrored):
        check_type(field, kind, length, mirror)


def check_type(field, kind, length, mirror):
    if kind in abi.STRUCTS or kind in SCALARS:
        wanted = abi.STRUCTS.get(kind) or SCALARS[kind]
        assert mirror is (wanted * length if length else wanted), field
    else:
        assert kind.endswith("*") and ctypes.sizeof(mirror) == ctypes.sizeof(ctypes.c_void_p), field


def test_sizes_agree_with_the_compiler(root, tmp_path):
    compiler = shutil.which("cc") or shutil.which("gcc")
    assert compiler, "a C compiler is needed"
    lines = [f'printf("{n} %zu\\n", sizeof({n}));' for n in abi.STRUCTS]
    lines += [
        f'printf("{n}.{f[0]} %zu\\n", offsetof({n}, {f[0]}));'
        for n, s in abi.STRUCTS.items()
        for f in s._fields_
    ]
    source = tmp_path / "sizes.c"
    source.write_text(
        "#include <ajar/ajar.h>\n#include <stdio.h>\nint main(void) {" + "\n".join(lines) + "return 0; }"
    )
    program = tmp_path / "sizes"
    subprocess.run(
        [compiler, "-std=c99", "-I", root / "native" / "include", source, "-o", program], check=True
    )
    output = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    for name, size in (line.split() for line in output.splitlines()):
        struct, _, field = name.partition(".")
        mirror = abi.STRUCTS[struct]
        assert int(size) == (getattr(mirror, field).offset if field else ctypes.sizeof(mirror)), name


def test_every_function_is_mirrored(header):
    declared = {}
    for result, name, arguments in re.findall(r"AJAR_API\s+([\w\s*]+?)\s*\b(ajar_\w+)\(([^)]*)\)", header):
        declared[name] = (result, 0 if arguments.strip() == "void" else len(arguments.split(",")))
    assert set(declared) == set(abi.FUNCTIONS)
    for name, (result, count) in declared.items():
        mirror, arguments = abi.FUNCTIONS[name]
        assert len(arguments) == count, name
        wanted = {"void": None, "const char*": ctypes.c_char_p}.get(result, SCALARS.get(result))
        assert mirror is wanted, name


def test_numbers(header):
    values = {n: int(v, 0) for n, v in re.findall(r"(AJAR_\w+) = (-?\w+)", header)}
    assert int(re.search(r"AJAR_ABI_VERSION (\d+)u", header)[1]) == abi.ABI_VERSION
    assert int(re.search(r"AJAR_MAX_CLOSURES (\d+)u", header)[1]) == abi.MAX_CLOSURES
    assert int(re.search(r"AJAR_MAX_TERM_ELEMENTS (\d+)u", header)[1]) == abi.MAX_TERM_ELEMENTS
    for name in (n for n in vars(abi) if n.startswith("ERROR_")):
        assert getattr(abi, name) == values["AJAR_" + name], name
    assert (abi.OK, abi.CANCELLED, abi.RUNNING) == tuple(
        values[f"AJAR_{n}"] for n in ("OK", "CANCELLED", "RUNNING")
    )
    words = {
        "TEXEL": abi.TEXEL,
        "COLOR": abi.COLOR,
        "EXTEND": abi.EXTEND,
        "CHANNEL": abi.CHANNEL,
        "CLOSURE": abi.CLOSURE,
        "SURFACE": abi.SURFACE,
        "VISIBLE": abi.VISIBLE,
        "ROLE": abi.ROLE,
        "SKY": abi.SKY,
        "ELEMENT": abi.ELEMENT,
        "COMBINATIONS": abi.COMBINATIONS,
        "LIGHT_PATCHES": abi.LIGHT_PATCHES,
        "CHOICE": abi.CHOICE,
    }
    for prefix, table in words.items():
        for word, number in table.items():
            assert values[f"AJAR_{prefix}_{word.upper()}"] == number
    for word, number in abi.LIGHT.items():
        prefix = "AREA_" if word in {"rectangle", "ellipse"} else ""
        assert values[f"AJAR_LIGHT_{prefix}{word.upper()}"] == number
