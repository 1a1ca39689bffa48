# SPDX-License-Identifier: GPL-3.0-or-later
"""One measurement of a level: the truth at random points, bakes along each knob, what they say, and the page."""
from dataclasses import dataclass, field

import numpy as np

from . import advice, bakes, knobs, measure, page, pictures, shortcuts, still, storage

TRUE_BOUNCES = 32
SEEDS = (101, 202)
PAGE, TABLE, DATA = "accuracy.html", "accuracy.csv", "accuracy.json"


@dataclass
class Wishes:
    """What to measure, and for how long."""

    name: str  # of the level
    preset: str  # lower case
    density: float  # texels per metre
    quick: bool = False  # few settings
    points: int = 2000
    reference_seconds: float = 600.0
    budget: float = 3600.0  # seconds for all bakes
    state: dict = field(default_factory=dict)  # weights of elements that are not as in the scene


QUICK = {"points": 1000, "reference_seconds": 60.0, "budget": 240.0}


def limits(quick, **given):
    """Points and seconds by name; what is None takes its default."""
    known = {name: getattr(Wishes, name) for name in QUICK}
    known.update(QUICK if quick else {})
    known.update({name: value for name, value in given.items() if value is not None})
    return known


class Study:
    """A measurement. find_scene(factor) gives the folder of the level's snapshot at a density, over the wanted one,
    or None; host hears of it: say(text), progress(stage, seconds done, seconds in all), cancelled()."""

    def __init__(self, library, wishes, find_scene, host):
        self.library, self.wishes, self.host = library, wishes, host
        self._find, self._scenes = find_scene, {}
        self._clock, self._stage = bakes.Stopwatch(), "reading the scene"
        self.base_scene = self.scene(1.0)
        self.weights = self.base_scene.weights(wishes.state)
        self.settings = {**self.base_scene.data["settings"], **bakes.presets()[wishes.preset]}
        self.skipped = []
        # Directional storage is measured by as much brute force again, and so are the states of elements.
        self._seconds = wishes.budget + wishes.reference_seconds * (3 if self.base_scene.elements else 2)

    def scene(self, factor):
        """The level at a density, over the wanted one; None if there is none."""
        if factor not in self._scenes:
            folder = self._find(factor)
            self._scenes[factor] = bakes.SceneFile(folder) if folder else None
        return self._scenes[factor]

    def _cancelled(self):
        self.host.progress(self._stage, self._clock.wall(), max(self._seconds, self._clock.wall()))
        return self.host.cancelled()

    def trace_state(self, weights, seconds, scene=None, **choices):
        """The truth at the points, and the reference that found it."""
        reference = bakes.Reference(
            self.library,
            scene or self.base_scene,
            weights,
            TRUE_BOUNCES,
            self.wishes.points,
            seconds,
            cancelled=self._cancelled,
            **choices,
        )
        return measure.Truth(reference.luminance, reference.stderr), reference

    def same_places(self, reference):
        """Which points of a reference are those of the truth: places that another state hides were drawn anew."""
        names = ["instance", "triangle", "u", "v"]
        own, others = self.reference.points, reference.points
        return np.all([own[n] == others[n] for n in names], axis=0)

    def trace(self):
        """The truth."""
        self._stage = "tracing the true light"
        self.truth, self.reference = self.trace_state(self.weights, self.wishes.reference_seconds)
        noise = advice.percent(self.truth.noise())
        self.host.say(f"reference: {self.reference.batches} batches, {noise} per point")

    def places(self, scene):
        """(pages, uv) of the points, checked to be the same places of the level at any density."""
        points = self.reference.points
        here = scene.positions(points)
        if scene is not self.base_scene and not np.allclose(
            here, self.base_scene.positions(points), atol=1e-4
        ):
            raise RuntimeError("the level's triangles are not the same at another density")
        return scene.page_uv(points)

    def bake_once(self, settings, scene=None, mixes=()):
        """One bake, of the level at the wanted density unless told otherwise."""
        scene = scene or self.base_scene
        weights = self.weights if scene.elements else ()
        return bakes.Lightmaps(self.library, scene, weights, self._cancelled, mixes, **settings)

    def bake(self, scene, settings, mixes=()):
        """Two bakes that differ in their seeds."""
        return [self.bake_once({**settings, "seed": seed}, scene, mixes) for seed in SEEDS]

    def measure(self, trial):
        """Bakes a trial twice and compares. False if its density is not there."""
        self._stage = f"baking: {trial.name}"
        scene = self.scene(trial.density)
        if scene is None:
            return False
        maps = self.bake(scene, {**self.settings, **trial.settings})
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
        if trial.name == self.wishes.preset:
            self.pictures = pictures.of_pages(maps[0], pages, uv, np.sqrt(np.maximum(e.squares, 0.0)))
        self.host.say(
            f"{trial.name:32} {advice.duration(trial.results['seconds']):>8}  error {advice.percent(e.total.value)}"
            f"  noise {advice.percent(e.noise.value)}  bias {advice.percent(e.bias.value)}"
        )
        return True

    def bakes(self):
        """All trials that the budget allows, the preset first."""
        wishes, watch = self.wishes, bakes.Stopwatch()
        preset, *others = knobs.plan(
            wishes.preset, self.settings, wishes.density, bool(self.base_scene.elements), wishes.quick
        )
        self.measure(preset)
        preset.results["knob_values"] = {
            "texels per metre": wishes.density,
            "noise target": self.settings["noise_target"],
            "rays per bounce": self.settings["bounce_samples"],
            "positions per texel": self.settings["positions_per_texel"],
            "bounces": self.settings["bounces"],
            "keep threshold": self.settings["term_threshold"],
            "door rays": self.settings["door_rays"],
        }
        for trial in others:
            if watch.wall() + 2 * trial.cost * preset.results["wall"] > wishes.budget:
                self.skipped.append(f"{trial.name} (out of time)")
            elif not self.measure(trial):
                self.skipped.append(f"{trial.name} (no lightmap layout)")
        return [preset] + [t for t in others if t.results]

    def storage(self):
        """Error of each way to store directional light, over tilted normals. A level with elements is measured with
        all its light sets on and nothing else changed."""
        self._stage = "ways to store directions"
        scene = self.base_scene
        if scene.elements:
            scene = bakes.SceneFile(still.without_elements(scene.folder))
        pages, uv = self.places(self.base_scene)
        maps = self.bake(scene, {**self.settings, "keep_sh": True})
        squares = {}
        for n in storage.NORMALS:
            seconds = self.wishes.reference_seconds / len(storage.NORMALS)
            truth, reference = self.trace_state((), seconds, scene, seed=7, normal=n)
            same = self.same_places(reference)
            truth = measure.Truth(truth.luminance[same], truth.stderr[same])
            first, second = (storage.formats(m, pages[same], uv[same], n) for m in maps)
            for name in first:
                squares.setdefault(name, []).append(measure.error(truth, first[name], second[name]).squares)
        return {name: measure.band_of(np.mean(parts, axis=0)) for name, parts in squares.items()}

    def shortcuts(self):
        """What approximations cost in levels with elements."""
        if not self.base_scene.elements:
            return []
        self._stage = "what approximations cost"
        states = 1 if self.wishes.quick else shortcuts.RANDOM_STATES
        return shortcuts.Comparison(self, states).run()

    def about(self):
        """What the page says of itself."""
        state = ", ".join(f"{e['name']} {w:g}" for e, w in zip(self.base_scene.elements, self.weights))
        return {
            "scene": self.wishes.name,
            "preset": self.wishes.preset,
            "density": self.wishes.density,
            "points": self.wishes.points,
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

    def run(self, out):
        """Measures, and leaves page, table and JSON in a folder. Returns what they say, in sentences."""
        self.trace()
        trials = self.bakes()
        stored, cuts, about = self.storage(), self.shortcuts(), self.about()
        words = advice.recommend(trials, trials[0], measure.differs, self.truth.noise())
        rows = [page.row(t, advice.frontier(trials)) for t in trials]
        out.mkdir(parents=True, exist_ok=True)
        page.write_csv(out / TABLE, rows)
        formats = {name: band.as_json() for name, band in stored.items()}
        told = [s.as_json() for s in cuts]
        data = {"about": about, "advice": words, "trials": rows, "storage": formats, "shortcuts": told}
        bakes.write_json(out / DATA, data)
        page.write_page(out / PAGE, about, trials, words, page.Extras(stored, cuts, self.pictures))
        return words
