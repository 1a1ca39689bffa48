# SPDX-License-Identifier: GPL-3.0-or-later
"""The job of ajar.predict: what a bake of the open file would take with each preset. The file is left as it was."""
import json
import os
import time
from dataclasses import dataclass

from . import job as jobs
from . import settings
from .accuracy.advice import duration
from .bridge.client import WorkerClient
from .bridge.worker import WISHES

PRESETS = ("DRAFT", "PREVIEW", "PRODUCTION")
EXPORTED = 0.2  # share of the bar for layout and export


@dataclass
class Prediction:
    """Seconds by preset, layout and export included."""

    scene: str  # name
    density: float  # texels per metre
    texels: int
    seconds: dict
    plans: dict  # trial reports by preset: effects, predicted_stages, predicted_memory_parts

    def lines(self):
        """For people: 'Preview: about 2.1 min'."""
        return [f"{name.capitalize()}: about {duration(s)}" for name, s in self.seconds.items()]

    def plan(self, preset):
        """For people: what a bake would simulate and its share of the time, what it would skip and why, and the
        memory of what it makes. Empty for a preset that was not tried."""
        plan = self.plans.get(preset)
        if plan is None:
            return []
        effects = plan["effects"]
        skipped = [f"{e['name']} ({e['reason']})" for e in effects if e["status"] == "skipped"]
        memory = sum(plan["predicted_memory_parts"].values()) / 1e6
        return [
            *(_simulated(e) for e in effects if e["status"] == "simulated"),
            "Skipped: " + (", ".join(skipped) or "nothing"),
            f"Memory of level and light: about {memory:.0f} MB",
        ]


def _simulated(effect):
    share = effect.get("time_share")
    return f"{effect['name'].capitalize()}: {effect['reason']}" + (
        f", {share:.0%} of the time" if share else ""
    )


def predict_steps(job, overrides=None):
    """The whole prediction. The result is job.manager.predicted. overrides: as for a bake, but for the preset."""
    scene = job.link.scene()
    density = settings.layout_settings(scene, overrides)["texels_per_meter"]
    folder = os.path.join(job.folder, "snapshot")
    begin = time.monotonic()
    with jobs.scene_left_alone(job):
        layout = yield from jobs.layout_steps(job, overrides=overrides, end=0.5 * EXPORTED, stays=False)
        yield from jobs.snapshot_steps(job, folder, layout, overrides)
    export = time.monotonic() - begin
    scene = job.link.scene()
    given = overrides or {}
    wishes = {name: settings.engine_settings(scene, {**given, "preset": name}) for name in PRESETS}
    with open(os.path.join(folder, WISHES), "w", encoding="utf-8") as file:
        json.dump(wishes, file)
    worker = WorkerClient.predict(folder)
    yield from job.run_worker(worker, EXPORTED, 1.0)
    job.status.stage, job.status.fraction, job.status.remaining = "done", 1.0, 0.0
    seconds = {name: export + s for name, s in worker.outcome["predicted"].items()}
    found = Prediction(
        job.link.scene().name, density, worker.outcome["texels"], seconds, worker.outcome["plans"]
    )
    jobs.manager.predicted = found
    job.status.message = f"{found.texels} texels. " + ", ".join(found.lines())
