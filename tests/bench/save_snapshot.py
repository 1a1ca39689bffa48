# SPDX-License-Identifier: GPL-3.0-or-later
"""Write what a bake of a .blend hands to the engine, without baking it.

    blender -b LEVEL.blend -P tests/bench/save_snapshot.py -- --out DIR [--density 8] [--bounces 4] [--blend FILE]

Leaves DIR/snapshot/snapshot.json and .bin; with --blend also a copy of the file with its lightmap UVs, and
DIR/layout.json with what a manifest would say of pages and placements.
"""
import json
import os
import sys
import time

import bpy

TESTS = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(TESTS, "blender"))
from support import scene  # noqa: E402


def parse():
    parser = scene.new_parser(__doc__)
    parser.add_argument('--out', required=True)
    parser.add_argument('--density', type=float, help="texels per metre; default: the scene's")
    parser.add_argument('--bounces', type=int, help="default: the scene's")
    parser.add_argument('--blend', help="also save a copy with its lightmap UVs here")
    return scene.parse_arguments(parser)


def export(folder, overrides):
    """Run the add-on's own layout, then its extraction; returns the layout."""
    from blender_addon import job, settings
    from blender_addon.extract import snapshot

    results = []

    def steps(running):
        layout = yield from job.layout_steps(running, overrides=overrides)
        wanted = settings.engine_settings(bpy.context.scene, overrides)
        snapshot.write_snapshot(bpy.context, folder, wanted, layout)
        results.append(layout)

    task = job.Job("Snapshot", bpy.context, steps)
    while task.step():
        time.sleep(0.02)
    if task.status.result != "done":
        sys.exit(f"the scene could not be exported: {task.status.message}")
    return results[0]


def main():
    args = parse()
    scene.restore_original()
    overrides = {'texels_per_meter': args.density, 'bounces': args.bounces}
    os.makedirs(args.out, exist_ok=True)
    with open(os.path.join(args.out, "density"), 'w', encoding='utf-8') as file:
        file.write(repr(args.density or bpy.context.scene.ajar.texels_per_meter))
    layout = export(os.path.join(args.out, "snapshot"), {k: v for k, v in overrides.items() if v is not None})
    if args.blend:
        with open(os.path.join(args.out, "layout.json"), 'w', encoding='utf-8') as file:
            json.dump(layout, file)
        bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(args.blend), copy=True, relative_remap=True)


if __name__ == "__main__":
    main()
