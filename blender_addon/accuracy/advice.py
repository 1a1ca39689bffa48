# SPDX-License-Identifier: GPL-3.0-or-later
"""What the numbers say, in words."""
import math

from .measure import WORST


def percent(x):
    """0.0312 -> 3.1%."""
    return f"{100 * x:.2g}%" if x < 0.0995 else f"{100 * x:.0f}%"


def duration(seconds):
    """Seconds as people say them."""
    if seconds < 90:
        return f"{seconds:.2g} s" if seconds < 9.5 else f"{seconds:.0f} s"
    return f"{seconds / 60:.1f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def frontier(trials):
    """Trials that nothing beats in both time and error, fastest first."""
    best = []
    for t in sorted(trials, key=lambda t: t.results["seconds"]):
        if not best or t.results["error"].total.value < best[-1].results["error"].total.value:
            best.append(t)
    return best


def seconds_for(front, wanted):
    """Time for an error by the frontier, straight between its points in logarithms; None if no trial gets there."""
    before = None
    for t in front:
        here, seconds = t.results["error"].total.value, t.results["seconds"]
        if here <= wanted:
            if before is None or here <= 0.0:
                return seconds
            error, then = before
            share = math.log(error / wanted) / math.log(error / here)
            return then * (seconds / then) ** share
        before = here, seconds
    return None


def gains(trials, base, differs):
    """[(trial, error left, seconds more, gain per second)] of each knob's best step up from the preset: settings
    whose error is lower by more than chance. Free ones gain without end."""
    out = {}
    start = base.results["error"].total.value
    for t in trials:
        error, more = t.results["error"].total.value, t.results["seconds"] - base.results["seconds"]
        if t.knob == base.knob or error >= start or not differs(t.results["error"], base.results["error"]):
            continue
        rate = math.log(start / max(error, 1e-9)) / more if more > 0.0 else math.inf
        if t.knob not in out or rate > out[t.knob][3]:
            out[t.knob] = (t, error, more, rate)
    return sorted(out.values(), key=lambda g: -g[3])


def recommend(trials, base, differs, reference_noise):
    """Sentences."""
    done = [t for t in trials if "error" in t.results]
    error, seconds, front = base.results["error"], base.results["seconds"], frontier(done)
    lines = [
        f"{base.name} costs {duration(seconds)} and is off by {percent(error.total.value)}: "
        f"noise {percent(error.noise.value)}, bias {percent(error.bias.value)}. Half of all points are off by less "
        f"than {percent(error.median)}; the worst {percent(WORST)} of them make {100 * error.worst:.0f}% of the squared error."
    ]
    lines += _halving(front, error.total.value)
    lines += _buys(gains(done, base, differs), error)
    lines += _share(error)
    lines += _savings(done, base, differs)
    lines += _honesty(base)
    if reference_noise > error.total.value:
        lines.append(
            f"The reference's own error per point ({percent(reference_noise)}) is larger than what is measured; "
            "the bands say what can be told all the same. More time for the reference narrows them."
        )
    return lines


def _halving(front, error):
    """What the error costs on the frontier, and its half."""
    here, half = seconds_for(front, error), seconds_for(front, error / 2)
    if half is None:
        best = front[-1]
        return [
            f"No setting tried halves it: {best.name} comes closest, {percent(best.results['error'].total.value)} "
            f"for {duration(best.results['seconds'])}."
        ]
    return [f"{percent(error)} costs {duration(here)} at best; the next halving costs {duration(half)}."]


def _buys(ranked, error):
    if not ranked:
        return ["No single knob lowers the error by more than chance."]
    lines = []
    for k, (t, left, more, _) in enumerate(ranked[:3]):
        price = f"for {duration(more)} more" if more > 0 else "at no cost"
        first = "Most per second buys" if k == 0 else "Then"
        lines.append(f"{first} {t.name}: {percent(error.total.value)} to {percent(left)} {price}.")
    return lines


def _share(error):
    """Whether rays can help at all."""
    noise, bias = error.noise.value**2, error.bias.value**2
    share = bias / max(noise + bias, 1e-30)
    if share > 0.7:
        return [f"{100 * share:.0f}% of the squared error is bias, which more rays do not lower."]
    if share < 0.3:
        return [
            f"{100 * (1 - share):.0f}% of the squared error is noise: more rays help, finer texels do not."
        ]
    return ["Noise and bias weigh about the same: rays alone stop helping soon."]


def _honesty(base):
    """Whether the bake states its noise as it is, within a quarter."""
    told, true = base.results["estimated"], base.results["true"]
    if true <= 0.0 or 0.75 <= told / true <= 1.25:
        return []
    word = "less" if told < true else "more"
    return [f"The bake states {word} noise than it has: {percent(told)} instead of {percent(true)}."]


def _savings(done, base, differs):
    """Settings that are much faster and not worse."""
    limit = 0.8 * base.results["seconds"]
    cheap = [
        t
        for t in done
        if t is not base
        and t.results["seconds"] < limit
        and (
            t.results["error"].total.value <= base.results["error"].total.value
            or not differs(t.results["error"], base.results["error"])
        )
    ]
    if not cheap:
        return []
    t = min(cheap, key=lambda t: t.results["seconds"])
    return [
        f"{t.name} is no worse than the preset as far as can be told and takes "
        f"{duration(t.results['seconds'])} instead of {duration(base.results['seconds'])}."
    ]
