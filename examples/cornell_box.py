# SPDX-License-Identifier: GPL-3.0-or-later
"""The Cornell box from its published measurements, 1 unit = 1 cm.

    blender -b --factory-startup --python-exit-code 1 -P examples/cornell_box.py -- OUT.blend

Shows colour bleeding and soft shadows from one static area light.
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import scene_kit as kit

WHITE, RED, GREEN = (0.73, 0.73, 0.73), (0.63, 0.065, 0.05), (0.14, 0.45, 0.091)
FLOOR = [(552.8, 0, 0), (0, 0, 0), (0, 0, 559.2), (549.6, 0, 559.2)]
CEILING = [(556, 548.8, 0), (556, 548.8, 559.2), (0, 548.8, 559.2), (0, 548.8, 0)]
BACK = [(549.6, 0, 559.2), (0, 0, 559.2), (0, 548.8, 559.2), (556, 548.8, 559.2)]
RIGHT = [(0, 0, 559.2), (0, 0, 0), (0, 548.8, 0), (0, 548.8, 559.2)]
LEFT = [(552.8, 0, 0), (549.6, 0, 559.2), (556, 548.8, 559.2), (556, 548.8, 0)]
SHORT_BLOCK = (165, [(130, 65), (82, 225), (240, 272), (290, 114)])
TALL_BLOCK = (330, [(423, 247), (265, 296), (314, 456), (472, 406)])
LIGHT_RADIANCE = (17.0, 12.0, 4.0)  # W/(m^2 sr)
LIGHT_SIZE = (1.30, 1.05)  # m


def to_blender(point):
    """Measured x left, y up, z away, in cm, to metres with Z up."""
    x, y, z = point
    return ((278 - x) / 100, z / 100, y / 100)


def quad(name, corners, material):
    data = kit.mesh(name, [to_blender(c) for c in corners], [(0, 1, 2, 3)], [material])
    return kit.place(name, data)


def block(name, height, ring, material):
    low = [to_blender((x, 0, z)) for x, z in ring]
    high = [to_blender((x, height, z)) for x, z in ring]
    sides = [(i, (i + 1) % 4, (i + 1) % 4 + 4, i + 4) for i in range(4)]
    return kit.place(name, kit.mesh(name, low + high, sides + [(4, 5, 6, 7)], [material]))


def add_light():
    peak = max(LIGHT_RADIANCE)
    watts = peak * 4.0 * LIGHT_SIZE[0] * LIGHT_SIZE[1]  # Blender: radiance = watts / (4 area)
    color = tuple(c / peak for c in LIGHT_RADIANCE)
    kit.light(
        "Light",
        "AREA",
        to_blender((278, 548.3, 279.5)),
        watts,
        color,
        None,
        "STATIC",
        shape="RECTANGLE",
        size=LIGHT_SIZE[0],
        size_y=LIGHT_SIZE[1],
    )


def main():
    scene = kit.start()
    scene.name = "Cornell box"
    scene.render.resolution_x = scene.render.resolution_y = 512
    white, red, green = (kit.matte(n, c) for n, c in (("White", WHITE), ("Red", RED), ("Green", GREEN)))
    for name, corners, material in (
        ("Floor", FLOOR, white),
        ("Ceiling", CEILING, white),
        ("Back wall", BACK, white),
        ("Right wall", RIGHT, green),
        ("Left wall", LEFT, red),
    ):
        quad(name, corners, material)
    block("Short block", *SHORT_BLOCK, white)
    block("Tall block", *TALL_BLOCK, white)
    add_light()
    scene.camera = kit.camera("Camera", to_blender((278, 273, -800)), to_blender((278, 273, 0)), 35.0)
    scene.camera.data.sensor_width = 25.0
    kit.save("cornell_box.blend")


main()
