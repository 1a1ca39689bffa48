# SPDX-License-Identifier: GPL-3.0-or-later
"""Turns the scene's settings, with overrides of a batch, into what the engine takes."""
import os

from . import fields, model
from .accuracy.study import PAGE
from .apply.record import absolute_path

PACKAGE = "package"
REPORT = "report.json"
ACCURACY = "accuracy"
_FROM_SCENE = (
    "bounces",
    "time_limit",
    "seed",
    "threads",
    "stitch_seams",
    "keep_sh",
    "overlap_pictures",
    "combinations",
    "term_threshold",
    "light_patches",
    "memory_limit",
)


def engine_settings(scene, overrides=None):
    """Engine settings as a dict. overrides uses the same names; None values are ignored."""
    ajar, given = scene.ajar, _given(overrides)
    values = {name: getattr(ajar, name) for name in _FROM_SCENE}
    # A sample count from the caller means exactly that many rays; model turns the target off.
    if ajar.noise_target > 0.0 and "samples" not in given:
        values["noise_target"] = ajar.noise_target
    preset = given.pop("preset", ajar.preset)
    values.update({name: value for name, value in given.items() if name != "texels_per_meter"})
    return model.engine_settings(preset, **values)


def layout_settings(scene, overrides=None):
    """Layout settings as a dict."""
    values = {field.name: getattr(scene.ajar, field.name) for field in fields.LAYOUT_FIELDS}
    density = _given(overrides).get("texels_per_meter")
    if density is not None:
        values["texels_per_meter"] = density
    return model.layout_settings(**values)


def output_paths(scene):
    """(package directory, report file) of the scene, absolute."""
    folder = absolute_path(scene.ajar.output_dir or "//")
    return os.path.join(folder, PACKAGE), os.path.join(folder, REPORT)


def accuracy_page(scene):
    """The page that ajar.accuracy leaves, absolute."""
    return os.path.join(absolute_path(scene.ajar.output_dir or "//"), ACCURACY, PAGE)


def _given(overrides):
    return {name: value for name, value in (overrides or {}).items() if value is not None}
