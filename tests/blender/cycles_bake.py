# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake reference irradiance with Cycles onto the lightmap UVs of a finished Ajar bake.

    blender -b DIR/NAME.blend -P tests/blender/cycles_bake.py -- --package DIR/package --out REF.npz
            [--samples 1024] [--repeats 8] [--bounces 4] [--seed 1] [--plain-diffuse]
            [--without-direct PRIMARY] [--fraction 1] [--threads N]

All lightmapped objects are merged, so each repeat is one bake. The samples are split over repeats
with different seeds; their spread gives every texel's standard error. First hits are shaded plain
white diffuse, so the result is irradiance whatever the material. Arrays per page P, bottom row
first: P_mean, P_stderr (RGB, W/m^2), P_valid, P_position, P_normal, P_object, P_material, P_overlap,
P_back (share of rays that meet back faces), P_coincident; 'meta' is JSON with the names behind the indices.
"""
import json
import os
import sys
import time

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from support import cycles, merge, scene, surroundings, texels  # noqa: E402


def parse():
    parser = scene.new_parser(__doc__)
    parser.add_argument('--package', required=True, help="package folder of the Ajar bake")
    parser.add_argument('--out', required=True, help=".npz to write")
    parser.add_argument('--samples', type=int, default=1024, help="per texel, over all repeats")
    parser.add_argument('--repeats', type=int, default=8, help="independent bakes, at least 2")
    parser.add_argument('--bounces', type=int, default=4)
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--threads', type=int, default=0)
    parser.add_argument('--plain-diffuse', action='store_true', help="Principled becomes Diffuse")
    parser.add_argument(
        '--fraction',
        type=float,
        default=1.0,
        help="bake a random share of all polygons only: fewer texels, each of them better",
    )
    parser.add_argument(
        '--without-direct',
        nargs='*',
        default=[],
        metavar='ROLE',
        help="leave out the direct light of lamps with these roles",
    )
    return scene.parse_arguments(parser)


class BakeMaterials:
    """Copies of materials, one for each (material, page, group), with their bake image."""

    def __init__(self, pages):
        self.pages, self.copies, self.images = pages, {}, {}
        self.default = cycles.diffuse_material("AjarDefault")

    def find(self, group):
        """Function (material, page) -> copy that bakes to the group's image of that page."""
        return lambda material, page: self._copy(material or self.default, page, group)

    def _copy(self, material, page, group):
        key = (material.name, page, group)
        if key not in self.copies:
            copy = material.copy()
            if not copy.use_nodes:
                copy.use_nodes = True
            scene.make_camera_white(copy)
            cycles.set_bake_target(copy, self._image(page, group))
            self.copies[key] = copy
        return self.copies[key]

    def _image(self, page, group):
        if (page, group) not in self.images:
            size = self.pages[page]
            self.images[page, group] = cycles.float_image(
                f"page{page}.{group}", size['width'], size['height']
            )
        return self.images[page, group]


def merge_receivers(pieces, materials):
    """Replace the pieces by merged objects; returns those."""
    objects = []
    for number, group in enumerate(merge.group_pieces(pieces)):
        objects.append(merge.build_object(group, materials.find(number), f"AjarMerged{number}"))
    merge.hide_originals(pieces)
    bpy.context.view_layer.update()
    return objects


def map_texels(pieces, pages):
    """(texel maps, object names, material names)."""
    maps = [texels.TexelMap(page['width'], page['height']) for page in pages]
    names = []
    for index, piece in enumerate(pieces):
        table = []
        for material in piece.materials:
            name = material.name if material else "(none)"
            if name not in names:
                names.append(name)
            table.append(names.index(name))
        texels.rasterize_piece(piece, index, table, maps)
    return maps, [piece.name for piece in pieces], names


class Statistics:
    """Mean and standard error of each page over repeats, in W/m^2."""

    def __init__(self, pages):
        shapes = [(page['height'], page['width']) for page in pages]
        self.count = 0
        self.mean = [np.zeros((*shape, 3)) for shape in shapes]
        self.m2 = [np.zeros((*shape, 3)) for shape in shapes]
        self.valid = [np.zeros(shape, bool) for shape in shapes]

    def add(self, materials):
        """Add the images as they are baked now."""
        self.count += 1
        values = [np.zeros_like(mean) for mean in self.mean]
        for (page, _), image in materials.images.items():
            mask = cycles.read_image(image)[..., 3] > 0
            values[page][mask] = cycles.irradiance(image)[mask]
            self.valid[page] |= mask
        for page, value in enumerate(values):
            delta = value - self.mean[page]
            self.mean[page] += delta / self.count
            self.m2[page] += delta * (value - self.mean[page])

    def variance(self, page):
        """Variance of the mean."""
        return self.m2[page] / max(self.count - 1, 1) / self.count


def bake_repeats(objects, materials, args, bounces, passes):
    """Bake every object `repeats` times with fresh seeds."""
    statistics = Statistics(materials.pages)
    samples = max(1, args.samples // args.repeats)
    for repeat in range(args.repeats):
        begin = time.time()
        cycles.setup(samples, bounces, args.seed + repeat * 7919, args.threads)
        for obj in objects:
            cycles.bake_irradiance([obj], passes, merge.PAGE_UV)
        statistics.add(materials)
        print(
            f"cycles bake {repeat + 1}/{args.repeats}: {samples} samples, {time.time() - begin:.1f} s",
            flush=True,
        )
    return statistics


def bake_lamp_direct(objects, materials, args):
    """Direct light of the lamps with the excluded roles alone."""
    excluded = scene.lamps([role.upper() for role in args.without_direct])
    scene.switch_off_emission()
    for lamp in scene.lamps():
        lamp.hide_render = lamp.hide_render or lamp not in excluded
    return bake_repeats(objects, materials, args, 0, ('DIRECT',))


def save(path, pages, total, minus, maps, meta):
    """Write all arrays of all pages."""
    arrays = {'meta': json.dumps(meta)}
    for page in range(len(pages)):
        mean, variance = total.mean[page], total.variance(page)
        if minus is not None:
            mean, variance = mean - minus.mean[page], variance + minus.variance(page)
        arrays[f'{page}_mean'] = mean.astype(np.float32)
        arrays[f'{page}_stderr'] = np.sqrt(variance).astype(np.float32)
        arrays[f'{page}_valid'] = total.valid[page]
        for name in ('position', 'normal', 'object', 'material', 'overlap', 'back', 'coincident'):
            arrays[f'{page}_{name}'] = getattr(maps[page], name)
    np.savez(path, **arrays)


def apply_roles():
    """A lamp with role OFF gives no light."""
    for lamp in scene.lamps(['OFF']):
        lamp.hide_render = True
    world = bpy.context.scene.world
    if world is not None and world.ajar.sky_role == 'OFF':
        bpy.context.scene.world = None


def main():
    args = parse()
    scene.restore_original()
    apply_roles()
    with open(os.path.join(args.package, "manifest.json"), encoding="utf-8") as file:
        manifest = json.load(file)
    if args.plain_diffuse:
        for material in scene.used_materials():
            scene.make_plain_diffuse(material)
    pages = manifest['pages']
    pieces = merge.read_pieces(manifest['instances'])
    maps, objects, names = map_texels(pieces, pages)
    for number, piece in enumerate(pieces):
        piece.keep_share(args.fraction, number)
    materials = BakeMaterials(pages)
    merged = merge_receivers(pieces, materials)
    begin = time.time()
    total = bake_repeats(merged, materials, args, args.bounces, ('DIRECT', 'INDIRECT'))
    seconds = time.time() - begin
    minus = bake_lamp_direct(merged, materials, args) if args.without_direct else None
    surroundings.examine(pieces, maps, total.valid)
    save(
        args.out,
        pages,
        total,
        minus,
        maps,
        {
            'objects': objects,
            'materials': names,
            'samples': args.samples,
            'repeats': args.repeats,
            'bounces': args.bounces,
            'seconds': seconds,
            'pages': len(pages),
        },
    )
    print(f"wrote {args.out} after {seconds:.1f} s of baking")


if __name__ == "__main__":
    main()
