# SPDX-License-Identifier: GPL-3.0-or-later
"""A run time whose pages are known: each element lights one page, or takes light from it."""
import ctypes
from types import SimpleNamespace

SIZE = 16


class FakeRuntime:
    """Page p shows base[p] plus the sum over elements e of that page of weight * colour * light[e]."""

    opened = []

    def __init__(self, base, elements):
        """base: colour of each page. elements: (name, kind, weight, page, light), light a colour."""
        self.base = base
        self._elements = [dict(zip(("name", "kind", "weight", "page", "light"), e)) for e in elements]
        for element in self._elements:
            element["color"] = (1.0, 1.0, 1.0)
        self._dirty = set()
        self.closed = False
        self.updates = []
        FakeRuntime.opened.append(self)

    def elements(self):
        return [SimpleNamespace(index=i, **e) for i, e in enumerate(self._elements)]

    def set_weight(self, index, weight):
        self._set(index, "weight", weight)

    def set_color(self, index, color):
        self._set(index, "color", tuple(color))

    def _set(self, index, key, value):
        if self._elements[index][key] != value:
            self._elements[index][key] = value
            self._dirty.add(self._elements[index]["page"])

    def update(self):
        pages, self._dirty = sorted(self._dirty), set()
        self.updates.append(pages)
        return pages

    def page_count(self):
        return len(self.base)

    def page_size(self, _page):
        return SIZE, SIZE

    def color(self, page):
        """What a page shows."""
        lit = [e for e in self._elements if e["page"] == page]
        return [
            self.base[page][c] + sum(e["weight"] * e["color"][c] * e["light"][c] for e in lit)
            for c in range(3)
        ]

    def page_irradiance(self, page):
        texel = [*self.color(page), 1.0]
        return (ctypes.c_float * (4 * SIZE * SIZE))(*(texel * (SIZE * SIZE)))

    def close(self):
        self.closed = True
