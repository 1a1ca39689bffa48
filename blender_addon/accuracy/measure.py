# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors of bakes against a reference, parted into bias and noise.

An error is relative: (bake - truth) / (truth + floor), in luminance, and counts as 100% at most: a lit texel where
no light is must not outweigh a whole level. Two bakes that differ only in their
seed have independent noise, so half the squared difference is the noise and the product of their errors the
squared bias, once the reference's own noise is taken off. All are root mean squares over the points.
"""
from dataclasses import dataclass, field

import numpy as np

FLOOR = 0.05  # of the mean light: darker than this counts as this dark
WORST = 0.02  # of the points
RESAMPLES = 300
BAND = (5.0, 95.0)  # percent of the resamples


@dataclass
class Truth:
    """The reference at K points: luminance and standard error, W/m^2."""

    luminance: np.ndarray
    stderr: np.ndarray
    scale: np.ndarray = field(init=False)

    def __post_init__(self):
        self.floor = FLOOR * float(self.luminance.mean())
        self.scale = 1.0 / (self.luminance + self.floor)

    def noise(self):
        """Root mean square of the reference's own relative error."""
        return float(np.sqrt(np.mean((self.stderr * self.scale) ** 2)))


@dataclass
class Band:
    """A number with its confidence band."""

    value: float
    low: float
    high: float

    def as_json(self):
        return {"value": self.value, "low": self.low, "high": self.high}


@dataclass
class Error:
    """Error of one setting."""

    total: Band
    bias: Band
    noise: Band
    mean: float  # signed: too bright or too dark on the whole
    median: float  # of single points, the reference's noise included, as is p95
    p95: float
    worst: float  # share of the squared error that the worst WORST of the points make
    squares: np.ndarray  # per point: squared error less the reference's noise

    def as_json(self):
        parts = {name: getattr(self, name).as_json() for name in ("total", "bias", "noise")}
        return {**parts, **{name: getattr(self, name) for name in ("mean", "median", "p95", "worst")}}


def _root(x):
    return np.sqrt(np.maximum(x, 0.0))


def draws(count, seed=0):
    """Resamples of the points, the same for every setting so that settings can be compared."""
    return np.random.default_rng(seed).integers(0, count, (RESAMPLES, count))


def _band(values, resamples):
    low, high = np.percentile(_root(values[resamples].mean(axis=1)), BAND)
    return Band(float(_root(values.mean())), float(low), float(high))


def _worst_share(squares):
    ordered = np.sort(np.maximum(squares, 0.0))[::-1]
    return float(ordered[: max(1, round(WORST * len(ordered)))].sum() / max(ordered.sum(), 1e-30))


def band_of(squares):
    """Root mean square of squared errors with its band."""
    return _band(squares, draws(len(squares)))


def error(truth, first, second):
    """Error of a setting from two bakes (luminance at the points) with different seeds."""
    a, b = (np.clip((x - truth.luminance) * truth.scale, -1.0, 1.0) for x in (first, second))
    own = (truth.stderr * truth.scale) ** 2
    resamples = draws(len(a))
    squares = 0.5 * (a * a + b * b) - own
    return Error(
        total=_band(squares, resamples),
        bias=_band(a * b - own, resamples),
        noise=_band(0.5 * (a - b) ** 2, resamples),
        mean=float(np.mean(0.5 * (first + second)) / np.mean(truth.luminance) - 1.0),
        median=float(np.median(np.abs(np.concatenate([a, b])))),
        p95=float(np.percentile(np.abs(np.concatenate([a, b])), 95)),
        worst=_worst_share(squares),
        squares=squares,
    )


def apart(scale, pair, other):
    """How far the light of two settings is apart: pairs of bakes with the same two seeds, relative by Truth.scale. What
    differs by chance between the seeds is left out."""
    first, second = (np.clip((a - b) * scale, -1.0, 1.0) for a, b in zip(pair, other))
    return band_of(first * second)


def differs(one, other):
    """Whether two settings differ by more than chance: the band of their paired difference leaves out 0."""
    difference = one.squares - other.squares
    low, high = np.percentile(difference[draws(len(difference))].mean(axis=1), BAND)
    return bool(low > 0.0 or high < 0.0)


def estimate_check(first, second):
    """(estimated, true) noise of a bake's base light over its valid texels, as the report weighs them: the
    standard error that the bake states, and the spread between two seeds."""
    levels, told, seen = [], [], []
    for a, b, error_a, error_b, valid in zip(
        first.base, second.base, first.stderr, second.stderr, first.validity
    ):
        good = valid == 1.0
        levels.append(0.5 * (a + b)[good])
        told.append(0.5 * (error_a**2 + error_b**2)[good])
        seen.append(0.5 * ((a - b) ** 2)[good])
    levels, told, seen = (np.concatenate(x) for x in (levels, told, seen))
    weight = 1.0 / (levels + 0.01 * np.median(levels) + 1e-30) ** 2
    return tuple(float(_root(np.minimum(x * weight, 1.0).mean())) for x in (told, seen))
