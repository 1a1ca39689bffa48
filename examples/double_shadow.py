# SPDX-License-Identifier: GPL-3.0-or-later
"""Two toggles whose shadows from one lamp overlap, on a floor that a second lamp lights from the other side.

    blender -b --factory-startup --python-exit-code 1 -P examples/double_shadow.py -- double_shadow.blend [--fixed]

The case that "Semi-Dynamic Light Maps" gives as its limit (figure 17). --fixed leaves the boxes untagged: a
bake of that file is what both boxes together really do.
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import scene_kit as kit  # noqa: E402

FLOOR = [(-3, -3, 0), (3, -3, 0), (3, 3, 0), (-3, 3, 0)]


def lamp(name, place, energy, color):
    kit.light(
        name, "SPOT", place, energy, color, (0, 0, 0), light_set=name, spot_size=1.2, shadow_soft_size=0.05
    )


def build(fixed=False):
    """The scene; fixed: without toggles."""
    kit.start()
    kit.pane("Floor", FLOOR, kit.matte("Floor", (0.7, 0.7, 0.7)))
    boxes = (
        kit.box("Box A", (-1.3, -0.8, 0.0), (-1.1, 0.8, 1.2), kit.matte("Red", (0.8, 0.3, 0.2))),
        kit.box("Box B", (-0.5, -0.4, 0.0), (-0.3, 1.2, 1.2), kit.matte("Blue", (0.2, 0.4, 0.8))),
    )
    for obj in boxes if not fixed else ():
        kit.tag(obj, movable="TOGGLE")
    kit.light_sets("P", "Q")
    lamp("P", (-3.5, 0.0, 3.2), 400.0, (1.0, 0.8, 0.5))
    lamp("Q", (3.5, 0.0, 3.2), 200.0, (0.5, 0.7, 1.0))


if __name__ == "__main__":
    build("--fixed" in kit.arguments())
    kit.save("double_shadow.blend")
