# SPDX-License-Identifier: GPL-3.0-or-later
"""The job of ajar.accuracy: exports the open file at several texel densities, then has a worker measure it. The
file is left as it was."""
import json
import os
import webbrowser
from pathlib import Path

import bpy

from . import settings
from .accuracy import knobs
from .accuracy.worker import REQUEST, snapshot_folder
from .bridge.client import WorkerClient
from .job import JobFailed, layout_steps, scene_left_alone, snapshot_steps

EXPORTED = 0.05  # share of the bar for the export


def accuracy_steps(job, out, preset, quick, limits):
    """The whole measurement. out: folder of the page; preset: lower case; limits: points and seconds by name, as
    accuracy.study.limits gives them."""
    scene = job.link.scene()
    density = settings.layout_settings(scene)["texels_per_meter"]
    folder = os.path.join(job.folder, "accuracy")
    os.makedirs(folder)
    with scene_left_alone(job):
        yield from _export(job, folder, density, preset, quick)
    wishes = {"name": _name(), "preset": preset, "density": density, "quick": quick, **limits}
    with open(os.path.join(folder, REQUEST), "w", encoding="utf-8") as file:
        json.dump(wishes, file)
    worker = WorkerClient.accuracy(folder, out)
    yield from job.run_worker(worker, EXPORTED, 1.0)
    job.status.stage, job.status.fraction, job.status.remaining = "done", 1.0, 0.0
    job.status.message = f"{worker.outcome['advice'][0]} More in {worker.outcome['page']}"
    show_page(worker.outcome["page"])


def _export(job, folder, density, preset, quick):
    """Writes a snapshot per texel density. The wanted one has to work; others are left out with a warning."""
    for factor in (1.0, *knobs.density_factors(quick)):
        overrides = {"preset": preset.upper(), "texels_per_meter": factor * density}
        try:
            layout = yield from layout_steps(job, overrides=overrides, end=0.0, stays=False)
        except JobFailed as failure:
            if factor == 1.0:
                raise
            job.status.warn(f"{factor * density:g} texels per metre", f"not measured: {failure}")
            continue
        yield from snapshot_steps(job, str(snapshot_folder(folder, factor)), layout, overrides)


def _name():
    return Path(bpy.data.filepath).stem or "unsaved file"


def show_page(page):
    """Opens the page in a browser, where there is a window to come from."""
    if not bpy.app.background:
        webbrowser.open(Path(page).as_uri())
