# SPDX-License-Identifier: GPL-3.0-or-later
"""Run Blender without a window from test drivers (no bpy here)."""
import os
import subprocess

TESTS = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
ROOT = os.path.dirname(os.path.dirname(TESTS))
BATCH = os.path.join(ROOT, "blender_addon", "batch.py")


def blender(arguments, log):
    """Run `blender -b ARGUMENTS`; output is appended to a log file. CalledProcessError on failure."""
    with open(log, 'a', encoding='utf-8') as file:
        subprocess.run(
            ['blender', '-b', *arguments], cwd=ROOT, stdout=file, stderr=subprocess.STDOUT, check=True
        )


def script(name, blend, arguments, log):
    """Run a script of this folder, or an absolute path, on a .blend."""
    path = os.path.join(TESTS, name)
    blender([blend, '--python-exit-code', '1', '-P', path, '--', *map(str, arguments)], log)


def bake(blend, out, arguments, log, preset='reference'):
    """Bake with the batch entry; returns (path of the result .blend, package folder)."""
    script(BATCH, blend, ['--preset', preset, '--out', out, *arguments], log)
    return os.path.join(out, os.path.basename(blend)), os.path.join(out, "package")
