# SPDX-License-Identifier: GPL-3.0-or-later
"""An office floor at night: 24 rooms, two corridors, 130 light sets, 25 doors, props that can vanish.

    blender -b --factory-startup --python-exit-code 1 -P examples/office.py -- OUT.blend

Every lamp is a light set of its own, as in a game where each can be shot out or flicker; most touch
few surfaces, so their light stays small. Doors share one leaf, furniture shares its meshes.
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import scene_kit as kit
import textures

# Metres. The long corridor runs along x, the short one closes it in the east.
WIDTH, DEPTH, HALL, HEIGHT, WALL = 5.0, 4.0, 2.4, 2.8, 0.12
COLUMNS, ROWS = 10, 4  # rooms on each side of the long corridor; rooms east of the short one
LENGTH, NORTH, SOUTH = COLUMNS * WIDTH, HALL + DEPTH, -DEPTH
EAST = LENGTH + HALL
BAY = (NORTH - SOUTH) / ROWS  # width of an eastern room
DOOR, TOP = 0.9, 2.05
WARM, COOL, LAMP = (1.0, 0.82, 0.62), (0.82, 0.91, 1.0), (1.0, 0.66, 0.36)


def make_materials():
    picture = lambda maker: kit.image(maker.__name__, maker())
    return {
        "wall": kit.surface("Plaster", picture=picture(textures.plaster), specular=0.2),
        "carpet": kit.surface("Carpet", (0.16, 0.20, 0.26), roughness=1.0, specular=0.0),
        "ceiling": kit.matte("Ceiling", (0.76, 0.76, 0.74)),
        "trim": kit.surface("Trim", (0.62, 0.60, 0.56), roughness=0.5),
        "door": kit.surface("Door", (0.42, 0.14, 0.08), roughness=0.5),
        "wood": kit.surface("Wood", picture=picture(textures.planks), roughness=0.6),
        "black": kit.matte("Black plastic", (0.04, 0.04, 0.045)),
        "steel": kit.surface("Steel", (0.60, 0.60, 0.62), roughness=0.35, metallic=1.0),
        "leaves": kit.matte("Leaves", (0.08, 0.24, 0.06)),
        "tube": kit.glowing("Tube", (0.85, 1.0, 0.92), 16.0),
    }


def doors_along(count, step):
    """Door holes of a corridor wall, one per room, near the room's low corner."""
    return [(i * step + 0.5, i * step + 0.5 + DOOR, 0.0, TOP) for i in range(count)]


def windows_along(count, step):
    return [(i * step + 1.4, i * step + step - 0.6, 1.0, 2.3) for i in range(count)]


def build_shell(m):
    """Corridor walls with doorways, outer walls with windows, partitions, floor and ceiling."""
    sides, height, t = [m["wall"], m["wall"], m["trim"]], (0.0, HEIGHT), WALL
    north, windows = doors_along(COLUMNS, WIDTH), windows_along(COLUMNS, WIDTH)
    moved = lambda holes: [(a + SOUTH, b + SOUTH, c, d) for a, b, c, d in holes]
    bays, panes = moved(doors_along(ROWS, BAY)), moved(windows_along(ROWS, BAY))
    far = EAST + DEPTH
    for name, axis, low, span, holes in (
        ("North corridor wall", 1, HALL, (0, LENGTH), north),
        ("South corridor wall", 1, -t, (0, LENGTH), north),
        ("East corridor wall", 0, EAST, (SOUTH, NORTH), bays),
        ("Fire wall", 0, LENGTH, (0, HALL), [(0.75, 0.75 + DOOR, 0.0, TOP)]),
        ("North wall", 1, NORTH, (-t, far + t), windows),
        ("South wall", 1, SOUTH - t, (-t, far + t), windows),
        ("West wall", 0, -t, (SOUTH, NORTH), []),
        ("East wall", 0, far, (SOUTH, NORTH), panes),
    ):
        kit.wall(name, axis, (low, low + t), span, height, holes, sides, 2.0)
    for i in range(1, COLUMNS + 1):
        for name, span in (("N", (HALL + t, NORTH)), ("S", (SOUTH, -t))):
            kit.wall(f"Partition {name}{i}", 0, (i * WIDTH, i * WIDTH + t), span, height, [], sides, 2.0)
    for i in range(1, ROWS):
        y = SOUTH + i * BAY
        kit.wall(f"Partition E{i}", 1, (y, y + t), (EAST + t, far), height, [], sides, 2.0)
    low, high, y0, y1 = -t, far + t, SOUTH - t, NORTH + t
    kit.pane("Floor", [(low, y0, 0), (high, y0, 0), (high, y1, 0), (low, y1, 0)], m["carpet"])
    ceiling = [(high, y0, HEIGHT), (low, y0, HEIGHT), (low, y1, HEIGHT), (high, y1, HEIGHT)]
    kit.pane("Ceiling", ceiling, m["ceiling"])
    roof = kit.box("Roof", (low, y0, HEIGHT + 0.05), (high, y1, HEIGHT + 0.2), m["black"])
    kit.tag(roof, surface="OCCLUDER")


def build_doors(m):
    """One leaf and handle for all; hinges at the low end of each doorway."""
    leaf = kit.boxes("Leaf", [((0.0, -0.02, 0.01), (DOOR, 0.02, TOP))], m["door"])
    handle = kit.boxes("Handle", [((DOOR - 0.16, -0.07, 1.0), (DOOR - 0.05, 0.07, 1.03))], m["steel"])
    hinges = [
        (f"Door N{i}", (x[0], HALL + 0.03, 0), 0, 100) for i, x in enumerate(doors_along(COLUMNS, WIDTH))
    ]
    hinges += [(f"Door S{i}", (x[0], -0.03, 0), 0, -100) for i, x in enumerate(doors_along(COLUMNS, WIDTH))]
    for i, hole in enumerate(doors_along(ROWS, BAY)):
        hinges.append((f"Door E{i}", (EAST + 0.03, SOUTH + hole[0], 0), 90, -100))
    hinges.append(("Fire door", (LENGTH + 0.03, 0.75, 0), 90, -100))
    for name, hinge, turn, swing in hinges:
        parts = []
        for part, angle in ((name, turn), (name + " open", turn + swing)):
            parts.append(kit.place(part, leaf, hinge, angle))
            kit.attach(kit.place(part + " handle", handle, hinge, angle), parts[-1])
        kit.door(*parts)


def build_room(m, name, center, size, data):
    """Four ceiling lamps, a desk with a screen and a chair, a plant; name is also its address."""
    x, y = center
    for i, (dx, dy) in enumerate(((-1, -1), (1, -1), (-1, 1), (1, 1))):
        place = (x + dx * size[0] / 4, y + dy * size[1] / 4, HEIGHT - 0.02)
        add_lamp(f"Lamp {name}.{i}", "AREA", place, 14.0, COOL if i % 2 else WARM, shape="SQUARE", size=0.5)
    desk = kit.place(f"Desk {name}", data["desk"], (x, y + 0.5, 0))
    kit.attach(kit.place(f"Screen {name}", data["screen"], (x + 0.1, y + 0.6, 0.74), 8), desk)
    chair = kit.place(f"Chair {name}", data["chair"], (x - 0.2, y - 0.3, 0), 190)
    pot = kit.place(f"Plant {name}", data["pot"], (x + size[0] / 2 - 0.5, y - size[1] / 2 + 0.6, 0))
    crown = kit.place(f"Crown {name}", data["crown"], (*pot.location[:2], 0.85))
    kit.attach(crown, pot)
    for prop in (desk, chair, pot):
        kit.tag(prop, movable="TOGGLE")


def add_lamp(name, kind, place, power, color, **settings):
    """A static lamp in a light set of its own."""
    kit.light_sets(name)
    kit.light(name, kind, place, power, color, None, "STATIC", name, **settings)


def make_furniture(m):
    legs = [((a, b, 0), (a + 0.06, b + 0.06, 0.7)) for a in (-0.8, 0.74) for b in (-0.4, 0.34)]
    stool = [((-0.2, -0.2, 0.42), (0.2, 0.2, 0.47)), ((-0.03, -0.03, 0), (0.03, 0.03, 0.42))]
    crown = kit.sphere("Crown", (0, 0, 0), 0.35, m["leaves"], 8, 12)
    data = {
        "desk": kit.boxes("Desk", [((-0.8, -0.4, 0.7), (0.8, 0.4, 0.74)), *legs], m["wood"]),
        "screen": kit.boxes(
            "Screen", [((-0.3, 0, 0.1), (0.3, 0.03, 0.5)), ((-0.05, 0, 0), (0.05, 0.03, 0.1))], m["black"]
        ),
        "chair": kit.boxes("Chair", [*stool, ((-0.2, 0.17, 0.47), (0.2, 0.2, 0.9))], m["black"]),
        "pot": kit.boxes(
            "Pot",
            [((-0.18, -0.18, 0), (0.18, 0.18, 0.4)), ((-0.02, -0.02, 0.4), (0.02, 0.02, 0.6))],
            m["trim"],
        ),
        "crown": crown.data,
    }
    kit.bpy.data.objects.remove(crown)
    return data


def build_rooms(m):
    data = make_furniture(m)
    rooms = []
    for i in range(COLUMNS):
        x = (i + 0.5) * WIDTH
        rooms += [
            (f"N{i}", (x, HALL + DEPTH / 2), (WIDTH, DEPTH)),
            (f"S{i}", (x, -DEPTH / 2), (WIDTH, DEPTH)),
        ]
    for i in range(ROWS):
        rooms.append((f"E{i}", (EAST + DEPTH / 2, SOUTH + (i + 0.5) * BAY), (DEPTH, BAY)))
    for name, center, size in rooms:
        build_room(m, name, center, size, data)
    for name, (x, y), _size in rooms[:14]:
        add_lamp(f"Desk lamp {name}", "POINT", (x + 0.6, y + 0.6, 1.15), 6.0, LAMP, shadow_soft_size=0.05)


def build_corridors(m):
    """Twenty glowing tubes, a light set each."""
    tube = kit.boxes("Tube", [((-0.6, -0.05, -0.04), (0.6, 0.05, 0.0))], m["tube"])
    places = [((i + 0.5) * LENGTH / 15, HALL / 2, 0) for i in range(15)]
    places += [(LENGTH + HALL / 2, SOUTH + (i + 0.5) * (NORTH - SOUTH) / 5, 90) for i in range(5)]
    for i, (x, y, turn) in enumerate(places):
        name = f"Tube {i}"
        kit.light_sets(name)
        kit.tag(kit.place(name, tube, (x, y, HEIGHT - 0.03), turn), light_set=name)


def main():
    scene = kit.start()
    scene.name = "Office"
    kit.tag(scene, preset="PREVIEW")
    m = make_materials()
    build_shell(m)
    build_doors(m)
    build_rooms(m)
    build_corridors(m)
    kit.camera("corridor", (1.0, HALL / 2, 1.6), (LENGTH, HALL / 2, 1.3), 20.0)
    kit.camera("room", (WIDTH - 0.4, NORTH - 0.4, 1.6), (0.8, HALL + 0.4, 1.0), 18.0)
    scene.camera = scene.objects["corridor"]
    kit.sky_world(kit.image("Night", textures.sky((0.28, 0.76, 0.585), 64) * 0.002 + 0.01, is_float=True))
    kit.save("office.blend")


main()
