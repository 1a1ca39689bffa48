# SPDX-License-Identifier: GPL-3.0-or-later
"""The shape that the code promises: one way includes, wrapped dependencies, small files, a C header."""
import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCES = ROOT / "native" / "src"
RUNTIME = ROOT / "native" / "runtime"
ORDER = [
    "base",
    "scene",
    "accel",
    "receiver",
    "sampling",
    "transport",
    "reference",
    "pass",
    "post",
    "encode",
    "package",
    "api",
]
LIMIT = 600
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)
# Header prefix -> the only files, relative to native/src, that may include it.
WRAPPED = {
    "embree": ("accel/",),
    "OpenImageIO": ("package/image_io",),
    "OpenEXR": ("package/image_io",),
    "Imath": ("package/image_io",),
    "OpenImageDenoise": ("post/",),
    "nlohmann": ("package/", "api/"),
}
SKIPPED_FOLDERS = {"build", ".git", "__pycache__"}
WITH_LICENSE = {".py", ".c", ".cpp", ".h", ".cmake", ".map"}
LICENSED_NAMES = {"CMakeLists.txt", "dev", "run"}


def project_files():
    """Files of the repository that people write, build folders left out."""
    for path in sorted(ROOT.rglob("*")):
        inside = path.relative_to(ROOT)
        if path.is_file() and not SKIPPED_FOLDERS.intersection(inside.parts):
            yield path


def sources():
    return [p for p in sorted(SOURCES.rglob("*")) if p.suffix in (".h", ".cpp", ".c")]


def includes(path):
    return INCLUDE.findall(path.read_text(encoding="utf-8"))


def folder_of(include, path):
    """The native/src folder that an include reaches, or None for one from elsewhere."""
    first = include.split("/")[0]
    if first in ORDER:
        return first
    if (path.parent / include).is_file():
        return (path.parent / include).resolve().relative_to(SOURCES).parts[0]
    return None


def test_folders_of_the_engine_are_the_ordered_ones():
    assert {p.name for p in SOURCES.iterdir() if p.is_dir()} <= set(ORDER)


def test_a_folder_includes_only_folders_before_it():
    back_edges = []
    for path in sources():
        own = path.relative_to(SOURCES).parts[0]
        for include in includes(path):
            reached = folder_of(include, path)
            if reached and ORDER.index(reached) > ORDER.index(own):
                back_edges.append(f"{path.relative_to(SOURCES)} includes {include}")
    assert not back_edges


FOLDER_TARGET = re.compile(r"^ajar_folder\((\w+)\s+SOURCES [^)]*?\sLINK ([^)]*)\)", re.MULTILINE)


def linked_folders():
    """Folder -> those that its CMake target links by itself."""
    text = (ROOT / "native" / "CMakeLists.txt").read_text(encoding="utf-8")
    return {
        name: {word[5:] for word in words.split() if word.startswith("ajar_") and word[5:] in ORDER}
        for name, words in FOLDER_TARGET.findall(text)
    }


def included_folders(folder):
    """Other folders that the files of one include."""
    reached = {
        folder_of(include, path) for path in (SOURCES / folder).iterdir() for include in includes(path)
    }
    return reached - {folder, None}


def test_a_folder_links_what_it_includes():
    assert linked_folders() == {name: included_folders(name) for name in ORDER}


def test_the_judge_shares_the_scene_and_the_rays_with_the_baker_and_nothing_else():
    """What judges the baker must not have the baker's faults."""
    links, reached, open_ends = linked_folders(), set(), ["reference"]
    while open_ends:
        for name in links[open_ends.pop()] - reached:
            reached.add(name)
            open_ends.append(name)
    assert reached == {"base", "scene", "accel"}
    baker = {name for name in ORDER if "reference" in included_folders(name)}
    assert baker == {"api"}, "nothing of the baker may lean on its judge"


@pytest.mark.parametrize("library", WRAPPED)
def test_a_library_is_included_only_by_its_wrapper(library):
    offenders = [
        f"{path.relative_to(SOURCES)} includes {include}"
        for path in sources()
        for include in includes(path)
        if include.startswith(library) and not str(path.relative_to(SOURCES)).startswith(WRAPPED[library])
    ]
    assert not offenders


def test_every_source_file_names_its_license():
    bare = [
        str(path.relative_to(ROOT))
        for path in project_files()
        if (path.suffix in WITH_LICENSE or path.name in LICENSED_NAMES)
        and "SPDX-License-Identifier: " not in path.read_text(encoding="utf-8")[:300]
    ]
    assert not bare


def test_no_file_is_longer_than_the_limit():
    long_files = []
    for path in project_files():
        if path.suffix in WITH_LICENSE or path.name in LICENSED_NAMES:
            lines = path.read_text(encoding="utf-8").count("\n")
            if lines > LIMIT:
                long_files.append(f"{path.relative_to(ROOT)}: {lines} lines")
    assert not long_files


@pytest.mark.parametrize(
    "compiler", [("gcc", "-std=c99", "-xc"), ("g++", "-std=c++11", "-xc++"), ("g++", "-std=c++20", "-xc++")]
)
def test_the_header_compiles_alone_as_c_and_cpp(compiler):
    command = [*compiler, "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only"]
    command += [f"-I{ROOT / 'native' / 'include'}", "-"]
    program = b'#include "ajar/ajar.h"\nint main(void) { return AJAR_OK; }\n'
    result = subprocess.run(command, input=program, capture_output=True)
    assert result.returncode == 0, result.stderr.decode()


def declared_functions(header=ROOT / "native" / "include" / "ajar" / "ajar.h", mark="AJAR_API"):
    text = header.read_text(encoding="utf-8")
    return set(re.findall(rf"^{mark} [\w\s*]*?\b(ajar_\w+)\(", text, re.MULTILINE))


def exported_symbols(library):
    listing = subprocess.run(
        ["nm", "-D", "--defined-only", library], capture_output=True, text=True, check=True
    )
    return {line.split()[-1].split("@")[0] for line in listing.stdout.splitlines()}


def test_the_library_exports_what_the_header_declares_and_nothing_else(library):
    assert exported_symbols(library) == declared_functions()


@pytest.mark.parametrize(
    "compiler", [("gcc", "-std=c99", "-xc"), ("g++", "-std=c++11", "-xc++"), ("g++", "-std=c++20", "-xc++")]
)
def test_the_runtime_header_compiles_alone_as_c_and_cpp(compiler):
    command = [*compiler, "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only"]
    command += [f"-I{RUNTIME / 'include'}", "-"]
    program = b'#include "ajar_runtime.h"\nint main(void) { return AJAR_RUNTIME_OK; }\n'
    result = subprocess.run(command, input=program, capture_output=True)
    assert result.returncode == 0, result.stderr.decode()


def test_the_runtime_exports_what_its_header_declares_and_nothing_else(runtime_library):
    header = RUNTIME / "include" / "ajar_runtime.h"
    assert exported_symbols(runtime_library) == declared_functions(header, "AJAR_RUNTIME_API")


def test_the_runtime_needs_the_standard_library_alone(runtime_library):
    own = {p.name for p in RUNTIME.rglob("*.h")}
    system = {"fcntl.h", "sys/mman.h", "sys/stat.h", "unistd.h", "stddef.h", "stdint.h"}
    offenders = [
        f"{path.name} includes {include}"
        for path in RUNTIME.rglob("*")
        if path.suffix in (".h", ".cpp")
        for include in includes(path)
        if include not in own | system and not re.fullmatch(r"[a-z_]+", include)
    ]
    assert not offenders
    needed = subprocess.run(["readelf", "-d", runtime_library], capture_output=True, text=True, check=True)
    libraries = set(re.findall(r"\(NEEDED\).*\[(\w+)", needed.stdout))
    assert libraries <= {"libstdc", "libm", "libgcc_s", "libc", "ld"}


def test_the_runtime_is_free_for_games():
    """Apache-2.0 in every file of it, and the licence's text beside them."""
    assert (RUNTIME / "LICENSE").read_bytes() == (ROOT / "schemas" / "LICENSE").read_bytes()
    for path in RUNTIME.rglob("*"):
        if path.is_file() and path.name != "LICENSE":
            assert "SPDX-License-Identifier: Apache-2.0" in path.read_text(encoding="utf-8")[:100], path


def test_the_addon_reaches_blender_only_where_it_may():
    """bridge/, accuracy/ and the data model run without Blender."""
    addon = ROOT / "blender_addon"
    free = [*addon.glob("bridge/**/*.py"), *addon.glob("accuracy/**/*.py"), addon / "model.py"]
    pattern = re.compile(r"^\s*(import|from)\s+(bpy|mathutils|bmesh)\b", re.MULTILINE)
    assert not [
        str(p.relative_to(ROOT))
        for p in free
        if p.is_file() and pattern.search(p.read_text(encoding="utf-8"))
    ]
