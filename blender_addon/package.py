# SPDX-License-Identifier: GPL-3.0-or-later
"""Zips the add-on with its libraries: python3 blender_addon/package.py OUT.zip [--library PATH] [--runtime PATH]

The zip installs in Blender 3.4 to 4.1 (Preferences > Add-ons > Install) and, having a manifest, as
an extension from 4.2 on (needs --extension: the manifest then lies at the top of the zip).
"""
import argparse
import sys
import zipfile
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
NAME = "ajar"
_BUILT = FOLDER.parent / "build" / "release" / "lib"
LIBRARY, RUNTIME = _BUILT / "libajar.so", _BUILT / "libajar_runtime.so"
_LEFT_OUT = {"package.py"}
_KINDS = {".py", ".toml"}
_EPOCH = (1980, 1, 1, 0, 0, 0)  # the same files give the same zip


def files():
    """Files of the add-on, relative to its folder, in a fixed order."""
    return sorted(
        path.relative_to(FOLDER)
        for path in FOLDER.rglob("*")
        if path.suffix in _KINDS and path.name not in _LEFT_OUT and "__pycache__" not in path.parts
    )


def write_zip(target, libraries, extension=False):
    """Writes the zip; the libraries go to lib/ in it."""
    top = "" if extension else f"{NAME}/"
    target.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in files():
            _add(archive, top + path.as_posix(), FOLDER / path, 0o644)
        for library in libraries:
            _add(archive, f"{top}lib/{library.name}", library, 0o755)


def _add(archive, name, path, mode):
    entry = zipfile.ZipInfo(name, _EPOCH)
    entry.compress_type = zipfile.ZIP_DEFLATED
    entry.external_attr = mode << 16
    archive.writestr(entry, path.read_bytes())


def main():
    """Entry point; returns the exit code."""
    parser = argparse.ArgumentParser(description="Zip the Ajar add-on")
    parser.add_argument("target", type=Path)
    parser.add_argument("--library", type=Path, default=LIBRARY, help="the engine")
    parser.add_argument(
        "--runtime", type=Path, default=RUNTIME, help="the run-time library, for the live preview"
    )
    parser.add_argument("--extension", action="store_true", help="lay it out as an extension (Blender 4.2+)")
    options = parser.parse_args()
    libraries = [options.library, options.runtime]
    for library in libraries:
        if not library.is_file():
            print(f"{library} is missing: build it first", file=sys.stderr)
            return 1
    write_zip(options.target, libraries, options.extension)
    print(options.target)
    return 0


if __name__ == "__main__":
    sys.exit(main())
