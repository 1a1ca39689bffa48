# SPDX-License-Identifier: GPL-3.0-or-later
"""Worker process that measures the accuracy of bakes apart from Blender (standard library and numpy).

    python3 worker.py DIR --out OUT_DIR

DIR holds request.json, the wishes as study.Wishes names them, and a snapshot per texel density in a folder
named by its factor: DIR/1, DIR/0.5. Speaks as bridge/worker.py does; the last event, done, has the page and
what it says.
"""
import argparse
import importlib.util
import json
import sys
from pathlib import Path

ADDON = Path(__file__).resolve().parent.parent
REQUEST = "request.json"


def snapshot_folder(directory, factor):
    """Where the snapshot of a texel density, over the wanted one, lies."""
    return Path(directory) / f"{factor:g}"


def load_addon():
    """Makes the add-on importable under its name, and nothing else that lies beside it."""
    spec = importlib.util.spec_from_file_location(
        "ajar", ADDON / "__init__.py", submodule_search_locations=[str(ADDON)]
    )
    module = sys.modules["ajar"] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)


class Teller:
    """Passes what a study says on as events."""

    def __init__(self, host):
        self._host, self.cancelled = host, host.cancel.is_set

    def say(self, text):
        """One finished step."""
        self._host.send("log", text=text)

    def progress(self, stage, done, total):
        """Seconds done of seconds in all."""
        self._host.send("progress", stage=stage, fraction=round(done / total, 5), remaining=total - done)


def require_numpy():
    """Blender brings numpy with it, but it may run its scripts with an interpreter that has none."""
    from ajar.bridge import abi
    from ajar.bridge.library import BakeError

    if importlib.util.find_spec("numpy") is None:
        raise BakeError(abi.ERROR_INPUT, f"measuring needs numpy: install it for {sys.executable}", "python")


def measure(library, host, arguments):
    """Runs a study; returns the exit code."""
    from ajar.bridge.worker import CANCELLED, DONE

    require_numpy()
    from ajar.accuracy import engine, study

    wishes = study.Wishes(**json.loads((arguments.directory / REQUEST).read_text(encoding="utf-8")))

    def find(factor):
        folder = snapshot_folder(arguments.directory, factor)
        return folder if folder.is_dir() else None

    try:
        words = study.Study(library, wishes, find, Teller(host)).run(arguments.out)
    except engine.Cancelled:
        return CANCELLED
    host.send("done", page=str(arguments.out / study.PAGE), advice=words)
    return DONE


def main():
    """Entry point; returns the exit code."""
    parser = argparse.ArgumentParser(prog="worker.py", description="Ajar accuracy worker")
    parser.add_argument("directory", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    arguments = parser.parse_args()
    load_addon()
    from ajar.bridge.worker import serve

    return serve(measure, arguments)


if __name__ == "__main__":
    sys.path.pop(0)  # this folder's modules are the package's
    sys.exit(main())
