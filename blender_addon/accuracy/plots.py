# SPDX-License-Identifier: GPL-3.0-or-later
"""Plots as inline SVG, without dependencies."""
import html
import math
from dataclasses import dataclass, field

COLORS = ("#1b6ca8", "#d1495b", "#2e8b57", "#8a5fbf", "#e08e1b", "#3aa6a6", "#7a6a53", "#b0508f", "#555555")


@dataclass
class Point:
    """x and y with optional bands (low, high) and a label that shows on hovering."""

    x: float
    y: float
    y_band: tuple | None = None
    label: str = ""


@dataclass
class Series:
    """Points of one colour, joined if line is true."""

    name: str
    points: list
    line: bool = True
    dashed: bool = False
    large: bool = False
    labels: bool = False  # names written beside the points
    band: bool = False  # an area instead of bars


@dataclass
class Axis:
    """Logarithmic or linear axis with its own way to write numbers."""

    title: str
    write: object = str
    log: bool = True
    range: list = field(default_factory=lambda: [math.inf, -math.inf])

    def include(self, value):
        if not self.log or value > 0.0:
            self.range = [min(self.range[0], value), max(self.range[1], value)]

    def close(self):
        low, high = self.range if self.range[0] < math.inf else (1.0, 10.0)
        if self.log:
            spread = max(high / low, 1.3)
            self.range = [low / spread**0.08, low * spread**1.1]
        else:
            self.range = [min(low, 0.0), high * 1.08 or 1.0]

    def place(self, value):
        """0..1 along the axis."""
        low, high = self.range
        if self.log:
            return math.log(max(value, low) / low) / math.log(high / low)
        return (value - low) / (high - low)

    def ticks(self):
        low, high = self.range
        if not self.log:
            step = 10 ** math.floor(math.log10(high - low)) / 2
            while (high - low) / step > 6:
                step *= 2
            return [step * k for k in range(int(low / step), int(high / step) + 1)]
        steps = (1, 2, 5) if high / low < 200 else (1,)
        decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
        return [s * 10.0**d for d in decades for s in steps if low <= s * 10.0**d <= high]


def chart(title, x, y, series, width=640, height=400):
    """A chart with legend."""
    for s in series:
        for p in s.points:
            x.include(p.x)
            for v in (p.y, *(p.y_band or ())):
                y.include(v)
    x.close(), y.close()
    plot = _Plot(x, y, width, height)
    parts = [plot.frame(title)]
    for k, s in enumerate(series):
        parts.append(plot.series(s, COLORS[k % len(COLORS)]))
    parts.append(plot.legend([s for s in series if s.name]))
    return (
        f'<svg viewBox="0 0 {width} {height}" width="{width}" role="img" aria-label="{html.escape(title)}">'
        + "".join(parts)
        + "</svg>"
    )


class _Plot:
    left, right, top, bottom = 62, 150, 30, 46

    def __init__(self, x, y, width, height):
        self.x, self.y, self.width, self.height = x, y, width, height

    def at(self, x, y):
        w, h = self.width - self.left - self.right, self.height - self.top - self.bottom
        return self.left + w * self.x.place(x), self.top + h * (1 - self.y.place(y))

    def frame(self, title):
        low_x, low_y = self.x.range[0], self.y.range[0]
        end, base = self.width - self.right, self.height - self.bottom
        out = [f'<text x="{self.left}" y="18" class="title">{html.escape(title)}</text>']
        for tick in self.y.ticks():
            h = self.at(low_x if self.x.log else 0, tick)[1]
            out.append(f'<line x1="{self.left}" x2="{end}" y1="{h:.1f}" y2="{h:.1f}" class="grid"/>')
            out.append(
                f'<text x="{self.left - 6}" y="{h + 4:.1f}" class="tick end">{self.y.write(tick)}</text>'
            )
        for tick in self.x.ticks():
            w = self.at(tick, low_y if self.y.log else 0)[0]
            out.append(f'<line x1="{w:.1f}" x2="{w:.1f}" y1="{self.top}" y2="{base}" class="grid"/>')
            out.append(f'<text x="{w:.1f}" y="{base + 16}" class="tick middle">{self.x.write(tick)}</text>')
        middle = (self.left + end) / 2
        out.append(
            f'<text x="{middle}" y="{self.height - 8}" class="tick middle">{html.escape(self.x.title)}</text>'
        )
        turn = f'transform="rotate(-90 14 {(self.top + base) / 2})"'
        out.append(
            f'<text x="14" y="{(self.top + base) / 2}" {turn} class="tick middle">{html.escape(self.y.title)}</text>'
        )
        return "".join(out)

    def series(self, s, color):
        places = [self.at(p.x, p.y) for p in s.points]
        dash = ' stroke-dasharray="5 4"' if s.dashed else ""
        out = []
        if s.band and s.points:
            out.append(self.area(s, color))
        if s.line and len(places) > 1:
            line = " ".join(f"{a:.1f},{b:.1f}" for a, b in places)
            out.append(f'<polyline points="{line}" fill="none" stroke="{color}" stroke-width="1.6"{dash}/>')
        for p, (a, b) in zip(s.points, places):
            if p.y_band and not s.band:
                low, high = (self.at(p.x, v)[1] for v in p.y_band)
                out.append(
                    f'<line x1="{a:.1f}" x2="{a:.1f}" y1="{low:.1f}" y2="{high:.1f}" stroke="{color}"/>'
                )
            size = 5 if s.large else 3
            out.append(
                f'<circle cx="{a:.1f}" cy="{b:.1f}" r="{size}" fill="{color}">'
                f"<title>{html.escape(p.label)}</title></circle>"
            )
            if s.labels:
                out.append(
                    f'<text x="{a + 7:.1f}" y="{b - 6:.1f}" class="tick">{html.escape(p.label)}</text>'
                )
        return "".join(out)

    def area(self, s, color):
        upper = [self.at(p.x, p.y_band[1]) for p in s.points]
        lower = [self.at(p.x, p.y_band[0]) for p in reversed(s.points)]
        line = " ".join(f"{a:.1f},{b:.1f}" for a, b in upper + lower)
        return f'<polygon points="{line}" fill="{color}" opacity="0.15"/>'

    def legend(self, series):
        out, x = [], self.width - self.right + 12
        for k, s in enumerate(series):
            y = self.top + 14 + 17 * k
            out.append(f'<rect x="{x}" y="{y - 8}" width="12" height="4" fill="{COLORS[k % len(COLORS)]}"/>')
            out.append(f'<text x="{x + 17}" y="{y}" class="tick">{html.escape(s.name)}</text>')
        return "".join(out)


def bars(title, rows, write):
    """Horizontal bars: rows of (name, value, (low, high))."""
    top = max((high for _, _, (_, high) in rows), default=1.0) or 1.0
    out = [f'<text x="0" y="16" class="title">{html.escape(title)}</text>']
    for k, (name, value, (low, high)) in enumerate(rows):
        y, scale = 30 + 26 * k, 300 / top
        out.append(f'<text x="0" y="{y + 12}" class="tick">{html.escape(name)}</text>')
        out.append(f'<rect x="230" y="{y}" width="{value * scale:.1f}" height="15" fill="{COLORS[0]}"/>')
        a, b = 230 + low * scale, 230 + high * scale
        out.append(
            f'<line x1="{a:.1f}" x2="{b:.1f}" y1="{y + 7}" y2="{y + 7}" stroke="#222" stroke-width="2"/>'
        )
        out.append(f'<text x="{b + 8:.1f}" y="{y + 12}" class="tick">{write(value)}</text>')
    height = 36 + 26 * len(rows)
    return f'<svg viewBox="0 0 640 {height}" width="640" role="img">{"".join(out)}</svg>'
