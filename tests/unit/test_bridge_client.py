# SPDX-License-Identifier: GPL-3.0-or-later
"""The client against stand-in workers: every way a process can end gives one final event."""
import os
import signal
import sys
import time

import pytest

from blender_addon.bridge.client import WorkerClient, clean_environment, describe_exit, parse_event

HEAD = "import sys, json, time, os, signal\ndef say(**e): print(json.dumps(e), flush=True)\n"


@pytest.fixture
def start(tmp_path):
    clients = []

    def run(body):
        script = tmp_path / "worker.py"
        script.write_text(HEAD + body)
        clients.append(WorkerClient([], python=sys.executable, worker=script))
        return clients[-1]

    yield run
    for client in clients:
        client.close()


def collect(client, seconds=20):
    events, end = [], time.monotonic() + seconds
    while client.running:
        assert time.monotonic() < end, "no final event"
        events += client.poll()
        time.sleep(0.01)
    return events


def test_events_in_order(start):
    client = start(
        "for i in range(500): say(event='progress', fraction=i/500)\n"
        "say(event='done', package='p', report='r')"
    )
    events = collect(client)
    assert [e["event"] for e in events] == ["progress"] * 500 + ["done"]
    assert client.outcome["package"] == "p" and client.poll() == []


def test_noise_on_stdout_is_ignored(start):
    events = collect(start("print('hello'); print('[1]'); print('{\"a\": 1}'); say(event='done')"))
    assert [e["event"] for e in events] == ["done"]


def test_poll_does_not_wait(start):
    client = start("time.sleep(30)")
    begin = time.monotonic()
    assert client.poll() == [] and client.running
    assert time.monotonic() - begin < 0.2
    client.kill()
    assert collect(client)[-1] == {"event": "cancelled"}


def test_cancel_reaches_the_worker(start):
    client = start(
        "say(event='progress', fraction=0)\nline = sys.stdin.readline()\n"
        "say(event='cancelled' if line == 'cancel\\n' else 'error', code=0, message=line)\nsys.exit(2)"
    )
    client.cancel()
    assert collect(client)[-1]["event"] == "cancelled"


def test_death_by_signal(start):
    events = collect(start("os.kill(os.getpid(), signal.SIGKILL)"))
    assert events[-1]["event"] == "error" and "signal 9" in events[-1]["message"]
    assert "out of memory" in events[-1]["message"]


def test_crash_keeps_stderr(start):
    events = collect(start("say(event='progress', fraction=0.1)\nraise SystemError('boom')"))
    assert [e["event"] for e in events] == ["progress", "error"]
    assert "exit code 1" in events[-1]["message"] and "boom" in events[-1]["detail"]


def test_nothing_after_the_final_event(start):
    events = collect(
        start(
            "say(event='error', code=-5, message='m', culprit='Cube')\n" "say(event='progress')\nsys.exit(1)"
        )
    )
    assert [e["event"] for e in events] == ["error"]


def test_large_stderr_does_not_block(start):
    events = collect(start("for i in range(20000): sys.stderr.write('y' * 80 + '\\n')\nsay(event='done')"))
    assert events[-1]["event"] == "done"


def test_close_ends_a_stubborn_worker(start):
    client = start("signal.signal(signal.SIGTERM, signal.SIG_IGN)\ntime.sleep(60)")
    client.close(patience=0.2)
    client.close()
    assert client._process.returncode is not None


def test_environment_is_clean(monkeypatch):
    monkeypatch.setenv("PYTHONPATH", "/x")
    monkeypatch.setenv("PYTHONHOME", "/y")
    monkeypatch.setenv("AJAR_LIBRARY", "/z")
    environment = clean_environment({"MORE": "1"})
    assert "PYTHONPATH" not in environment and "PYTHONHOME" not in environment
    assert (
        environment["PYTHONNOUSERSITE"] == "1"
        and environment["AJAR_LIBRARY"] == "/z"
        and environment["MORE"] == "1"
    )


def test_words():
    assert parse_event(b"nonsense") is None and parse_event(b'{"event": 3}') is None
    assert describe_exit(-11) == "worker died (signal 11)"
    assert "code 3" in describe_exit(3)
    assert os.name != "posix" or signal.SIGKILL == 9
