# SPDX-License-Identifier: GPL-3.0-or-later
"""One bake at a time, driven from outside in small steps so that Blender stays usable.

A task is a generator that yields while a worker process runs. The manager is a module variable:
it outlives operators (loading a file cancels them) and is stepped by a persistent timer.
"""
import contextlib
import os
import shutil
import tempfile
import time

import bpy
from bpy.app.handlers import persistent

from . import settings
from .apply import preview, record, uvs
from .bridge.client import WorkerClient
from .bridge.library import BakeError
from .extract import layout as layout_extract
from .extract import snapshot as snapshot_extract

INTERVAL = 0.15  # seconds between steps in the user interface
_SHOWN_ERRORS = ("unknown", "estimated_rms", "p95", "target", "share_reached", "spread", "next_step")
_LEAST_SHARE, _MOST_SHARES = 0.03, 4  # of a bake's time: effects that the panel names
PATIENCE = 0.8  # seconds a worker has to stop when asked


class JobFailed(Exception):
    """A bake that cannot go on; the text says what to do."""


class Status:
    """What panels and the batch show of a job. result is 'running', 'done', 'failed' or
    'cancelled'."""

    def __init__(self, title):
        self.title = title
        self.stage, self.fraction, self.remaining = "starting", 0.0, -1.0
        self.result, self.message = "running", ""
        self.warnings = []
        self.started = time.monotonic()

    def warn(self, culprit, text):
        """Adds a warning once."""
        if (culprit, text) not in self.warnings:
            self.warnings.append((culprit, text))

    def warn_all(self, warnings):
        """Adds (culprit, text) pairs."""
        for culprit, text in warnings:
            self.warn(culprit, text)

    def take(self, event):
        """Updates from one event of a worker."""
        kind = event.get("event")
        if kind == "progress":
            self.stage = event.get("stage", self.stage)
            self.fraction = float(event.get("fraction", self.fraction))
            self.remaining = float(event.get("remaining", -1.0))
        elif kind == "warning":
            self.warn(event.get("culprit", ""), event.get("text", ""))
        elif kind == "error":
            culprit = event.get("culprit", "")
            raise JobFailed(f"{culprit}: {event['message']}" if culprit else event["message"])
        elif kind == "cancelled":
            raise JobCancelled()


class JobCancelled(Exception):
    """The job was asked to stop."""


class SceneLink:
    """Finds a job's scene again in later steps, unless another file took its place."""

    def __init__(self, context):
        self.name = context.scene.name
        self.file = bpy.data.filepath
        self.detached = False

    def scene(self):
        """The scene, or JobFailed if it is gone."""
        scene = bpy.data.scenes.get(self.name)
        if self.detached or scene is None:
            raise JobFailed("the file was closed while baking: open it and bake again")
        return scene

    def context(self):
        """A context manager in which bpy.context sees the scene."""
        scene = self.scene()
        windows = bpy.context.window_manager.windows
        window = next((w for w in windows if w.scene == scene), None)
        if window is not None:
            return bpy.context.temp_override(window=window)
        return bpy.context.temp_override(scene=scene, view_layer=scene.view_layers[0])


class Job:
    """A running task: its status, its worker and its temporary folder."""

    def __init__(self, title, context, steps, **options):
        self.status = Status(title)
        self.link = SceneLink(context)
        self.cancelled = False
        self._cancel_time = 0.0
        self.folder = tempfile.mkdtemp(prefix="ajar-")
        self.worker = None
        self._steps = steps(self, **options)

    def step(self):
        """Runs to the next pause. Returns False when the job has ended."""
        status = self.status
        try:
            if self.cancelled and self.worker is None:
                raise JobCancelled()
            next(self._steps)
            return True
        except StopIteration:
            status.result = "done"
        except JobCancelled:
            status.result, status.message = "cancelled", "cancelled"
        except (JobFailed, ValueError, OSError, BakeError) as error:
            status.result, status.message = "failed", str(error)
        except BaseException:
            status.result, status.message = "failed", "internal error, see the console"
            self.close()
            raise
        self.close()
        return False

    def cancel(self):
        """Asks the worker to stop; the job ends at a later step."""
        self.cancelled = True
        self._cancel_time = self._cancel_time or time.monotonic()
        if self.worker is not None:
            self.worker.cancel()

    def _waited_long(self):
        """True if a worker that was asked to stop takes too long about it."""
        return self.cancelled and time.monotonic() - self._cancel_time > PATIENCE

    def close(self):
        """Ends the worker if it still runs and removes the temporary folder."""
        self._steps.close()  # closes the worker it waits for
        shutil.rmtree(self.folder, ignore_errors=True)

    def run_worker(self, worker, begin, end):
        """Yields until the worker has ended, mapping its progress to [begin, end]."""
        self.worker = worker
        if self.cancelled:
            worker.cancel()
        try:
            while worker.running:
                for event in worker.poll():
                    shown = self.status.fraction
                    self.status.take(event)
                    if event["event"] == "progress":
                        # Estimates change; a bar that runs backwards only worries people.
                        self.status.fraction = max(shown, begin + (end - begin) * self.status.fraction)
                if worker.running and self._waited_long():
                    worker.kill()
                if worker.running:
                    yield
        finally:
            self.worker = None
            worker.close()


def layout_steps(job, keep_existing=False, overrides=None, end=1.0, stays=True):
    """Unwraps and packs lightmap UVs of the scene. Returns the layout as write_snapshot takes it. stays: the scene
    keeps them, as a step that can be undone."""
    job.status.stage = "lightmap layout"
    yield
    folder = tempfile.mkdtemp(prefix="layout-", dir=job.folder)
    scene = job.link.scene()
    with job.link.context():
        preview.hide()
        wanted = settings.layout_settings(scene, overrides)
        mapping = layout_extract.write_layout_request(bpy.context, folder, wanted, keep_existing)
    job.status.warn_all(mapping.warnings)
    if not mapping.meshes:
        raise JobFailed("nothing to bake: no mesh can carry lightmap UVs (see the warnings)")
    yield from job.run_worker(WorkerClient.layout(folder), 0.0, end)
    scene = job.link.scene()
    layout, new_uvs = layout_extract.read_layout(folder, mapping)
    job.status.warn_all(uvs.apply_layout(scene, layout, new_uvs, mapping.meshes))
    if stays:
        _push_undo("Lightmap UVs")
    return layout


def bake_steps(job, package, report, keep_existing=False, overrides=None, show=True):
    """The whole bake: layout, snapshot, worker, record and preview. Unless a new package came to be,
    the scene keeps the lightmap UVs of the last one."""
    kept, stamp = uvs.KeptLayout(job.link.scene()), _stamp(package)
    try:
        yield from _package_steps(job, package, report, keep_existing, overrides)
    except BaseException:
        if not job.link.detached and _stamp(package) == stamp:
            kept.restore(job.link.scene())
        raise
    job.status.stage, job.status.fraction, job.status.remaining = "done", 1.0, 0.0
    finish(job, package, report, show, overrides)


def _stamp(package):
    """What tells a package from the one that replaced it; None if there is none."""
    try:
        manifest = os.stat(os.path.join(package, "manifest.json"))
    except OSError:
        return None
    return manifest.st_ino, manifest.st_mtime_ns


def _package_steps(job, package, report, keep_existing, overrides):
    """A bake up to its package: layout, snapshot and worker."""
    layout = yield from layout_steps(job, keep_existing, overrides, 0.05)
    folder = os.path.join(job.folder, "snapshot")
    yield from snapshot_steps(job, folder, layout, overrides)
    os.makedirs(os.path.dirname(package), exist_ok=True)
    spent = time.monotonic() - job.status.started
    yield from job.run_worker(WorkerClient.bake(folder, package, report, spent), 0.07, 1.0)


def snapshot_steps(job, folder, layout, overrides=None):
    """Writes the scene for a worker into a new folder."""
    job.status.stage = "scene export"
    yield
    os.makedirs(folder)
    scene = job.link.scene()
    with job.link.context():
        wanted = settings.engine_settings(scene, overrides)
        written = snapshot_extract.write_snapshot(bpy.context, folder, wanted, layout)
    job.status.warn_all(written.warnings)


@contextlib.contextmanager
def scene_left_alone(job):
    """Layouts that a job makes inside are undone at the end: lightmap UVs and preview are as before."""
    scene = job.link.scene()
    kept, shown = uvs.KeptLayout(scene), scene.ajar.preview
    try:
        yield
    finally:
        if not job.link.detached:
            kept.restore(job.link.scene())
            if shown:
                with job.link.context():
                    job.status.warn_all(preview.show(bpy.context))


def finish(job, package, report, show, overrides=None):
    """Records the finished bake on its scene and shows it. A file that was closed meanwhile keeps
    the package on disk only."""
    try:
        scene = job.link.scene()
    except JobFailed:
        job.status.message = f"the file was closed while baking; the result is in {package}"
        return
    summary = summarize(record.load_json(report), job.status)
    summary["preset"] = (overrides or {}).get("preset") or scene.ajar.preset
    record.write_record(scene, record.make_record(package, report, summary))
    if show:
        with job.link.context():
            job.status.warn_all(preview.show(bpy.context))
    _push_undo("Bake Lightmaps")


def summarize(report, status):
    """What the panel shows of a report."""
    error = report.get("error", {})
    for warning in report.get("warnings", ()):
        status.warn(warning.get("culprit", ""), warning["text"])
    return {
        "seconds": time.monotonic() - status.started,
        "rays": report.get("rays", {}).get("total", 0),
        "error": {name: error[name] for name in _SHOWN_ERRORS if name in error},
        "self_check": report.get("self_check", {}),
        "time_shares": _largest_shares(report.get("effects", ())),
        "time_limited": bool(report.get("time_limited")),
        "warnings": [list(warning) for warning in status.warnings],
    }


def _largest_shares(effects):
    """[name, share] of the effects that took most of the time."""
    shares = [[e["name"], e["time_share"]] for e in effects if e.get("time_share", 0.0) >= _LEAST_SHARE]
    return sorted(shares, key=lambda entry: -entry[1])[:_MOST_SHARES]


def _push_undo(message):
    """Makes the result a step of its own, so that an undo does not take half of it away."""
    if not bpy.app.background and bpy.ops.ed.undo_push.poll():
        bpy.ops.ed.undo_push(message=message)


class Manager:
    """Holds the one job of this Blender."""

    def __init__(self):
        self.job = None
        self.last = None  # status of the job before
        self.predicted = None  # what predict_job found last

    @property
    def running(self):
        """True while a job is under way."""
        return self.job is not None

    @property
    def status(self):
        """Status of the running job, else of the last one, else None."""
        return self.job.status if self.job else self.last

    def start(self, job):
        """Takes a job; the caller steps it, or a timer does in the user interface."""
        self.job = job
        if not bpy.app.background:
            bpy.app.timers.register(_tick, first_interval=INTERVAL, persistent=True)

    def step(self):
        """One step. Returns True while the job runs."""
        if self.job is None:
            return False
        job = self.job
        try:
            alive = job.step()
        finally:
            if job.status.result != "running":
                self.job, self.last = None, job.status
        return alive

    def cancel(self):
        """Asks the running job to stop."""
        if self.job:
            self.job.cancel()

    def stop_now(self):
        """Ends the running job at once, without applying anything."""
        if self.job:
            self.job.close()
            self.job = None


manager = Manager()


def _tick():
    """Timer callback: steps the job, then asks the panels to redraw."""
    alive = manager.step()
    status = manager.status
    state = getattr(bpy.context.window_manager, "ajar", None)
    if state is not None and status is not None:
        state.percent = 100.0 * min(max(status.fraction, 0.0), 1.0)
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type in {"VIEW_3D", "PROPERTIES"}:
                area.tag_redraw()
    return INTERVAL if alive else None


@persistent
def _before_load(*_):
    """The scene of a running job is about to go away."""
    if manager.job:
        manager.job.link.detached = True


def register():
    """Adds the load handler."""
    bpy.app.handlers.load_pre.append(_before_load)


def unregister():
    """Stops the running job and removes handler and timer."""
    manager.stop_now()
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)
    bpy.app.handlers.load_pre.remove(_before_load)
