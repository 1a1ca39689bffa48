# SPDX-License-Identifier: GPL-3.0-or-later
"""Write a copy of a .blend made for exact comparison: every lamp static, every material plain diffuse.

    blender -b LEVEL.blend -P tests/blender/prepare_strict.py -- --out STRICT.blend
            [--keep-materials] [--keep-roles]
"""
import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from support import scene  # noqa: E402


def main():
    parser = scene.new_parser(__doc__)
    parser.add_argument('--out', required=True)
    parser.add_argument('--keep-materials', action='store_true')
    parser.add_argument('--keep-roles', action='store_true')
    args = scene.parse_arguments(parser)
    scene.register_addon()
    if not args.keep_materials:
        for material in scene.used_materials():
            scene.make_plain_diffuse(material)
    if not args.keep_roles:
        scene.set_light_roles('STATIC')
    bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(args.out), copy=True, relative_remap=True)


if __name__ == "__main__":
    main()
