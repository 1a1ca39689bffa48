# SPDX-License-Identifier: GPL-3.0-or-later
"""Copies of a saved scene with parts changed; the arrays are shared."""
import json
import os
from pathlib import Path

NAME = "snapshot"


def _copy(folder, name, change):
    """A snapshot folder beside the given one whose JSON change(data) has edited."""
    out = Path(f"{folder}_{name}")
    out.mkdir(exist_ok=True)
    data = json.loads((Path(folder) / f"{NAME}.json").read_text(encoding="utf-8"))
    change(data)
    (out / f"{NAME}.json").write_text(json.dumps(data), encoding="utf-8")
    link = out / f"{NAME}.bin"
    link.unlink(missing_ok=True)
    os.symlink(os.path.abspath(Path(folder) / f"{NAME}.bin"), link)
    return str(out)


def without_elements(folder):
    """The scene as it stands, with nothing to switch or open and every light set at full strength."""

    def change(data):
        elements = data.pop("elements", [])
        for thing in (*data["instances"], *data["lights"]):
            thing.pop("light_set", None)
        for instance in data["instances"]:
            element = instance.pop("element", None)
            if element is not None and not _is_there(elements[element], instance.pop("open_pose", False)):
                instance["visibility"] = []

    return _copy(folder, "still", change)


def _is_there(element, open_pose):
    shown = element["weight"] >= 0.5
    return shown == open_pose if element["kind"] == "door" else shown


def without_open_poses(folder):
    """The scene with doors that vanish when they open."""

    def change(data):
        for instance in data["instances"]:
            if instance.get("open_pose"):
                instance["visibility"] = []

    return _copy(folder, "no_leaves", change)
