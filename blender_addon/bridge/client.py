# SPDX-License-Identifier: GPL-3.0-or-later
"""Starts, watches and stops the worker process (no bpy; poll it from a timer or a loop)."""

import json
import os
import queue
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

from . import abi

WORKER = Path(__file__).resolve().parent / "worker.py"
ACCURACY_WORKER = WORKER.parent.parent / "accuracy" / "worker.py"
_FINAL = {"done", "cancelled", "error"}
_STDERR_LINES = 40


class WorkerClient:
    """One worker process.

    poll() returns the events since the last call; the last one ever is 'done', 'cancelled' or
    'error', whatever happened to the process. Release with close().
    """

    def __init__(self, arguments, python=None, worker=WORKER, environment=None):
        """Starts `worker.py arguments`; raises OSError if the interpreter cannot be started."""
        command = [str(python or sys.executable or shutil.which("python3")), "-s", "-E", "-B", str(worker)]
        self.outcome = None  # the final event, once poll() has returned it
        self._lines, self._errors = queue.SimpleQueue(), []
        self._asked = False
        self._process = subprocess.Popen(
            command + [str(a) for a in arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=clean_environment(environment),
            **_process_options(),
        )
        self._threads = [_start(self._read_events), _start(self._read_errors)]

    @classmethod
    def bake(cls, directory, package, report, spent=0.0, **options):
        """Worker that bakes a snapshot directory into package (directory) and report (file). spent: seconds of a
        time limit that are gone already."""
        arguments = ["bake", directory, "--package", package, "--report", report, "--spent", str(spent)]
        return cls(arguments, **options)

    @classmethod
    def predict(cls, directory, **options):
        """Worker that predicts what bakes of a snapshot directory would take (see worker.predict)."""
        return cls(["predict", directory], **options)

    @classmethod
    def layout(cls, directory, **options):
        """Worker that answers a layout request directory."""
        return cls(["layout", directory], **options)

    @classmethod
    def accuracy(cls, directory, out, **options):
        """Worker that measures snapshots (see accuracy/worker.py) and leaves its page in out (directory)."""
        return cls([directory, "--out", out], worker=ACCURACY_WORKER, **options)

    @property
    def running(self):
        """Whether the final event is still to come."""
        return self.outcome is None

    @property
    def pid(self):
        return self._process.pid

    def poll(self):
        """Events since the last call, without waiting."""
        # Threads first: when they have ended, everything is in the queue.
        ended = self._process.poll() is not None and not any(t.is_alive() for t in self._threads)
        events = []
        while self.running:
            try:
                event = self._lines.get_nowait()
            except queue.Empty:
                break
            events.append(event)
            if event["event"] in _FINAL:
                self.outcome = event
        if ended and self.running:
            self.outcome = self._death()
            events.append(self.outcome)
        return events

    def events(self, interval=0.1):
        """Yields events until the final one: the waiting form, for background use."""
        while self.running:
            yield from self.poll()
            if self.running:
                time.sleep(interval)

    def cancel(self):
        """Asks the worker to stop; the final event follows within a second or so."""
        self._asked = True
        try:
            self._process.stdin.write(b"cancel\n")
            self._process.stdin.flush()
        except (OSError, ValueError):
            pass

    def kill(self):
        """Ends the process at once. The package at its target stays the old one or none."""
        self._asked = True
        self._process.kill()

    def close(self, patience=2.0):
        """Ends the process (cancel, then kill) if it runs, and frees pipes. Safe to call twice."""
        if self._process.poll() is None:
            self.cancel()
            try:
                self._process.wait(patience)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        for thread in self._threads:
            thread.join(1.0)
        for pipe in (self._process.stdin, self._process.stdout, self._process.stderr):
            try:
                pipe.close()
            except OSError:
                pass

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def _read_events(self):
        for line in self._process.stdout:
            event = parse_event(line)
            if event is not None:
                self._lines.put(event)

    def _read_errors(self):
        for line in self._process.stderr:
            self._errors.append(line.decode("utf-8", "replace").rstrip())
            del self._errors[:-_STDERR_LINES]

    def _death(self):
        """The final event of a process that ended without one."""
        code = self._process.returncode
        if self._asked:
            return {"event": "cancelled"}
        return {
            "event": "error",
            "code": abi.ERROR_INTERNAL,
            "culprit": "",
            "message": describe_exit(code),
            "detail": "\n".join(self._errors),
        }


def parse_event(line):
    """One line of the worker as an event dict; None for anything else on its stdout."""
    try:
        event = json.loads(line)
    except ValueError:
        return None
    return event if isinstance(event, dict) and isinstance(event.get("event"), str) else None


def describe_exit(code):
    """English for an exit code without a final event."""
    if code < 0:
        hint = ", out of memory?" if -code == getattr(signal, "SIGKILL", 9) else ""
        return f"worker died (signal {-code}){hint}"
    if code in {0xC0000017, 0xC000012D}:  # Windows: no memory, commitment limit
        return f"worker died (exit code {code:#x}), out of memory?"
    return f"worker ended with exit code {code} without a result"


def clean_environment(extra=None):
    """os.environ without Python's own variables, plus extra; sys.executable needs none of them."""
    environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")}
    environment.update({"PYTHONNOUSERSITE": "1", "PYTHONUNBUFFERED": "1"})
    environment.update(extra or {})
    return environment


def _process_options():
    if sys.platform == "win32":
        return {"creationflags": subprocess.BELOW_NORMAL_PRIORITY_CLASS | subprocess.CREATE_NO_WINDOW}
    return {"start_new_session": True}  # Ctrl-C in Blender's terminal must not hit the worker


def _start(target):
    thread = threading.Thread(target=target, daemon=True)
    thread.start()
    return thread
