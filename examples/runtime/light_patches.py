# SPDX-License-Identifier: Apache-2.0
"""The run time of "Semi-Dynamic Light Maps" (algorithms 5 to 9) on a package that holds light patches.

    python3 light_patches.py PACKAGE [NAME=VALUE ...] [--out PAGE.png]

NAME is a light (VALUE: its intensity) or an object (VALUE: 1 in its place, 0 away; a door in its place is
closed). Lists the maps, and writes the first page as it looks in that state. Needs numpy alone.

A map says what a light adds while every object is away, or what one object takes from that light. Objects
are taken off one by one: where the shadows of two overlap, the light is taken twice. That is the limit of
this layout; terms.bin and the run-time library have none.
"""
import argparse
import json
import struct
import zlib
from pathlib import Path

import numpy as np

DDS_HEADER_BYTES = 148


class LightPatches:
    """patches.json and its atlases. Images are [height][width][3] in W/m^2, top row first."""

    def __init__(self, package):
        folder = Path(package)
        about = json.loads((folder / "patches.json").read_text(encoding="utf-8"))
        self.pages = [(p["height"], p["width"]) for p in about["pages"]]
        self.lights = {light["name"]: light["intensity"] for light in about["lights"]}
        self.objects = {obj["name"]: obj["presence"] for obj in about["objects"]}
        self.maps = {(m["light"], m["object"]): m for m in about["maps"]}
        self.atlases = [self._read(folder / a["file"], a["width"], a["height"]) for a in about["atlases"]]

    @staticmethod
    def _read(path, width, height):
        halves = np.frombuffer(path.read_bytes(), "<f2", offset=DDS_HEADER_BYTES)
        return halves.reshape(height, width, 4).astype(np.float32)

    def map(self, page, light, obj=None):
        """Algorithms 5 and 6: a map put together from its patches. light None: what no set holds."""
        image = np.zeros((*self.pages[page], 3), np.float32)
        stored = self.maps.get((light, obj), {"patches": ()})
        for p in stored["patches"]:
            if p["page"] != page:
                continue
            rows, columns = (
                slice(p[k], p[k] + p[n]) for k, n in (("atlas_y", "height"), ("atlas_x", "width"))
            )
            patch = self.atlases[p["atlas"]][rows, columns, p["channel"]] * stored["scale"]
            target = image[p["page_y"] : p["page_y"] + p["height"], p["page_x"] : p["page_x"] + p["width"]]
            if stored["planes"] == 1:
                target[:] = patch[..., None] * np.asarray(stored["color"], np.float32)
            else:
                target[..., p["plane"]] = patch
        return image

    def shadowed(self, page, light, presence):
        """Section 3.3.3: what a light adds, less what each object in its place takes from it."""
        image = self.map(page, light)
        for obj, present in presence.items():
            if present:
                image -= present * self.map(page, light, obj)
        return image

    def light_map(self, page, intensity, presence):
        """Algorithm 7: the page in one state. Objects whose shadows overlap can leave less than nothing."""
        image = self.shadowed(page, None, presence)
        for light, strength in intensity.items():
            image += strength * self.shadowed(page, light, presence)
        return image

    def moved_object(self, image, page, intensity, before, after):
        """Algorithm 8: brings a page from one state of the objects to another, light by light."""
        for light, strength in ((None, 1.0), *intensity.items()):
            image = image - strength * self.shadowed(page, light, before)
            image = image + strength * self.shadowed(page, light, after)
        return image

    def changed_light(self, image, page, light, change, presence):
        """Algorithm 9: adds change (new less old intensity, a number or an RGB colour) of one light."""
        return image + np.asarray(change, np.float32) * self.shadowed(page, light, presence)


def to_bytes(image, white):
    """sRGB bytes of an image; white W/m^2 becomes white."""
    x = np.clip(image / white, 0.0, 1.0)
    return (255.0 * np.where(x < 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055) + 0.5).astype(np.uint8)


def write_png(path, pixels):
    """Writes [height][width][3] bytes."""
    rows = np.pad(pixels.reshape(pixels.shape[0], -1), ((0, 0), (1, 0)))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", pixels.shape[1], pixels.shape[0], 8, 2, 0, 0, 0)
    chunks = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows.tobytes(), 9)) + chunk(b"IEND", b"")
    Path(path).write_bytes(b"\x89PNG\r\n\x1a\n" + chunks)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("package")
    parser.add_argument("states", nargs="*", metavar="NAME=VALUE")
    parser.add_argument("--out", metavar="PNG", help="picture of the first page")
    options = parser.parse_args()
    patches = LightPatches(options.package)
    for (light, obj), stored in patches.maps.items():
        texels = sum(p["width"] * p["height"] for p in stored["patches"])
        kind = f"taken from it by {obj}" if obj else "its light"
        print(f"{light or 'always on'}: {kind}, {len(stored['patches'])} patches, {texels} texels")
    for name, value in (state.rsplit("=", 1) for state in options.states):
        known = patches.lights if name in patches.lights else patches.objects
        if name not in known:
            parser.error(f"the package has no light or object {name!r}")
        known[name] = float(value)
    if options.out:
        page = patches.light_map(0, patches.lights, patches.objects)
        write_png(options.out, to_bytes(page, np.percentile(page, 99.5)))
        print(options.out)


if __name__ == "__main__":
    main()
