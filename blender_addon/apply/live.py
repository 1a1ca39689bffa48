# SPDX-License-Identifier: GPL-3.0-or-later
"""The preview of a package with light sets, doors and toggles follows their weights.

A session holds the open package and pushes weights from the scene to it: at once when a property is
set, and when a driver or keyframe moves one. Its handlers exist only while it does. Pages live in
images that are packed when the file is saved, so that a reopened file shows what was seen last even
without the run-time library or the package.
"""
import os

import bpy
import numpy
from bpy.app.handlers import persistent

from . import appearance, images, reload
from .record import absolute_path, load_json, read_record
from .sources import find_sources

problem = ""  # why the preview of this file does not follow its weights, for the panel
_session = None


class Session:
    """A package kept open for the scene that shows it."""

    def __init__(self, runtime, scene, warnings):
        self.runtime, self._weights, self._busy = runtime, {}, False
        self.elements = runtime.elements()
        self.sources = find_sources(scene, self.elements, warnings)
        self.looks = appearance.Looks(scene, self.sources)
        self.reloader = reload.Reloader()
        for page in range(runtime.page_count()):
            images.make_live(page, runtime.page_size(page))
        images.make_live(images.MEAN, (1, 1))
        self._push(None)
        runtime.update()
        self._fill(range(runtime.page_count()))

    def refresh(self, depsgraph=None, everything=False):
        """Brings pages, lamps, leaves and toggles up to the weights of the scene."""
        if self._busy:
            return  # what follows changes the file, which calls the handlers
        self._busy = True
        try:
            changed = self.runtime.update() if self._push(depsgraph) else []
            self._fill(range(self.runtime.page_count()) if everything else changed)
            self.looks.show(self._weights, everything)
        finally:
            self._busy = False

    def _fill(self, pages):
        """Copies pages of the package into their images."""
        for page in pages:
            images.fill(page, numpy.frombuffer(self.runtime.page_irradiance(page), dtype=numpy.float32))
        if len(pages):
            images.fill_mean(self.runtime.page_count())
        for page in (*pages, images.MEAN) if len(pages) else ():
            self.reloader.ask(images.find_live(page))

    def _push(self, depsgraph):
        """Hands the weights that differ from the last ones to the run time. True if any did."""
        changed = False
        for element, source in self.sources.items():
            state = source.read(depsgraph)
            if state is None or self._weights.get(source) == state:
                continue
            self._weights[source] = state
            self.runtime.set_weight(element, state[0])
            if source.kind == "light_set":
                self.runtime.set_color(element, state[1])
            changed = True
        return changed


def start(scene, warnings):
    """Opens the package of the scene's last bake if it has elements. Returns the session, or None
    for a package without elements, and with a warning about what is missing."""
    global _session, problem
    stop()
    package = absolute_path(read_record(scene).get("package", ""))
    try:
        if not load_json(os.path.join(package, "manifest.json")).get("elements"):
            return None
        _session = Session(open_package(package), scene, warnings)
    except (ValueError, OSError, ImportError) as error:
        problem = f"light sets, doors and toggles do not follow their weights here: {error}"
        warnings.append((os.path.basename(package), problem))
        return None
    _set_handlers(True)
    return _session


def stop():
    """Ends the session. What it showed stays for the preview to take back."""
    global _session, problem
    _set_handlers(False)
    if _session is not None:
        _session.runtime.close()
    _session, problem = None, ""


def open_package(package):
    """The run time of a package; ValueError or OSError if it cannot be opened."""
    from ..bridge import runtime

    try:
        return runtime.Runtime(package)
    except runtime.LightError as error:
        raise ValueError(str(error)) from error


def refresh(everything=False):
    """Brings the preview up to the weights of the scene, if it follows them."""
    if _session is not None:
        _session.refresh(None, everything)


def weight_changed(_owner=None, _context=None):
    """Update callback of every weight and colour."""
    refresh()


def resume():
    """Follows the weights again after a file was loaded, or an undo brought the preview back."""
    scene = next((s for s in bpy.data.scenes if s.library is None and s.ajar.preview), None)
    if scene is None:
        stop()
    elif _session is not None:
        refresh(everything=True)
    elif images.live_images():
        warnings = []
        if start(scene, warnings) is not None:
            refresh(everything=True)
        for culprit, text in warnings:
            print(f"ajar: warning: {culprit}: {text}", flush=True)


def _graph_changed(scene, depsgraph):
    if _session is not None and scene.ajar.preview:
        _session.reloader.seen()
        _session.refresh(depsgraph)


def _frame_changed(scene, depsgraph):
    if _session is not None and scene.ajar.preview:
        _session.refresh(depsgraph)


def _before_save(*_):
    images.pack_live()


@persistent
def _before_load(*_):
    stop()


@persistent
def _after_load(*_):
    resume()


_WHILE_ON = (
    (bpy.app.handlers.depsgraph_update_post, _graph_changed),
    (bpy.app.handlers.frame_change_post, _frame_changed),
    (bpy.app.handlers.save_pre, _before_save),
)
_ALWAYS = (
    (bpy.app.handlers.load_pre, _before_load),
    (bpy.app.handlers.load_post, _after_load),
    (bpy.app.handlers.undo_post, _after_load),
    (bpy.app.handlers.redo_post, _after_load),
)


def _set_handlers(on, handlers=_WHILE_ON):
    for group, handler in handlers:
        if on and handler not in group:
            group.append(handler)
        elif not on and handler in group:
            group.remove(handler)


def register():
    """Adds the handlers of file loads and undo; a file may be open already, with its preview on."""
    _set_handlers(True, _ALWAYS)
    bpy.app.timers.register(resume, first_interval=0.0)


def unregister():
    """Ends the session and removes every handler."""
    stop()
    _set_handlers(False, _ALWAYS)
    if bpy.app.timers.is_registered(resume):
        bpy.app.timers.unregister(resume)
