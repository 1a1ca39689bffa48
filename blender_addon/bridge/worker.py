# SPDX-License-Identifier: GPL-3.0-or-later
"""Worker process: runs the engine apart from Blender (standard library only).

    python3 worker.py layout DIR
    python3 worker.py bake DIR --package OUT_DIR --report REPORT.json [--spent SECONDS]
    python3 worker.py predict DIR

Writes one JSON event per line to stdout (progress, warning, error, cancelled, done). A line
"cancel" on stdin, a closed stdin or SIGTERM cancels. Exit codes: 0 done, 1 error, 2 cancelled.
"""

import argparse
import ctypes
import faulthandler
import json
import os
import signal
import sys
import threading
import time
from pathlib import Path

if not __package__:  # run as a file: its siblings are the package "bridge"
    sys.path[0] = str(Path(__file__).resolve().parent.parent)
    __package__ = "bridge"
    import bridge  # noqa: F401

from . import abi
from .layout_run import run_layout
from .library import BakeError, check, decode, load_library, read_warnings
from .scene_builder import SceneBuilder, fill_settings
from .snapshot_io import Reader, SnapshotError, write_text_whole

POLL_SECONDS = 0.1
WISHES = "predict.json"  # beside a snapshot: settings by name
PLAN = ("effects", "predicted_stages", "predicted_memory_parts")  # of a trial's report
DONE, FAILED, CANCELLED = 0, 1, 2
LEAST_SHARE = 0.1  # of a time limit that the engine gets in any case


class Host:
    """The other end of the pipes: takes events, asks to cancel."""

    def __init__(self):
        self.cancel = threading.Event()
        self._out = sys.stdout

    def listen(self):
        """Starts watching stdin and SIGTERM."""
        signal.signal(signal.SIGTERM, lambda *_: self.cancel.set())
        if hasattr(signal, "SIGINT"):
            signal.signal(signal.SIGINT, lambda *_: self.cancel.set())
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self):
        try:
            # os.read, not sys.stdin: a thread inside the buffered reader blocks interpreter exit.
            pending = b""
            while not self.cancel.is_set():
                chunk = os.read(0, 4096)
                pending += chunk
                if not chunk or b"cancel" in pending.split():
                    break
                pending = pending[-16:]
        except OSError:
            pass
        self.cancel.set()

    def send(self, event, **values):
        """Writes one event line; a vanished reader means cancel."""
        try:
            self._out.write(json.dumps({"event": event, **values}, ensure_ascii=True) + "\n")
            self._out.flush()
        except (OSError, ValueError):
            self.cancel.set()


def be_polite():
    """Low priority, and the first to go when memory runs out: never Blender."""
    if hasattr(os, "nice"):
        os.nice(10)
    elif sys.platform == "win32":
        below_normal = 0x4000
        kernel = ctypes.windll.kernel32
        kernel.SetPriorityClass(kernel.GetCurrentProcess(), below_normal)
    try:
        Path("/proc/self/oom_score_adj").write_text("800", encoding="ascii")
    except OSError:
        pass


def layout(library, host, arguments):
    """The 'layout' command; returns the exit code."""
    warnings = run_layout(library, arguments.directory, host.cancel.is_set)
    if warnings is None:
        return CANCELLED
    for culprit, text in warnings:
        host.send("warning", culprit=culprit, text=text)
    host.send("done", directory=str(arguments.directory))
    return DONE


def bake(library, host, arguments):
    """The 'bake' command; returns the exit code."""
    started = time.monotonic() - arguments.spent
    with Reader(arguments.directory, "snapshot") as reader:
        settings = fill_settings(library, reader.data.get("settings", {}))
        known = reader.data.get("warnings", [])
        extras = reader.data.get("extras")
        builder = build_scene(library, host, reader)
    if builder is None:
        return CANCELLED
    settings.time_limit = time_left(settings.time_limit, time.monotonic() - started)
    job = abi.Handle()
    try:
        check(library, library.ajar_job_start(builder.scene, ctypes.byref(settings), ctypes.byref(job)))
    finally:
        builder.release()  # the job keeps its own reference
    try:
        return finish(library, host, job, arguments, known, extras)
    finally:
        library.ajar_job_release(ctypes.byref(job))


def time_left(limit, spent):
    """What the engine may take of a time limit for the whole bake, after seconds of layout and export. 0: no limit."""
    return max(limit - spent, LEAST_SHARE * limit)


def build_scene(library, host, reader):
    """Builder of a snapshot's committed scene, whose warnings it passes on; None if cancelled."""
    builder = SceneBuilder(library, reader)
    try:
        if builder.build(host.cancel.is_set):
            send_scene_warnings(library, host, builder)
            return builder
    except BaseException:
        builder.release()
        raise
    builder.release()
    return None


class Part:
    """A host for one of several jobs, whose progress is a part of the whole."""

    def __init__(self, host, number, count):
        self._host, self._number, self._count = host, number, count
        self.cancel = host.cancel

    def send(self, event, **values):
        """Passes progress on."""
        values.update(fraction=(self._number + values["fraction"]) / self._count, remaining=-1.0)
        self._host.send(event, **values)


def predict(library, host, arguments):
    """The 'predict' command: seconds that bakes of a snapshot would take, with the settings of each name in its
    WISHES, and what they would do. Returns the exit code."""
    wishes = json.loads((arguments.directory / WISHES).read_text(encoding="utf-8"))
    with Reader(arguments.directory, "snapshot") as reader:
        builder = build_scene(library, host, reader)
    if builder is None:
        return CANCELLED
    seconds, plans, texels = {}, {}, 0
    try:
        for number, (name, values) in enumerate(wishes.items()):
            settings = fill_settings(library, {**values, "trial": True})
            trial = run_trial(library, Part(host, number, len(wishes)), builder.scene, settings)
            if trial is None:
                return CANCELLED
            seconds[name], texels = trial["predicted_seconds"], trial["texels"]
            plans[name] = {key: trial[key] for key in PLAN}
    finally:
        builder.release()
    host.send("done", predicted=seconds, plans=plans, texels=texels)
    return DONE


def run_trial(library, host, scene, settings):
    """Report of a trial; None if cancelled."""
    job = abi.Handle()
    check(library, library.ajar_job_start(scene, ctypes.byref(settings), ctypes.byref(job)))
    try:
        return read_report(library, job) if succeeds(library, host, job) else None
    finally:
        library.ajar_job_release(ctypes.byref(job))


def send_scene_warnings(library, host, builder):
    """Passes the warnings of scene building on."""
    for culprit, text in read_warnings(library, builder.scene, "scene"):
        host.send("warning", culprit=culprit, text=text)


def finish(library, host, job, arguments, known, extras):
    """Waits for the job, then writes the package and the report; returns the exit code."""
    if not succeeds(library, host, job):
        return CANCELLED
    report = report_text(library, job, known)
    extras_text = None if extras is None else json.dumps(extras).encode("utf-8")
    check(library, library.ajar_job_write_package(job, os.fsencode(arguments.package), extras_text))
    if arguments.report:
        write_text_whole(arguments.report, report)
    host.send("done", package=str(arguments.package), report=str(arguments.report or ""))
    return DONE


def succeeds(library, host, job):
    """Waits for the job; False if it was cancelled. Raises its failure."""
    result = wait(library, host, job)
    if result == abi.CANCELLED or host.cancel.is_set():
        return False
    if result < 0:
        raise job_error(library, job, result)
    return True


def wait(library, host, job):
    """Polls until the job ends, sending progress; returns the job's result."""
    progress = abi.Progress()
    asked = False
    while True:
        result = library.ajar_job_wait(job, POLL_SECONDS)
        library.ajar_progress_init(ctypes.byref(progress))
        check(library, library.ajar_job_poll(job, ctypes.byref(progress)))
        host.send(
            "progress",
            stage=decode(library.ajar_stage_name(progress.stage)),
            fraction=round(progress.fraction, 5),
            elapsed=round(progress.elapsed, 3),
            remaining=round(progress.remaining, 1),
            rays=progress.rays,
        )
        if result != abi.RUNNING:
            return result
        if host.cancel.is_set() and not asked:
            library.ajar_job_cancel(job)
            asked = True


def job_error(library, job, result):
    """The job's own failure as a BakeError."""
    text, culprit = ctypes.create_string_buffer(2048), ctypes.create_string_buffer(1024)
    library.ajar_job_error(job, text, len(text), culprit, len(culprit))
    message = decode(text.value) or decode(library.ajar_result_text(result))
    return BakeError(result, message, decode(culprit.value))


def read_report(library, job):
    """The engine's report, parsed."""
    size = ctypes.c_uint64()
    check(library, library.ajar_job_report(job, None, ctypes.byref(size)))
    buffer = ctypes.create_string_buffer(size.value)
    check(library, library.ajar_job_report(job, buffer, ctypes.byref(size)))
    return json.loads(decode(buffer.value))


def report_text(library, job, known):
    """The engine's report as JSON text, with the warnings of extraction put before its own."""
    report = read_report(library, job)
    if known:
        report["warnings"] = list(known) + list(report.get("warnings", []))
    return json.dumps(report, indent=2, ensure_ascii=False) + "\n"


def parse(arguments):
    """Command line as a namespace."""
    parser = argparse.ArgumentParser(prog="worker.py", description="Ajar bake worker")
    commands = parser.add_subparsers(dest="command", required=True)
    for name, function in (("layout", layout), ("bake", bake), ("predict", predict)):
        command = commands.add_parser(name)
        command.add_argument("directory", type=Path)
        command.set_defaults(run=function)
        if name == "bake":
            command.add_argument("--package", type=Path, required=True)
            command.add_argument("--report", type=Path)
            command.add_argument(
                "--spent", type=float, default=0.0, help="seconds of a time limit that are gone"
            )
    return parser.parse_args(arguments)


def serve(command, arguments):
    """Runs command(library, host, arguments) as a worker does: politely, cancelled on request, failures told as
    events. arguments.directory is what bad input is blamed on. Returns the exit code."""
    faulthandler.enable()
    be_polite()
    host = Host()
    host.listen()
    try:
        code = command(load_library(), host, arguments)
    except BakeError as error:
        host.send("error", code=error.code, message=error.message, culprit=error.culprit)
        return FAILED
    except SnapshotError as error:
        host.send("error", code=abi.ERROR_INPUT, message=str(error), culprit=str(arguments.directory))
        return FAILED
    except MemoryError:
        host.send("error", code=abi.ERROR_MEMORY, message="out of memory", culprit="")
        return FAILED
    except OSError as error:
        host.send("error", code=abi.ERROR_IO, message=str(error), culprit=str(error.filename or ""))
        return FAILED
    if code == CANCELLED:
        host.send("cancelled")
    return code


def main(arguments=None):
    """Runs one command; returns the exit code."""
    arguments = parse(arguments)
    return serve(arguments.run, arguments)


if __name__ == "__main__":
    sys.exit(main())
