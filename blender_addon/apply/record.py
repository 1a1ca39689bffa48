# SPDX-License-Identifier: GPL-3.0-or-later
"""The record of the last bake: one JSON string on the scene, so that undo, save and append keep it
whole. Paths in it are relative to the .blend where that is possible."""
import json
import os

import bpy


def read_record(scene):
    """The scene's last bake as a dict; empty if there is none or it cannot be read."""
    try:
        record = json.loads(scene.ajar.last_bake or "{}")
    except ValueError:
        return {}
    return record if isinstance(record, dict) else {}


def write_record(scene, record):
    """Stores the record of a bake."""
    scene.ajar.last_bake = json.dumps(record, separators=(",", ":"))


def relative_path(path):
    """path as '//...' where the file is saved on the same drive, else as it is."""
    if not bpy.data.is_saved or path.startswith("//"):
        return path
    try:
        return bpy.path.relpath(path)
    except ValueError:  # another drive on Windows
        return path


def absolute_path(path):
    """Absolute, normalised form of a Blender path."""
    return os.path.normpath(bpy.path.abspath(path))


def make_record(package, report, summary):
    """Record of a finished bake. summary holds what the panel shows."""
    return {"version": 1, "package": relative_path(package), "report": relative_path(report), **summary}


def load_json(path):
    """A JSON file as a dict; ValueError with the path if it is not one."""
    try:
        with open(path, encoding="utf-8") as file:
            data = json.load(file)
    except (OSError, ValueError) as error:
        raise ValueError(f"cannot read {path}: {error}") from error
    if not isinstance(data, dict):
        raise ValueError(f"cannot read {path}: not a JSON object")
    return data
