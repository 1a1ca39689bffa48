# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders one view of an example with Cycles.

    blender -b FILE.blend --python-exit-code 1 -P examples/picture.py -- --mode MODE --out PICTURE.png
        [--camera NAME] [--size WIDTH HEIGHT] [--samples N]

before     what a game shows without a bake: the direct light of primary lights, nothing else
after      a baked file: baked light, and the direct light of primary lights
reference  everything path traced
"""
import argparse
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import bpy
import scene_kit as kit


def parse():
    parser = argparse.ArgumentParser(prog="picture.py")
    parser.add_argument("--mode", choices=("before", "after", "reference"), required=True)
    parser.add_argument("--out", required=True)
    parser.add_argument("--camera", default="")
    parser.add_argument("--size", type=int, nargs=2, default=(960, 540))
    parser.add_argument("--samples", type=int, default=32)
    return parser.parse_args(kit.arguments())


def direct_light_only(scene):
    scene.cycles.max_bounces = 0
    scene.cycles.transparent_max_bounces = 16


def emits(item):
    trees = [s.material.node_tree for s in item.material_slots if s.material and s.material.node_tree]
    return any(node.type == "EMISSION" for tree in trees for node in tree.nodes)


def without_bake(scene):
    """Leaves only what a game would light with at run time."""
    for item in scene.objects:
        if item.type == "LIGHT":
            item.hide_render = (
                item.hide_render or getattr(getattr(item, "ajar", None), "light_role", "PRIMARY") != "PRIMARY"
            )
        elif emits(item):
            item.visible_diffuse = item.visible_glossy = False
    if scene.world:
        scene.world.cycles_visibility.diffuse = scene.world.cycles_visibility.glossy = False


def main():
    options = parse()
    kit.register_addon()
    scene = bpy.context.scene
    if options.camera:
        scene.camera = scene.objects[options.camera]
    if options.mode != "reference":
        direct_light_only(scene)
    if options.mode == "before":
        without_bake(scene)
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising = options.samples, False
    scene.cycles.use_adaptive_sampling = False
    scene.render.resolution_x, scene.render.resolution_y = options.size
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "PNG"
    scene.render.filepath = os.path.abspath(options.out)
    bpy.ops.render.render(write_still=True)


main()
