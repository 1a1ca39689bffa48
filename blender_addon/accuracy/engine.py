# SPDX-License-Identifier: GPL-3.0-or-later
"""The engine from Python, in this process: scenes from saved snapshots, bakes as arrays."""
import contextlib
import ctypes
import functools
import time

import numpy as np

from ..bridge import abi, scene_builder
from ..bridge.library import check, load_library
from ..bridge.snapshot_io import Reader
from ..bridge.worker import job_error, read_report

LAYER_IRRADIANCE, LAYER_VALIDITY = 0, 3
POLL_SECONDS = 0.1


class Cancelled(Exception):
    """Somebody asked to stop."""


def never():
    """Nobody asks to stop."""
    return False


@contextlib.contextmanager
def snapshot_scene(library, folder):
    """(handle of the committed scene, what snapshot.json says) of a snapshot folder."""
    with Reader(folder, "snapshot") as reader:
        builder = scene_builder.SceneBuilder(library, reader)
        try:
            builder.build()
            yield builder.scene, reader.data
        finally:
            builder.release()


def wait(library, kind, handle, cancelled):
    """Result of a 'job' or 'reference' once it has ended. cancelled() is asked while it runs; Cancelled is raised
    when it has stopped."""
    while True:
        result = getattr(library, f"ajar_{kind}_wait")(handle, POLL_SECONDS)
        if result == abi.CANCELLED:
            raise Cancelled()
        if result != abi.RUNNING:
            return result
        if cancelled():
            getattr(library, f"ajar_{kind}_cancel")(handle)


class Bake:
    """One finished bake of a snapshot. seconds is wall-clock from reading the files to finished pages."""

    def __init__(self, library, folder, cancelled=never, **settings):
        begin = time.perf_counter()
        self._library, self._job = library, abi.Handle()
        with snapshot_scene(library, folder) as (scene, data):
            self.pages = data["pages"]
            filled = scene_builder.fill_settings(library, {**data["settings"], **settings})
            check(library, library.ajar_job_start(scene, ctypes.byref(filled), ctypes.byref(self._job)))
        try:
            result = wait(library, "job", self._job, cancelled)
            if result != abi.OK:
                raise job_error(library, self._job, result)
        except BaseException:
            self.close()
            raise
        self.seconds = time.perf_counter() - begin

    def layer(self, page, which):
        """(height, width, channels) float32 array, bottom row first."""
        sizes = [ctypes.c_uint32() for _ in range(3)]
        check(
            self._library,
            self._library.ajar_job_layer_size(self._job, page, which, *map(ctypes.byref, sizes)),
        )
        width, height, channels = (s.value for s in sizes)
        values = np.empty((height, width, channels), np.float32)
        pointer = values.ctypes.data_as(ctypes.POINTER(ctypes.c_float))
        check(self._library, self._library.ajar_job_read_layer(self._job, page, which, pointer, values.size))
        return values

    def terms(self):
        """(element ids, read(page, shape)) of every term but the base; read gives its irradiance as array."""
        count, info = ctypes.c_uint32(), abi.TermInfo()
        self._library.ajar_term_info_init(ctypes.byref(info))
        check(self._library, self._library.ajar_job_term_count(self._job, ctypes.byref(count)))
        for term in range(1, count.value):
            check(self._library, self._library.ajar_job_term(self._job, term, ctypes.byref(info)))
            yield list(info.elements[: info.element_count]), functools.partial(self._read_term, term)

    def _read_term(self, term, page, shape):
        values = np.empty(shape, np.float32)
        pointer = values.ctypes.data_as(ctypes.POINTER(ctypes.c_float))
        check(self._library, self._library.ajar_job_read_term(self._job, term, page, pointer, values.size))
        return values

    def report(self):
        """The report, parsed."""
        return read_report(self._library, self._job)

    def progress(self):
        """Rays traced and the like."""
        progress = abi.Progress()
        self._library.ajar_progress_init(ctypes.byref(progress))
        check(self._library, self._library.ajar_job_poll(self._job, ctypes.byref(progress)))
        return progress

    def close(self):
        """Frees the result."""
        self._library.ajar_job_release(ctypes.byref(self._job))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
