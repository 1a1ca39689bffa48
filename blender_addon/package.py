# SPDX-License-Identifier: GPL-3.0-or-later
"""Zips the add-on with the engine library: python3 blender_addon/package.py OUT.zip [--library PATH]

The zip installs in Blender 3.4 to 4.1 (Preferences > Add-ons > Install) and, having a manifest, as
an extension from 4.2 on (needs --extension: the manifest then lies at the top of the zip).
"""
import argparse
import sys
import zipfile
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
NAME = "ajar"
LIBRARY = FOLDER.parent / "build" / "release" / "lib" / "libajar.so"
_LEFT_OUT = {"package.py"}
_KINDS = {".py", ".toml"}
_EPOCH = (1980, 1, 1, 0, 0, 0)  # the same files give the same zip


def files():
    """Files of the add-on, relative to its folder, in a fixed order."""
    return sorted(path.relative_to(FOLDER) for path in FOLDER.rglob("*")
                  if path.suffix in _KINDS and path.name not in _LEFT_OUT and "__pycache__" not in path.parts)


def write_zip(target, library, extension=False):
    """Writes the zip; the library goes to lib/ in it."""
    top = "" if extension else f"{NAME}/"
    target.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in files():
            _add(archive, top + path.as_posix(), FOLDER / path, 0o644)
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
    parser.add_argument("--library", type=Path, default=LIBRARY)
    parser.add_argument("--extension", action="store_true", help="lay it out as an extension (Blender 4.2+)")
    options = parser.parse_args()
    if not options.library.is_file():
        print(f"{options.library} is missing: build the engine first", file=sys.stderr)
        return 1
    write_zip(options.target, options.library, options.extension)
    print(options.target)
    return 0


if __name__ == "__main__":
    sys.exit(main())
