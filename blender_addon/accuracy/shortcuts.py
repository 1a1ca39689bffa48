# SPDX-License-Identifier: GPL-3.0-or-later
"""What the approximations of Seyb et al. 2020 ("The design and evolution of the UberBake light baking system") cost
and save on a level with light sets and doors: each with it and without, against the truth of the same states."""
from dataclasses import dataclass

import numpy as np

from . import bakes, measure, still

RANDOM_STATES, RANDOM_SEED = 3, 11
DOOR_BOUNCES = 1
THRESHOLD, FINE_THRESHOLD = 0.01, 0.001  # all entries of a large level would not fit into memory


@dataclass
class Side:
    """One side of a comparison."""

    how: str
    lights: list  # luminance at the points by two seeds, states one after another
    error: measure.Error
    seconds: float  # of a bake


@dataclass
class Shortcut:
    """An approximation, and the same light without it."""

    name: str
    taken: Side
    avoided: Side
    apart: measure.Band  # how much of the light it changes
    ajar: str  # which of the two the preset does

    def as_json(self):
        sides = {"with": self.taken, "without": self.avoided}
        told = {k: {"how": s.how, "seconds": s.seconds, **s.error.as_json()} for k, s in sides.items()}
        return {"name": self.name, "ajar": self.ajar, "apart": self.apart.as_json(), **told}


def random_states(elements, count):
    """Weights of states in which each light set is on and each door open by even chance, but the first has all doors
    open; toggles stay."""
    random = np.random.default_rng(RANDOM_SEED)
    own = [float(e["weight"]) for e in elements]
    draws = random.integers(0, 2, (count, len(elements)))
    states = [
        [own[i] if e["kind"] == "toggle" else float(draw[i]) for i, e in enumerate(elements)]
        for draw in draws
    ]
    return [all_doors_open(elements, states[0]), *states[1:]]


def all_doors_open(elements, weights):
    """The state with every door open."""
    return [1.0 if e["kind"] == "door" else float(w) for e, w in zip(elements, weights)]


def few_states(elements, weights):
    """Share of a term in a state, as n + m + 1 lightmaps give it: sets add up with the doors closed, and each
    door adds what it changes with all sets on."""
    kinds = [e["kind"] for e in elements]

    def share(term):
        sets, doors, out = [], [], 1.0
        for e in term:
            if kinds[e] == "toggle":
                out *= weights[e]
            else:
                (doors if kinds[e] == "door" else sets).append(e)
        if len(doors) > 1 or len(sets) > 1:
            return 0.0
        return out * float(weights[doors[0]] if doors else weights[sets[0]] if sets else 1.0)

    return share


class Comparison:
    """Measures the approximations. study: accuracy.study.Study after its truth is traced."""

    def __init__(self, study, states):
        self._study = study
        self._scene = study.base_scene
        elements = self._scene.elements
        self._random = random_states(elements, states)
        self._open = all_doors_open(elements, study.weights)
        self._has_doors = any(e["kind"] == "door" for e in elements)

    def run(self):
        """All of them."""
        states = [*self._random, self._open]
        parts = len(states) + (2 if self._has_doors else 0)
        self._seconds = self._study.wishes.reference_seconds / parts
        traced = [self._study.trace_state(np.float32(s), self._seconds) for s in states]
        self._kept = np.all([self._study.same_places(reference) for _, reference in traced], axis=0)
        self._truths = [measure.Truth(t.luminance[self._kept], t.stderr[self._kept]) for t, _ in traced]
        mixes = [bakes.product_of(s) for s in states]
        mixes += [few_states(self._scene.elements, s) for s in self._random]
        self._own = self._bake(self._scene, {}, mixes)
        out = [self._states(), self._threshold()]
        if self._has_doors:
            out += [self._door_bounces(), self._leaf()]
        return [s for s in out if s is not None]

    def _bake(self, scene, settings, mixes):
        study = self._study
        return study.bake(scene, {**study.settings, **settings}, mixes)

    def _lights(self, maps, mixes):
        """Luminance at the points, of two bakes, in several states one after another."""
        pages, uv = (x[self._kept] for x in self._study.places(self._scene))
        return [np.concatenate([m.luminance(pages, uv, mix) for mix in mixes]) for m in maps]

    @staticmethod
    def _join(truths):
        return measure.Truth(
            *(np.concatenate([getattr(t, k) for t in truths]) for k in ("luminance", "stderr"))
        )

    def _side(self, how, maps, mixes, truths, seconds=None):
        own = min(m.seconds for m in maps) if seconds is None else seconds
        lights = self._lights(maps, mixes)
        return Side(how, lights, measure.error(self._join(truths), *lights), own)

    def _shortcut(self, name, taken, avoided, truths, ajar):
        apart = measure.apart(self._join(truths).scale, taken.lights, avoided.lights)
        return Shortcut(name, taken, avoided, apart, ajar)

    def _single(self, settings):
        """Seconds of one bake."""
        return self._study.bake_once({**self._study.settings, **settings}).seconds

    def _states(self):
        count, own = len(self._random), self._study.settings["combinations"]
        truths = self._truths[:count]
        fewer = self._single({"combinations": "NONE"})
        few = range(count + 1, 2 * count + 1)
        return self._shortcut(
            "one lightmap per set and door (n + m + 1)",
            self._side("doors change with all lights on", self._own, few, truths, fewer),
            self._side(f"products of elements, {own}", self._own, range(count), truths),
            truths,
            "without" if own != "NONE" else "with",
        )

    def _threshold(self):
        count, mixes = len(self._random), [bakes.product_of(s) for s in self._random]
        truths, own = self._truths[:count], round(self._study.settings["term_threshold"], 6)
        sides = []
        for threshold, how in (
            (THRESHOLD, "entries under 1% dropped"),
            (FINE_THRESHOLD, "entries under 0.1% dropped"),
        ):
            same = threshold == own
            maps = self._own if same else self._bake(self._scene, {"term_threshold": threshold}, mixes)
            sides.append(self._side(how, maps, range(count), truths))
        return self._shortcut("1% threshold", *sides, truths, "with" if own == THRESHOLD else f"{own:.1%}")

    def _door_bounces(self):
        truths = self._truths[-1:]
        references = [
            self._study.trace_state(
                np.float32(self._open), self._seconds, seed=seed, door_bounces=DOOR_BOUNCES
            )[1]
            for seed in (31, 32)
        ]
        lights = [r.luminance[self._kept] for r in references]
        seconds = self._single({"bounces": DOOR_BOUNCES})
        few = Side("traced so", lights, measure.error(truths[0], *lights), seconds)
        all_of_it = self._side("all bounces", self._own, [len(self._random)], truths)
        # Both sides are seen by brute force: texels and noise of a bake would hide it.
        return Shortcut("one bounce behind doors", few, all_of_it, few.error.bias, "without")

    def _leaf(self):
        if not any(i.get("open_pose") for i in self._scene.data["instances"]):
            return None
        folder = still.without_open_poses(self._scene.folder)
        maps = self._bake(bakes.SceneFile(folder), {}, [bakes.product_of(self._open)])
        truths = self._truths[-1:]
        return self._shortcut(
            "the open leaf ignored",
            self._side("doors vanish", maps, [0], truths),
            self._side("doors stand open", self._own, [len(self._random)], truths),
            truths,
            "without",
        )
