# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's window from inside: steps on a timer, the pixels of the screen, mouse and buttons.

Positions are in Blender's window pixels, y upwards from the bottom row."""
import os
import subprocess
import sys
import time
import traceback

import bpy
import numpy as np

from .display import SCREEN
from .png import write_png

PAUSE = 0.04  # seconds that Blender gets to take an event and draw
ROW = 15  # pixels between looks for buttons; they are 20 high


def prepare():
    """No splash screen, and a mouse that stays where it is put."""
    bpy.context.preferences.view.show_splash = False
    bpy.context.preferences.inputs.use_mouse_continuous = False


def drive(steps):
    """Runs a generator between Blender's own events, then leaves with exit code 0, or 1 for an exception. It yields
    the seconds to wait."""

    def tick():
        try:
            return next(steps)
        except StopIteration:
            code = 0
        except BaseException:
            traceback.print_exc()
            write_png(os.path.join(os.environ["AJAR_TEST_DIR"], "failed.png"), screen())
            code = 1
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)  # Blender asks nothing and saves nothing

    bpy.app.timers.register(tick, first_interval=0.5, persistent=True)


def screen():
    """What is on the screen: (height, width, 3) of 0..1, bottom row first."""
    data = np.fromfile(os.environ[SCREEN], np.uint8)
    header = data[:100].view(">u4")
    start, width, height, line, colors = (int(header[k]) for k in (0, 4, 5, 12, 19))
    rows = data[start + 12 * colors :][: height * line].reshape(height, line)
    pixels = rows[:, : 4 * width].reshape(height, width, 4)
    return pixels[::-1, :, 2::-1] / 255.0


def window():
    """The window."""
    return bpy.context.window_manager.windows[0]


def area(kind):
    """The largest editor of a kind."""
    return max((a for a in window().screen.areas if a.type == kind), key=lambda a: a.width * a.height)


def region(owner, kind):
    """A region of an editor."""
    return next(r for r in owner.regions if r.type == kind)


def part(picture, place):
    """The pixels of a region or editor."""
    return picture[place.y : place.y + place.height, place.x : place.x + place.width]


def view_pixels(picture, editor):
    """The pixels of a 3D view that its tools, headers and sidebar leave free."""
    view, sidebar, tools, header = (region(editor, kind) for kind in ("WINDOW", "UI", "TOOLS", "TOOL_HEADER"))
    left = tools.x + tools.width if tools.width > 1 else view.x
    right = sidebar.x if sidebar.width > 1 else view.x + view.width
    return picture[view.y : header.y, left:right]


def settle(seconds=1.0, limit=120.0):
    """Waits until the screen has not changed for some seconds. Steps; returns the picture."""
    end, since, last = time.monotonic() + limit, time.monotonic(), screen()
    while time.monotonic() - since < seconds:
        if time.monotonic() > end:
            raise AssertionError(f"the window still changes after {limit:.0f} s")
        yield 0.1
        now = screen()
        if not np.array_equal(now, last):
            since, last = time.monotonic(), now
    return last


def wait_for(true, what, limit=120.0):
    """Waits until something holds. Steps."""
    end = time.monotonic() + limit
    while not true():
        assert time.monotonic() < end, f"no {what} within {limit:.0f} s"
        yield 0.1


def look_at(editor, camera):
    """Puts the view of a 3D view where a camera is, with its lens."""
    editor.spaces.active.region_3d.view_perspective = "PERSP"
    editor.spaces.active.region_3d.view_matrix = camera.matrix_world.inverted()
    editor.spaces.active.lens = camera.data.lens


def _mouse(*arguments):
    subprocess.run(["xdotool", *map(str, arguments)], check=True)


def move(x, y):
    """Moves the mouse."""
    _mouse("mousemove", round(x), round(window().height - 1 - y))


def last_tab(sidebar, turns=12):
    """Turns the wheel over the tabs of a sidebar down to the last, an add-on's. Steps."""
    move(sidebar.x + sidebar.width - 10, sidebar.y + sidebar.height - 20)
    for _ in range(turns):
        yield PAUSE
        _mouse("click", 5)
    yield PAUSE


def show_tab(camera):
    """The 3D view from a camera, bare, with the sidebar's last tab open. Steps; returns (editor, sidebar)."""
    editor = area("VIEW_3D")
    space = editor.spaces.active
    space.show_region_ui, space.overlay.show_overlays, space.show_gizmo = True, False, False
    yield 0.5
    look_at(editor, camera)
    sidebar = region(editor, "UI")
    yield from last_tab(sidebar)
    return editor, sidebar


def press(place):
    """Holds the left button down. Steps."""
    move(*place)
    yield PAUSE
    _mouse("mousedown", 1)
    yield PAUSE


def release():
    """Lets go of the button. Steps."""
    _mouse("mouseup", 1)
    yield PAUSE


def click(place):
    """Presses a button. Steps."""
    yield from press(place)
    yield from release()


def drag(place, pixels, moves=10):
    """Drags from a place sideways, in so many moves, and keeps the button down. Steps."""
    yield from press(place)
    for k in range(1, moves + 1):
        move(place[0] + pixels * k / moves, place[1])
        yield PAUSE


def find_buttons(editor, place, share=0.58):
    """Moves the mouse down a column of a region, at a share of its width, and asks Blender what is under it. Steps;
    returns {data path or Python command: (x, y) in the middle}."""
    found, x = {}, place.x + share * place.width
    for y in range(place.y + place.height - ROW, place.y, -ROW):
        move(x, y)
        yield PAUSE
        name = _under_mouse(editor, place)
        if name:
            found.setdefault(name, []).append(y)
    return {name: (x, sum(ys) / len(ys)) for name, ys in found.items()}


def _under_mouse(editor, place):
    manager = bpy.context.window_manager
    for copy in (bpy.ops.ui.copy_data_path_button, bpy.ops.ui.copy_python_command_button):
        manager.clipboard = ""
        with bpy.context.temp_override(window=window(), area=editor, region=place):
            if copy.poll():
                copy()
        if manager.clipboard:
            return manager.clipboard
    return ""
