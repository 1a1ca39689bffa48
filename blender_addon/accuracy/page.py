# SPDX-License-Identifier: GPL-3.0-or-later
"""The page, the table and the JSON of an accuracy run."""
import csv
import html
from dataclasses import dataclass, field

from .advice import duration, frontier, percent
from .measure import BAND, FLOOR
from .plots import Axis, Point, Series, bars, chart

STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; max-width: 960px; margin: 2em auto; padding: 0 1em; color: #222 }
table { border-collapse: collapse; font-size: 13px } td, th { padding: 2px 9px; text-align: right }
td:first-child, th:first-child { text-align: left } tr:nth-child(even) { background: #f4f4f4 }
tr.front td:first-child { font-weight: 600 } svg { max-width: 100%; margin: 12px 0 }
text { font: 12px system-ui, sans-serif; fill: #333 } text.title { font-weight: 600; font-size: 14px }
text.end { text-anchor: end } text.middle { text-anchor: middle } line.grid { stroke: #e2e2e2 }
figure { display: inline-block; margin: 4px 8px 12px 0 } figcaption { font-size: 12px } img { max-width: 300px }
.advice { background: #eef5fb; padding: .6em 1.2em; border-left: 4px solid #1b6ca8 }
"""


def row(trial, front):
    """Figures of one trial, plain."""
    r, e = trial.results, trial.results["error"]
    return {
        "knob": trial.knob,
        "value": trial.value,
        "seconds": r["seconds"],
        "wall_seconds": r["wall"],
        "texels": r["texels"],
        "rays": r["rays"],
        "error": e.total.value,
        "error_low": e.total.low,
        "error_high": e.total.high,
        "noise": e.noise.value,
        "bias": e.bias.value,
        "mean": e.mean,
        "median": e.median,
        "p95": e.p95,
        "worst_share": e.worst,
        "estimated_noise": r["estimated"],
        "true_noise": r["true"],
        "report_rms": r["report_rms"],
        "report_rms_other_seed": r["report_rms_other_seed"],
        "frontier": trial in front,
    }


def write_csv(path, rows):
    """One line per trial."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)


def _point(t, label=None):
    e = t.results["error"].total
    name = f"{t.name}: {percent(e.value)} in {duration(t.results['seconds'])}"
    return Point(t.results["seconds"], e.value, (e.low, e.high), name if label is None else label)


def curves(trials, base):
    """Time against error: one line per knob, the presets, the frontier."""
    knobs = list(dict.fromkeys(t.knob for t in trials if t.knob != base.knob))
    by_time = lambda ts: sorted(ts, key=lambda t: t.results["seconds"])  # noqa: E731
    series = [
        Series(k, [_point(t) for t in by_time([t for t in trials if t.knob == k] + [base])]) for k in knobs
    ]
    presets = [_point(t, t.name) for t in by_time(t for t in trials if t.knob == base.knob)]
    series.append(Series("presets", presets, line=False, large=True, labels=True))
    series.append(Series("frontier", [_point(t) for t in frontier(trials)], dashed=True))
    return chart(
        "Time against error",
        Axis("time of a bake", duration),
        Axis("relative error", percent),
        series,
        width=860,
        height=480,
    )


def knob_chart(knob, trials, base):
    """Error, bias and noise along one knob; the preset's value is among them where it is a number."""
    own = base.results["knob_values"].get(knob)
    steps = [(t.value, t.results["error"]) for t in trials if t.knob == knob]
    if isinstance(own, (int, float)):
        steps.append((own, base.results["error"]))
    if not all(isinstance(v, (int, float)) for v, _ in steps):
        return ""
    steps.sort(key=lambda s: s[0])
    series = []
    for name in ("total", "bias", "noise"):
        parts = [(v, getattr(e, name)) for v, e in steps]
        points = [Point(v, b.value, (b.low, b.high), f"{knob} {v:g}: {percent(b.value)}") for v, b in parts]
        series.append(Series(name, points, band=True))
    x = Axis(knob, lambda v: f"{v:g}", log=all(v > 0 for v, _ in steps))
    return chart(knob, x, Axis("relative error", percent, log=False), series, width=460, height=280)


def estimate_chart(trials):
    """What bakes say of their noise against what it is."""
    points = [
        Point(t.results["true"], t.results["estimated"], None, t.name)
        for t in trials
        if t.results["true"] > 0
    ]
    ends = [min(p.x for p in points), max(p.x for p in points)]
    lines = [
        Series(name, [Point(x, f * x) for x in ends], dashed=f != 1.0)
        for name, f in (("right", 1.0), ("25% too high", 1.25), ("25% too low", 0.75))
    ]
    axes = Axis("true noise, from two seeds", percent), Axis("noise the bake states", percent)
    return chart("Stated against true noise", *axes, lines + [Series("bakes", points, line=False)])


def table(trials, front):
    """All trials."""
    head = "<tr><th>setting</th>" + "".join(
        f"<th>{h}</th>"
        for h in (
            "time",
            "error",
            "band",
            "noise",
            "bias",
            "mean",
            "half within",
            "95% within",
            "stated noise",
            "true",
        )
    )
    lines = [head + "</tr>"]
    for t in sorted(trials, key=lambda t: t.results["seconds"]):
        e, r = t.results["error"], t.results
        cells = [
            duration(r["seconds"]),
            percent(e.total.value),
            f"{percent(e.total.low)} – {percent(e.total.high)}",
            percent(e.noise.value),
            percent(e.bias.value),
            f"{100 * e.mean:+.2f}%",
            percent(e.median),
            percent(e.p95),
            percent(r["estimated"]),
            percent(r["true"]),
        ]
        mark = ' class="front"' if t in front else ""
        lines.append(
            f"<tr{mark}><td>{html.escape(t.name)}</td>" + "".join(f"<td>{c}</td>" for c in cells) + "</tr>"
        )
    return "<table>" + "".join(lines) + "</table>"


def notes(about):
    """How to read the page."""
    skipped = ", ".join(about["skipped"]) or "none"
    return f"""<h2>How to read this</h2><ul>
<li>Error: root mean square over {about['points']} random points of the lightmapped surfaces, alike by area, of
(bake − truth) / (truth + floor) in luminance, 100% at most, the lightmap filtered bilinearly as a game does. The floor is
{FLOOR:.0%} of the mean light, {about['floor']:.3g} W/m².</li>
<li>Truth: a path tracer that shares no sampling, storage or shortcut with the bake, {about['reference_bounces']}
bounces, {about['batches']} batches of 64 paths per point in {duration(about['reference_seconds'])}. Its own error,
{percent(about['reference_noise'])} per point, is taken off.</li>
<li>Half, or 95%, of the points are off by less than the columns "within" say, the reference's error included.</li>
<li>Noise is what differs between two seeds; bias is what is left: texels, stored light, bounces left out.</li>
<li>Bands hold {BAND[1] - BAND[0]:.0f}% of resampled points. Bold: nothing tried is both faster and better.</li>
<li>Time: processor time over {about['threads']} threads, so that other load on the machine does not count.</li>
<li>Stated and true noise are over all valid texels, dark ones against 1% of the median, light sets off.</li>
<li>State: {html.escape(about['state'])}. Not tried: {html.escape(skipped)}.</li></ul>"""


@dataclass
class Extras:
    """What stands below the trials: ways to store directions, approximations, pictures of pages."""

    storage: dict = field(default_factory=dict)
    shortcuts: list = field(default_factory=list)
    pictures: list = field(default_factory=list)


def _side(side):
    e = side.error
    return [side.how, percent(e.total.value), percent(e.bias.value), duration(side.seconds)]


def _cells(values):
    return "<tr>" + "".join(f"<td>{html.escape(v)}</td>" for v in values) + "</tr>"


def shortcut_table(shortcuts, storage):
    """Each approximation with it and without."""
    side = "<th>{}</th><th>error</th><th>bias</th><th>bake</th>"
    head = (
        "<th>approximation</th><th>changes</th>"
        + side.format("with")
        + side.format("without")
        + "<th>Ajar</th>"
    )
    rows = [[s.name, percent(s.apart.value), *_side(s.taken), *_side(s.avoided), s.ajar] for s in shortcuts]
    ahd, full = (
        next((b for name, b in storage.items() if name.startswith(k)), None) for k in ("AHD", "SH of 9")
    )
    if ahd and full:
        sides = [("AHD, 8 bytes a texel", ahd), ("SH of 9, 54 bytes", full)]
        both = [c for name, b in sides for c in (name, percent(b.value), "", "same")]
        rows.append(["AHD storage, at tilted normals", "", *both, "with"])
    return f"<table><tr>{head}</tr>{''.join(map(_cells, rows))}</table>" + SHORTCUT_NOTE


SHORTCUT_NOTE = """<p>The approximations are those of Seyb et al. 2020 (UberBake). States: light sets on and doors open by
even chance, with all doors open in the rows about doors. "Changes" says how far the light is apart with and without: root mean
square of relative differences, noise left out. Error and bias are against the truth, with what texels are too wide for. "One bounce
behind doors" is traced by the reference, and its time is that of a bake with one bounce, the least that it could take.</p>"""


def _pictures(pictures):
    figures = "".join(
        f'<figure><img src="{uri}" alt="{html.escape(c)}"><figcaption>{html.escape(c)}</figcaption></figure>'
        for c, uri in pictures
    )
    return f"<h2>Where the error lies</h2><p>Relative, 1% dark blue to 100% red, by logarithm.</p>{figures}"


def write_page(path, about, trials, advice, extras):
    """The whole page, self-contained. trials: the preset first."""
    base, storage = trials[0], extras.storage
    front = frontier(trials)
    knobs = dict.fromkeys(t.knob for t in trials if t.knob != base.knob)
    parts = [
        f"<!doctype html><meta charset=utf-8><title>Accuracy of {html.escape(about['scene'])}</title>",
        f"<style>{STYLE}</style><h1>Accuracy of {html.escape(about['scene'])}</h1>",
        '<div class="advice">' + "".join(f"<p>{html.escape(a)}</p>" for a in advice) + "</div>",
        curves(trials, base),
        table(trials, front),
        "<h2>Along each knob</h2>" + "".join(knob_chart(k, trials, base) for k in knobs),
        "<h2>Does the bake know its error?</h2>" + estimate_chart(trials),
    ]
    if extras.pictures:
        parts.append(_pictures(extras.pictures))
    if extras.shortcuts:
        parts.append("<h2>What approximations cost</h2>" + shortcut_table(extras.shortcuts, storage))
    if storage:
        rows = [(name, b.value, (b.low, b.high)) for name, b in storage.items()]
        parts.append(
            "<h2>What the storage loses</h2>" + bars("Error at normals tilted by 40°", rows, percent)
        )
    parts.append(notes(about))
    path.write_text("\n".join(parts), encoding="utf-8")
