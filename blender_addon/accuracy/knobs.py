# SPDX-License-Identifier: GPL-3.0-or-later
"""Which settings are tried: each knob on its own around the preset, and the presets themselves."""
from dataclasses import dataclass, field

from .. import model
from . import bakes

PRESET = "preset"


@dataclass
class Trial:
    """One setting. cost is its time over the preset's, guessed, for the budget."""

    knob: str
    value: object
    settings: dict
    density: float = 1.0  # over the preset's
    cost: float = 1.0
    results: dict = field(default_factory=dict)

    @property
    def name(self):
        return f"{self.value}" if self.knob == PRESET else f"{self.knob} {show(self.value)}"


def show(value):
    """A value as people write it."""
    return f"{value:g}" if isinstance(value, float) else str(value)


def _power_of_two(x):
    return 1 << max(0, round(x) - 1).bit_length()


def plan(preset, base, density, has_elements, quick):
    """All trials, the preset first, then the cheapest first. base: its settings."""
    trials = [Trial(PRESET, preset, {})]
    for steps in (_presets(preset), _density(density, quick), _noise(base, quick), _bounce_rays(base, quick)):
        trials += steps
    trials += _positions(base, quick) + _bounces(base, quick) + _rays(quick)
    if has_elements:
        trials += _terms(base, quick)
    return trials[:1] + sorted(trials[1:], key=lambda t: t.cost)


def _presets(preset):
    cost = {"draft": 0.25, "preview": 1.0, "production": 10.0}
    return [
        Trial(PRESET, name, dict(bakes.presets()[name]), cost=cost[name] / cost.get(preset, 40.0))
        for name in cost
        if name != preset
    ]


def density_factors(quick):
    """The texel densities tried, over the preset's."""
    return (0.5, 2.0) if quick else (0.5, 0.71, 1.41, 2.0)


def _density(density, quick):
    steps = density_factors(quick)
    return [Trial("texels per metre", round(density * f, 2), {}, f, f * f) for f in steps]


def _noise(base, quick):
    """The target moves its cap along: halving the noise takes four times the rays."""
    target = base["noise_target"] or model.PRESETS["PREVIEW"]["noise_target"]
    trials = []
    for f in (2.0, 0.5) if quick else (4.0, 2.0, 0.5, 0.25):
        caps = {
            k: min(1 << 16, max(16, _power_of_two(base[k] / (f * f)))) for k in ("samples", "direct_samples")
        }
        noise = min(target * f, 1.0)
        trials.append(
            Trial("noise target", round(noise, 5), {"noise_target": noise, **caps}, cost=1.0 / (f * f))
        )
    return trials


def _bounce_rays(base, quick):
    steps = (0.25, 4.0) if quick else (0.25, 0.5, 2.0, 4.0, 8.0)
    values = [_power_of_two(base["bounce_samples"] * f) for f in steps]
    return [Trial("rays per bounce", v, {"bounce_samples": v}) for v in values if 4 <= v <= 1 << 16]


def _positions(base, quick):
    values = (1, 16) if quick else (1, 2, 4, 9, 16)
    own = base["positions_per_texel"]
    return [Trial("positions per texel", v, {"positions_per_texel": v}) for v in values if v != own]


def _bounces(base, quick):
    values = (1, 3) if quick else (0, 1, 2, 3, 4, 8, 12)
    return [Trial("bounces", v, {"bounces": v}) for v in values if v != base["bounces"]]


def _rays(quick):
    values = (64, 512) if quick else (32, 128, 512, 2048)
    return [
        Trial("rays per texel", v, {"noise_target": 0.0, "samples": v, "direct_samples": v}, cost=v / 256)
        for v in values
    ]


def _thresholds(base, quick):
    values = (0.001, 0.05) if quick else (0.001, 0.003, 0.03, 0.1)
    return [Trial("keep threshold", v, {"term_threshold": v}) for v in values if v != base["term_threshold"]]


def _terms(base, quick):
    rays = (0.0,) if quick else (0.0, 0.1, 1.0)
    trials = [Trial("door rays", v, {"door_rays": v}) for v in rays if v != base["door_rays"]]
    words = [w for w in bakes.combinations() if w != base["combinations"]]
    return (
        trials
        + _thresholds(base, quick)
        + [Trial("combinations", w.lower(), {"combinations": w}) for w in words]
    )
