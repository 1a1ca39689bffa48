# SPDX-License-Identifier: GPL-3.0-or-later
"""Measure the error of bakes against time on a level; `./dev accuracy` runs this after a build.

    ./dev accuracy FILE.blend --out DIR [--points 2000] [--density D] [--quick] [--preset NAME] [--state NAME=W ...]

The level is exported once per texel density. A brute force reference traces random points of it; then bakes along
each knob around the preset are compared with it. Leaves DIR/accuracy.html (self-contained), .csv and .json. The
add-on's operator ajar.accuracy does the same for the open file.
"""
import argparse
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))
from blender_addon.accuracy import bakes, study  # noqa: E402
from blender_addon.bridge.library import load_library  # noqa: E402

LIBRARY = ROOT / "build" / "release" / "lib" / "libajar.so"


def parse(arguments):
    parser = argparse.ArgumentParser(
        prog="./dev accuracy", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("file", type=Path, help="the level")
    parser.add_argument("--out", type=Path, required=True, help="folder for the page")
    parser.add_argument("--points", type=int, help="points of the reference; default 2000, quick: 1000")
    parser.add_argument("--density", type=float, help="texels per metre; default: the scene's")
    parser.add_argument("--preset", choices=sorted(bakes.presets()), help="default preview, quick: draft")
    parser.add_argument("--quick", action="store_true", help="few settings, minutes instead of an hour")
    parser.add_argument("--reference-seconds", type=float, help="default 600, quick: 60")
    parser.add_argument("--budget", type=float, help="seconds for all bakes; default 3600, quick: 240")
    parser.add_argument("--state", action="append", default=[], metavar="NAME=W", help="weight of an element")
    args = parser.parse_args(arguments)
    args.preset = args.preset or ("draft" if args.quick else "preview")
    args.state = dict(_weight(text) for text in args.state)
    return args


def _weight(text):
    name, _, weight = text.rpartition("=")
    try:
        return name, float(weight)
    except ValueError:
        raise SystemExit(f"accuracy: --state {text}: not NAME=WEIGHT")


class Exporter:
    """Snapshots of the level, made by Blender when they are asked for."""

    def __init__(self, file, out, density):
        self._file, self._out = file, out
        self.density = density
        self._first = self._export(density, "1")
        self.density = density or float((out / "export_1" / "density").read_text(encoding="utf-8"))

    def find(self, factor):
        """Folder of the snapshot at a density, over the wanted one."""
        return self._first if factor == 1.0 else self._export(factor * self.density, f"{factor:g}")

    def _export(self, density, name):
        folder = self._out / f"export_{name}"
        folder.mkdir(parents=True, exist_ok=True)
        script = ROOT / "tests" / "bench" / "save_snapshot.py"
        command = ["blender", "-b", str(self._file), "-noaudio", "--python-exit-code", "1"]
        command += ["-P", str(script), "--", "--out", str(folder)]
        command += ["--density", str(density)] if density else []
        with open(folder / "export.log", "w", encoding="utf-8") as log:
            if subprocess.run(command, stdout=log, stderr=subprocess.STDOUT).returncode != 0:
                sys.exit(f"accuracy: {self._file} could not be exported, see {folder / 'export.log'}")
        return folder / "snapshot"


class Terminal:
    """Prints what a study says."""

    def say(self, text):
        """A line."""
        print(text, flush=True)

    def progress(self, *_):
        """Lines are enough."""

    def cancelled(self):
        """Ctrl-C ends the process."""
        return False


def main(arguments):
    args = parse(arguments)
    if not args.file.is_file():
        sys.exit(f"accuracy: no such file: {args.file}")
    out = args.out.absolute()
    exporter = Exporter(args.file, out, args.density)
    limits = study.limits(
        args.quick, points=args.points, reference_seconds=args.reference_seconds, budget=args.budget
    )
    wishes = study.Wishes(
        args.file.stem, args.preset, exporter.density, args.quick, state=args.state, **limits
    )
    try:
        words = study.Study(load_library(LIBRARY), wishes, exporter.find, Terminal()).run(out)
    except ValueError as error:
        sys.exit(f"accuracy: {error}")
    print("\n" + "\n".join(words))
    print(f"written to {out / study.PAGE}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
