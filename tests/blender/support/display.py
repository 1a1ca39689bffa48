# SPDX-License-Identifier: GPL-3.0-or-later
"""A screen in memory, for Blender with its window (no bpy here).

Xvfb keeps what it shows in a file, so that tests read pixels as a person would see them."""
import contextlib
import os
import shutil
import subprocess

PROGRAMS = ("Xvfb", "xdotool")  # Debian's packages xvfb and xdotool
SCREEN = "AJAR_SCREEN"  # environment variable: the file of the screen


def missing():
    """What has to be installed first, as a sentence, or ''."""
    lacking = [name for name in PROGRAMS if shutil.which(name) is None]
    return f"{' and '.join(lacking)} not found: apt install xvfb xdotool" if lacking else ""


@contextlib.contextmanager
def display(folder, size):
    """Environment variables for programs whose windows appear on a screen of this size (width, height)."""
    read, write = os.pipe()
    command = ["Xvfb", "-displayfd", str(write), "-screen", "0", "{}x{}x24".format(*size)]
    command += ["-fbdir", str(folder), "-nolisten", "tcp", "-noreset"]
    server = subprocess.Popen(command, pass_fds=[write], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    os.close(write)
    try:
        with os.fdopen(read) as numbers:
            number = numbers.readline().strip()
        if not number:
            raise RuntimeError("Xvfb did not start")
        yield {
            "DISPLAY": f":{number}",
            SCREEN: os.path.join(folder, "Xvfb_screen0"),
            "LIBGL_ALWAYS_SOFTWARE": "1",
        }
    finally:
        server.terminate()
        server.wait()


def blender_arguments(size):
    """Arguments that make Blender's window fill the screen."""
    return ["--window-geometry", "0", "0", *map(str, size)]
