# SPDX-License-Identifier: GPL-3.0-or-later
"""Render the preview of a bake and the original scene from the same places, side by side.

    blender -b DIR/NAME.blend -P tests/blender/render_views.py -- --original LEVEL.blend --out DIR
            [--views 3] [--samples 128] [--width 480] [--bounces 4] [--plain-diffuse] [--seed 1]
            [--exposure STOPS] [--camera x,y,z,dx,dy,dz ...] [--no-preview-toggle]

Left: preview (baked light, direct light of primary lamps). Right: full Cycles render of the original.
Both use the view transform Standard at one exposure. views.json holds the numbers of every view.
"""
import json
import math
import os
import sys

import bpy
import numpy as np
from mathutils import Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from support import cycles, exr, png, scene, viewpoints  # noqa: E402

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def parse():
    parser = scene.new_parser(__doc__)
    parser.add_argument('--original', required=True, help=".blend to render in full")
    parser.add_argument('--out', required=True)
    parser.add_argument('--views', type=int, default=3)
    parser.add_argument('--samples', type=int, default=128)
    parser.add_argument('--preview-samples', type=int, default=32)
    parser.add_argument('--width', type=int, default=480)
    parser.add_argument('--bounces', type=int, default=4)
    parser.add_argument('--seed', type=int, default=1, help="for the choice of views")
    parser.add_argument('--exposure', type=float, help="stops; default: chosen for each view")
    parser.add_argument('--camera', action='append', default=[], help="x,y,z,dx,dy,dz")
    parser.add_argument('--plain-diffuse', action='store_true', help="original with diffuse materials")
    parser.add_argument('--no-preview-toggle', action='store_true', help="take the file as it is")
    return scene.parse_arguments(parser)


def choose_views(args):
    """[(position, direction)] given or found."""
    if args.camera:
        numbers = [[float(v) for v in text.split(',')] for text in args.camera]
        return [(Vector(n[:3]), Vector(n[3:]).normalized()) for n in numbers]
    return viewpoints.find_views(args.views, args.seed)


def add_camera(position, direction):
    """Make a wide camera at a place the scene's camera."""
    data = bpy.data.cameras.new("AjarView")
    data.angle = math.radians(80)
    data.clip_start, data.clip_end = 0.01, 1e5
    camera = bpy.data.objects.new("AjarView", data)
    bpy.context.scene.collection.objects.link(camera)
    camera.location = position
    camera.rotation_mode = 'QUATERNION'
    camera.rotation_quaternion = direction.to_track_quat('-Z', 'Y')
    bpy.context.scene.camera = camera
    return camera


def render(path, width, samples, bounces):
    """Render the scene camera with Cycles to linear RGB (bottom row first)."""
    target = bpy.context.scene
    cycles.setup(samples, bounces)
    target.cycles.transparent_max_bounces = 32
    target.render.resolution_x, target.render.resolution_y = width, width * 9 // 16
    target.render.resolution_percentage = 100
    target.render.use_compositing = target.render.use_sequencer = False
    target.render.film_transparent = False
    settings = target.render.image_settings
    settings.file_format, settings.color_depth, settings.exr_codec = 'OPEN_EXR', '32', 'ZIP'
    target.render.filepath = path
    bpy.ops.render.render(write_still=True)
    return exr.read_rgb(path)


def render_all(views, prefix, args, samples, bounces):
    """Linear pictures of every view of the open file."""
    pictures = []
    for number, (position, direction) in enumerate(views):
        add_camera(position, direction)
        pictures.append(render(f"{prefix}{number}.exr", args.width, samples, bounces))
    return pictures


def compare(preview, original):
    """Brightness and colour ratios: plain means, and means with the brightest 1% clipped."""
    limit = np.percentile(original @ LUMINANCE, 99)
    clip = lambda picture: np.minimum(picture, limit)  # noqa: E731
    ratio = lambda a, b: (a.mean((0, 1)) / np.maximum(b.mean((0, 1)), 1e-9)).tolist()  # noqa: E731
    return {
        'ratio_rgb': ratio(preview, original),
        'ratio_rgb_clipped': ratio(clip(preview), clip(original)),
        'ratio_luminance_clipped': float(
            (clip(preview) @ LUMINANCE).mean() / (clip(original) @ LUMINANCE).mean()
        ),
        'median_ratio': float(np.median(preview @ LUMINANCE) / max(np.median(original @ LUMINANCE), 1e-9)),
        'blocks': block_ratios(preview, original),
    }


def block_ratios(preview, original, size=30):
    """5th, 50th and 95th percentile of the luminance ratio of blocks: local disagreement."""
    height, width = (n // size * size for n in preview.shape[:2])

    def means(picture):
        cut = (picture @ LUMINANCE)[:height, :width]
        return cut.reshape(height // size, size, width // size, size).mean((1, 3))

    a, b = means(preview), means(original)
    lit = b > 0.02 * b.mean()
    return np.percentile(a[lit] / b[lit], [5, 50, 95]).tolist()


def save_pair(path, preview, original, exposure):
    """Side by side PNG; returns the exposure used, in stops."""
    if exposure is None:
        exposure = math.log2(0.35 / max(np.percentile(original @ LUMINANCE, 70), 1e-6))
    gap = np.ones((preview.shape[0], 4, 3))
    pair = [png.srgb(preview * 2**exposure), gap, png.srgb(original * 2**exposure)]
    png.write_png(path, np.concatenate(pair, axis=1))
    return exposure


def show_preview():
    """Turn the preview on if the file does not show it."""
    scene.register_addon()
    if not bpy.context.scene.ajar.preview:
        bpy.ops.ajar.preview_toggle()


def main():
    args = parse()
    os.makedirs(args.out, exist_ok=True)
    if not args.no_preview_toggle:
        show_preview()
    views = choose_views(args)
    previews = render_all(views, os.path.join(args.out, "preview_"), args, args.preview_samples, 0)
    bpy.ops.wm.open_mainfile(filepath=os.path.abspath(args.original))
    if args.plain_diffuse:
        for material in scene.used_materials():
            scene.make_plain_diffuse(material)
    originals = render_all(views, os.path.join(args.out, "original_"), args, args.samples, args.bounces)
    report = []
    for number, (preview, original) in enumerate(zip(previews, originals)):
        row = compare(preview, original)
        row['camera'] = [round(v, 4) for v in (*views[number][0], *views[number][1])]
        row['exposure'] = save_pair(
            os.path.join(args.out, f"view_{number}.png"), preview, original, args.exposure
        )
        report.append(row)
        print(f"view {number}: " + json.dumps(row), flush=True)
    with open(os.path.join(args.out, "views.json"), 'w', encoding='utf-8') as file:
        json.dump(report, file, indent=1)


if __name__ == "__main__":
    main()
