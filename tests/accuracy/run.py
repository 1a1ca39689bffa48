# SPDX-License-Identifier: GPL-3.0-or-later
"""Measure the error of bakes against time on a level; `./dev accuracy` runs this after a build.

    ./dev accuracy FILE.blend --out DIR [--points 2000] [--density D] [--quick] [--preset NAME] [--state NAME=W ...]

The level is exported once per texel density. A brute force reference traces random points of it; then bakes along
each knob around the preset are compared with it. Leaves DIR/accuracy.html (self-contained), .csv and .json.
"""
import argparse
import subprocess
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
import advice  # noqa: E402
import bakes  # noqa: E402
import knobs  # noqa: E402
import measure  # noqa: E402
import page  # noqa: E402
import storage  # noqa: E402

LIBRARY = bakes.ROOT / "build" / "release" / "lib" / "libajar.so"
TRUE_BOUNCES = 32
SEEDS = (101, 202)


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
    for name, full, quick in (
        ("points", 2000, 1000),
        ("preset", "preview", "draft"),
        ("reference_seconds", 600.0, 60.0),
        ("budget", 3600.0, 240.0),
    ):
        if getattr(args, name) is None:
            setattr(args, name, quick if args.quick else full)
    args.state = dict(_weight(text) for text in args.state)
    return args


def _weight(text):
    name, _, weight = text.rpartition("=")
    try:
        return name, float(weight)
    except ValueError:
        raise SystemExit(f"accuracy: --state {text}: not NAME=WEIGHT")


class Run:
    """One measurement."""

    def __init__(self, args):
        self.args = args
        self.out = args.out.absolute()
        self.out.mkdir(parents=True, exist_ok=True)
        self.library = bakes.load(LIBRARY)
        self.scenes = {}
        self.base_scene = self.scene(1.0)
        self.weights = self.base_scene.weights(args.state)
        self.settings = {**self.base_scene.data["settings"], **bakes.presets()[args.preset]}
        self.skipped = []

    def scene(self, factor):
        """The level at a density, over the wanted one; exported on first use."""
        if factor not in self.scenes:
            density = self.args.density
            if factor != 1.0:
                density = factor * self.density()
            self.scenes[factor] = bakes.SceneFile(self.export(density, f"{factor:g}"))
        return self.scenes[factor]

    def density(self):
        """Texels per metre of the preset."""
        return self.args.density or float((self.out / "export_1" / "density").read_text(encoding="utf-8"))

    def export(self, density, name):
        folder = self.out / f"export_{name}"
        folder.mkdir(exist_ok=True)
        command = ["blender", "-b", str(self.args.file), "-noaudio", "--python-exit-code", "1"]
        command += [
            "-P",
            str(bakes.ROOT / "tests" / "bench" / "save_snapshot.py"),
            "--",
            "--out",
            str(folder),
        ]
        command += ["--density", str(density)] if density else []
        with open(folder / "export.log", "w", encoding="utf-8") as log:
            if subprocess.run(command, stdout=log, stderr=subprocess.STDOUT).returncode != 0:
                sys.exit(f"accuracy: {self.args.file} could not be exported, see {folder / 'export.log'}")
        return folder / "snapshot"

    def trace(self):
        """The truth at the points."""
        args = self.args
        self.reference = bakes.Reference(
            self.library, self.base_scene, self.weights, TRUE_BOUNCES, args.points, args.reference_seconds
        )
        self.truth = measure.Truth(self.reference.luminance, self.reference.stderr)
        say(f"reference: {self.reference.batches} batches, {advice.percent(self.truth.noise())} per point")

    def places(self, scene):
        """(pages, uv) of the points, checked to be the same places of the level at any density."""
        points = self.reference.points
        here = scene.positions(points)
        if scene is not self.base_scene and not np.allclose(
            here, self.base_scene.positions(points), atol=1e-4
        ):
            raise RuntimeError("the level's triangles are not the same at another density")
        return scene.page_uv(points)

    def measure(self, trial):
        """Bakes a trial twice."""
        scene = self.scene(trial.density)
        settings = {**self.settings, **trial.settings}
        maps = [
            bakes.Lightmaps(self.library, scene, self.weights, **{**settings, "seed": seed}) for seed in SEEDS
        ]
        pages, uv = self.places(scene)
        lights = [m.luminance(pages, uv) for m in maps]
        estimated, true = measure.estimate_check(*maps)
        reports = [m.report for m in maps]
        trial.results = {
            "seconds": min(m.seconds for m in maps),
            "wall": min(m.wall for m in maps),
            "texels": reports[0]["receivers"]["texels"],
            "rays": reports[0]["rays"]["total"],
            "error": measure.error(self.truth, *lights),
            "estimated": estimated,
            "true": true,
            "report_rms": reports[0]["error"]["estimated_rms"],
            "report_rms_other_seed": reports[1]["error"]["estimated_rms"],
        }
        e = trial.results["error"]
        say(
            f"{trial.name:32} {advice.duration(trial.results['seconds']):>8}  error {advice.percent(e.total.value)}"
            f"  noise {advice.percent(e.noise.value)}  bias {advice.percent(e.bias.value)}"
        )

    def bakes(self):
        """All trials that the budget allows, the preset first."""
        watch = bakes.Stopwatch()
        preset, *others = knobs.plan(
            self.args.preset, self.settings, self.density(), bool(self.base_scene.elements), self.args.quick
        )
        self.measure(preset)
        preset.results["knob_values"] = {
            "texels per metre": self.density(),
            "noise target": self.settings["noise_target"],
            "rays per bounce": self.settings["bounce_samples"],
            "positions per texel": self.settings["positions_per_texel"],
            "bounces": self.settings["bounces"],
            "keep threshold": self.settings["term_threshold"],
        }
        for trial in others:
            if watch.wall() + 2 * trial.cost * preset.results["wall"] > self.args.budget:
                self.skipped.append(trial.name)
            else:
                self.measure(trial)
        return [preset] + [t for t in others if t.results]

    def storage(self):
        """Error of each way to store directional light, over tilted normals; nothing with elements, whose SH are
        not kept."""
        if self.base_scene.elements:
            return {}
        pages, uv = self.places(self.base_scene)
        maps = [
            bakes.Lightmaps(
                self.library,
                self.base_scene,
                self.weights,
                **{**self.settings, "keep_sh": True, "seed": seed},
            )
            for seed in SEEDS
        ]
        squares = {}
        for n in storage.NORMALS:
            seconds = self.args.reference_seconds / len(storage.NORMALS)
            tilted = bakes.Reference(
                self.library, self.base_scene, self.weights, TRUE_BOUNCES, self.args.points, seconds, 7, n
            )
            truth = measure.Truth(tilted.luminance, tilted.stderr)
            first, second = (storage.formats(m, pages, uv, n) for m in maps)
            for name in first:
                squares.setdefault(name, []).append(measure.error(truth, first[name], second[name]).squares)
        return {name: measure.band_of(np.mean(parts, axis=0)) for name, parts in squares.items()}

    def about(self):
        """What the page says of itself."""
        state = ", ".join(f"{e['name']} {w:g}" for e, w in zip(self.base_scene.elements, self.weights))
        return {
            "scene": self.args.file.stem,
            "preset": self.args.preset,
            "density": self.density(),
            "points": self.args.points,
            "floor": self.truth.floor,
            "mean_luminance": float(self.truth.luminance.mean()),
            "reference_bounces": TRUE_BOUNCES,
            "reference_noise": self.truth.noise(),
            "reference_seconds": self.reference.wall,
            "batches": self.reference.batches,
            "threads": bakes.threads(),
            "state": state or "no elements",
            "skipped": self.skipped,
        }


def say(text):
    """A line of progress."""
    print(text, flush=True)


def main(arguments):
    args = parse(arguments)
    if not args.file.is_file():
        sys.exit(f"accuracy: no such file: {args.file}")
    run = Run(args)
    run.trace()
    trials = run.bakes()
    stored = run.storage()
    about = run.about()
    words = advice.recommend(trials, trials[0], measure.differs, run.truth.noise())
    rows = [page.row(t, advice.frontier(trials)) for t in trials]
    page.write_csv(run.out / "accuracy.csv", rows)
    formats = {name: band.as_json() for name, band in stored.items()}
    bakes.write_json(
        run.out / "accuracy.json", {"about": about, "advice": words, "trials": rows, "storage": formats}
    )
    page.write_page(run.out / "accuracy.html", about, trials, trials[0], words, stored)
    print("\n" + "\n".join(words))
    print(f"written to {run.out / 'accuracy.html'}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
