# SPDX-License-Identifier: GPL-3.0-or-later
"""Small scenes for what baked light most often gets wrong: many toggles above each other, many light sets at a place,
normals that are not those of the surface, rooms whose light comes through one window. A case fills an empty file and
returns its states."""
import math
import random
from dataclasses import dataclass, field

from mathutils import Vector

from . import cycles, elements, light_cases
from .reference_cases import GREY, WARM, lamp_at, make_box, make_mesh, make_quad

ROOM = ((0, 0, 0), (4, 3, 3))


@dataclass
class State:
    """What the run time is told, and what Cycles has to hide to show the same. bound: of the relative error of the mean
    beside noise; the start is exact, away from it terms of high order are cut."""

    name: str
    weights: dict = field(default_factory=dict)
    hidden: list = field(default_factory=list)
    bound: float = 0.01


@dataclass(frozen=True)
class Case:
    """name; build(): fills the file and returns states, the one that the file starts in first. samples: of Cycles.
    is_long: runs only if it is named."""

    name: str
    build: object
    samples: int = 256
    texels_per_meter: float = 4.0
    is_long: bool = False


def _walls(x0, y0, z0, x1, y1, z1):
    """Corners of the six sides of a box, normals in; the wall x = x1 comes last."""
    return [
        [(x0, y0, z0), (x1, y0, z0), (x1, y1, z0), (x0, y1, z0)],
        [(x0, y0, z1), (x0, y1, z1), (x1, y1, z1), (x1, y0, z1)],
        [(x0, y0, z0), (x0, y0, z1), (x1, y0, z1), (x1, y0, z0)],
        [(x0, y1, z0), (x1, y1, z0), (x1, y1, z1), (x0, y1, z1)],
        [(x0, y0, z0), (x0, y1, z0), (x0, y1, z1), (x0, y0, z1)],
        [(x1, y0, z0), (x1, y0, z1), (x1, y1, z1), (x1, y1, z0)],
    ]


def _room():
    """A closed room of single sheets."""
    grey = cycles.diffuse_material("Grey", GREY)
    for number, corners in enumerate(_walls(*ROOM[0], *ROOM[1])):
        make_quad(f"Wall {number}", corners, grey)


def _stack(count, lit_by_set):
    """Boards above each other under a lamp, all there at the start; then three mixed states and none."""
    _room()
    warm = cycles.diffuse_material("Board", WARM)
    boards = []
    for i in range(count):
        z = 0.3 + 1.8 * (i + 0.5) / count
        low, high = (1.2, 0.8, z), (2.6, 2.0, z + min(0.05, 0.5 / count))
        boards.append(make_box(f"Board {i}", low, high, warm, occluder=True))
        boards[-1].ajar.movable = 'TOGGLE'
    lamp = lamp_at('POINT', (1.9, 1.4, 2.6), energy=60, shadow_soft_size=0.1)
    if lit_by_set:
        lamp.ajar.light_set = elements.light_set("lamp").name
    states = [State("start")]
    draw = random.Random(count)
    for i in range(4):
        away = [board for board in boards if i == 3 or draw.random() < 0.3]
        weights = {board.name: 0.0 for board in away}
        states.append(State("none" if i == 3 else f"mixed {i}", weights, away, 0.02))
    return states


def _sets(count):
    """Lamps all over the ceiling, each a light set, all on."""
    _room()
    columns = math.ceil(math.sqrt(count * 4 / 3))
    rows = math.ceil(count / columns)
    for i in range(count):
        x, y = 4 * (i % columns + 0.5) / columns, 3 * (i // columns + 0.5) / rows
        lamp = lamp_at('POINT', (x, y, 2.4), energy=200 / count, shadow_soft_size=0.1)
        lamp.ajar.light_set = elements.light_set(f"set {i}").name
    make_box("Crate", (1.5, 1.0, 0.05), (2.5, 2.0, 0.8), cycles.diffuse_material("Crate", WARM))
    return [State("all on")]


def _leaning_card(name, corners, front, **options):
    """A card whose normals lean up by 60 degrees from its front. (By 90 degrees Cycles' bake takes one side or the
    other by rounding.)"""
    card = make_quad(name, corners, cycles.diffuse_material("Leaf", GREY), smooth=True, **options)
    card.data.use_auto_smooth = True
    card.data.normals_split_custom_set([(*front, math.sqrt(0.75))] * 4)
    return card


def _cards():
    """Crossed cards under an even sky, their normals up as foliage has them."""
    _leaning_card("Card", [(0, 1, 0), (2, 1, 0), (2, 1, 1), (0, 1, 1)], (0, -0.5))
    _leaning_card("Crossed Card", [(1, 0, 0), (1, 2, 0), (1, 2, 1), (1, 0, 1)], (0.5, 0))
    light_cases.sky()
    return [State("start")]


def _leaves():
    """The same cards without lightmaps and a smooth ball, above a floor between walls."""
    _room()
    _leaning_card(
        "Card", [(0.5, 1, 0.1), (2.5, 1, 0.1), (2.5, 1, 1.5), (0.5, 1, 1.5)], (0, -0.5), occluder=True
    )
    _leaning_card(
        "Back", [(2, 0.4, 0.1), (2, 2.4, 0.1), (2, 2.4, 1.5), (2, 0.4, 1.5)], (0.5, 0), occluder=True
    )
    points, faces = [(0, 0, -0.5), (0, 0, 0.5)], []
    for i in range(6):
        angle = math.pi * i / 3
        points.append((0.5 * math.cos(angle), 0.5 * math.sin(angle), 0.0))
        after = 2 + (i + 1) % 6
        faces += [(0, after, 2 + i), (1, 2 + i, after)]
    points = [(x + 3.2, y + 2.2, z + 0.7) for x, y, z in points]
    make_mesh("Ball", points, faces, cycles.diffuse_material("Ball", WARM), occluder=True, smooth=True)
    lamp_at('POINT', (3.2, 0.4, 2.2), energy=60, shadow_soft_size=0.1)
    return [State("start")]


def _smooth_room():
    """A room of one mesh whose walls are divided and shaded smooth: normals lean in its edges."""
    steps, points, faces = 6, {}, []  # points: index by position, so that walls share those in their edges
    for a, b, _, d in _walls(*ROOM[0], *ROOM[1]):
        corner, across, up = Vector(a), Vector(b) - Vector(a), Vector(d) - Vector(a)
        grid = [
            [
                tuple(round(v, 6) for v in corner + across * (i / steps) + up * (j / steps))
                for j in range(steps + 1)
            ]
            for i in range(steps + 1)
        ]
        at = [[points.setdefault(point, len(points)) for point in column] for column in grid]
        for i in range(steps):
            faces += [(at[i][j], at[i + 1][j], at[i + 1][j + 1], at[i][j + 1]) for j in range(steps)]
    make_mesh("Room", list(points), faces, cycles.diffuse_material("Grey", GREY), smooth=True)
    lamp_at('POINT', (1.5, 1.2, 2.0), energy=60, shadow_soft_size=0.1)
    return [State("start")]


def _window_room(edge, solid):
    """A room whose only light is the sun and the sky through a square window. solid: walls have a thickness."""
    grey = cycles.diffuse_material("Grey", GREY)
    (x0, y0, z0), (x1, y1, z1) = ROOM
    walls = _walls(x0, y0, z0, x1, y1, z1)
    left, right, below, above = 1.5 - edge / 2, 1.5 + edge / 2, 1.6 - edge / 2, 1.6 + edge / 2
    parts = [(y0, left, z0, z1), (right, y1, z0, z1), (left, right, z0, below), (left, right, above, z1)]
    if solid:
        thick = 0.2
        boxes = [  # they meet without lying in each other
            ((x0 - thick, y0 - thick, z0 - thick), (x0, y1 + thick, z1 + thick)),
            ((x0, y0 - thick, z0 - thick), (x1, y0, z1 + thick)),
            ((x0, y1, z0 - thick), (x1, y1 + thick, z1 + thick)),
            ((x0, y0, z0 - thick), (x1, y1, z0)),
            ((x0, y0, z1), (x1, y1, z1 + thick)),
        ]
        for number, (low, high) in enumerate(boxes):
            make_box(f"Wall {number}", low, high, grey)
        for number, (a, b, c, d) in enumerate(parts):
            make_box(f"Front {number}", (x1, a, c), (x1 + thick, b, d), grey)
    else:
        for number, corners in enumerate(walls[:-1]):
            make_quad(f"Wall {number}", corners, grey)
        for number, (a, b, c, d) in enumerate(parts):
            make_quad(f"Front {number}", [(x1, a, c), (x1, a, d), (x1, b, d), (x1, b, c)], grey)
    light_cases.sky()
    lamp_at('SUN', (6, 1, 6), (0, 1.4, 0), energy=3.0, angle=0.05)
    return [State("start")]


WINDOWS = (0.1, 0.2, 0.4, 0.8, 1.2, 1.6, 2.4)  # metres
CASES = (
    [
        Case(f"stack {n}{' set' if s else ''}", lambda n=n, s=s: _stack(n, s), is_long=n > 3 or not s)
        for n in (3, 5, 9, 20)
        for s in (False, True)
    ]
    + [Case(f"sets {n}", lambda n=n: _sets(n), is_long=n > 12) for n in (12, 60, 300)]
    + [
        Case("cards", _cards, texels_per_meter=12.0),
        Case("leaves", _leaves, 1024),
        Case("smooth room", _smooth_room),
    ]
    + [
        Case(
            f"window {edge} {'solid' if solid else 'sheets'}",
            lambda edge=edge, solid=solid: _window_room(edge, solid),
            1024,
            12.0 if edge < 0.8 else 4.0,  # a spot of sun and a sill are no smaller than some texels
            is_long=edge != 1.2 or solid,
        )
        for edge in WINDOWS
        for solid in (False, True)
    ]
)
