# SPDX-License-Identifier: GPL-3.0-or-later
# window: 960x880
# timeout: 600
"""In Blender's window: Bake is pressed, then sliders of the Ajar tab are dragged with the mouse; the viewport
shows each change, and nothing else goes dark."""
import os
import sys

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(os.environ["AJAR_ROOT"], "examples"))
import scene_kit as kit  # noqa: E402
from support import png, window  # noqa: E402

from ajar import job  # noqa: E402

FOLDER = os.environ["AJAR_TEST_DIR"]
BLACK = 0.02  # mean of what is black to the eye
WEIGHT = "ajar.light_sets[0].weight"
SEEN = 0.1  # mean change of the viewport, of 0..1, that nobody overlooks


def build():
    """A room with a lamp in a light set, and behind a closed door a room with a red lamp."""
    scene = bpy.context.scene
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    white, green = kit.matte("White", (0.8, 0.8, 0.8)), kit.matte("Green", (0.2, 0.5, 0.25))
    kit.box("Floor", (-2, 0, -0.1), (2, 6, 0), white)
    kit.box("Ceiling", (-2, 0, 2.5), (2, 6, 2.6), white)
    for name, low, high in (
        ("West", (-2.1, 0, 0), (-2, 6, 2.5)),
        ("East", (2, 0, 0), (2.1, 6, 2.5)),
        ("Near", (-2, -0.1, 0), (2, 0, 2.5)),
        ("Far", (-2, 6, 0), (2, 6.1, 2.5)),
    ):
        kit.box(name, low, high, white)
    kit.wall("Partition", 1, (3.0, 3.3), (-2, 2), (0, 2.5), [(-1.0, 1.0, 0.0, 2.2)], [white] * 3)
    leaf = kit.box("Door", (-1.0, 3.1, 0.0), (1.0, 3.2, 2.2), green)
    kit.tag(leaf, movable="DOOR")
    kit.light_sets("Lamps")
    kit.light("Lamp", "POINT", (0.6, 1.0, 2.0), 15.0, light_set="Lamps", shadow_soft_size=0.1)
    kit.light("Red lamp", "POINT", (0, 4.5, 2.0), 60.0, (1, 0.1, 0.05), shadow_soft_size=0.1)
    kit.tag(scene, preset="DRAFT", texels_per_meter=4.0, output_dir=FOLDER)
    scene.view_settings.view_transform = "Standard"
    scene.render.engine = "CYCLES"
    scene.cycles.preview_samples = 1
    bpy.context.view_layer.objects.active = leaf
    return kit.camera("View", (0, 0.3, 1.5), (0, 3, 1.1), 18.0)


def bake(editor, sidebar):
    """Presses Bake and waits for the end. Steps."""
    buttons = yield from window.find_buttons(editor, sidebar)
    yield from window.click(buttons["bpy.ops.ajar.bake()"])
    yield from window.wait_for(lambda: job.manager.running, "bake")
    yield from window.wait_for(lambda: not job.manager.running, "end of the bake", 300.0)
    assert job.manager.last.result == "done", job.manager.last.message
    assert bpy.context.scene.ajar.preview


def drag(name, place, pixels, editor):
    """Drags a slider; the view follows while the button is still down. Steps; returns the pictures."""
    before = yield from window.settle()
    yield from window.drag(place, pixels)
    change = lambda: np.abs(window.view_pixels(window.screen() - before, editor)).mean()  # noqa: E731
    yield from window.wait_for(lambda: change() > SEEN, f"change of the view by {name}", 30)
    yield from window.release()
    after = yield from window.settle()
    assert change() > SEEN, f"{name}: the view went back"
    check_rest(name, before, after, editor)
    png.write_png(os.path.join(FOLDER, f"{name} before.png"), before)
    png.write_png(os.path.join(FOLDER, f"{name} after.png"), after)
    return [window.view_pixels(picture, editor).mean(axis=(0, 1)) for picture in (before, after)]


def check_rest(name, before, after, editor):
    """Every other editor keeps its light; so does the sidebar, though the view shines through it."""
    sidebar = window.region(editor, "UI")
    for place in [a for a in window.window().screen.areas if a != editor] + [sidebar]:
        first, second = (window.part(picture, place).mean() for picture in (before, after))
        kept = 0.5 if place == sidebar else 0.9
        assert first > BLACK and second > kept * first, (name, place.type, first, second)


def steps():
    """The test."""
    editor, sidebar = yield from window.show_tab(build())
    yield from bake(editor, sidebar)
    editor.spaces.active.shading.type = "RENDERED"
    yield from window.settle()
    buttons = yield from window.find_buttons(editor, sidebar)
    weight = bpy.context.scene.ajar.light_sets["Lamps"]
    lit, dark = yield from drag("weight", buttons[WEIGHT], -250, editor)
    assert weight.weight < 0.3 and dark.mean() < 0.5 * lit.mean(), (weight.weight, lit, dark)
    leaf = bpy.data.objects["Door"]
    closed, opened = yield from drag("openness", buttons["ajar.openness"], 250, editor)
    assert leaf.ajar.openness > 0.3, leaf.ajar.openness
    assert opened[0] > 2.0 * closed[0], ("no red light through the door", closed, opened)


window.prepare()
window.drive(steps())
