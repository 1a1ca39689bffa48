# SPDX-License-Identifier: GPL-3.0-or-later
"""A sunlit room and a dark room with a door between them.

    blender -b --factory-startup --python-exit-code 1 -P examples/two_rooms.py -- OUT.blend

The sun, its reflections in two rooms, a cutout lattice and stained glass, lamps of every kind and
both roles in light sets, a neon sign that can be shot out, a door that opens, props that can vanish,
shared meshes, smooth and sharp normals, a text object.
"""
import math
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import scene_kit as kit
import textures

# Interiors, metres. The partition stands at x = 0 and is 0.2 thick.
EAST, WEST, DEPTH, HEIGHT = 6.0, -5.0, 5.0, 3.0
DOORWAY = (3.75, 4.75, 0.0, 2.1)
OPENING = (0.9, 3.35, 0.9, 2.4)
WINDOWS = [(0.8, 2.4, 0.85, 2.45), (3.4, 5.0, 0.85, 2.45)]
TOWARD_SUN = (0.28, 0.76, 0.585)  # unit vector


def make_materials():
    picture = lambda maker: kit.image(maker.__name__, maker())
    return {
        "plaster": kit.surface("Plaster", picture=picture(textures.plaster), specular=0.2),
        "bricks": kit.surface("Bricks", picture=picture(textures.bricks), roughness=0.9, specular=0.2),
        "tiles": kit.surface("Floor tiles", picture=picture(textures.floor_tiles), roughness=0.5),
        "planks": kit.surface("Planks", picture=picture(textures.planks), roughness=0.6),
        "crate": kit.surface("Crate", picture=picture(textures.crate)),
        "rug": kit.surface("Rug", picture=picture(textures.rug), roughness=1.0, specular=0.0),
        "painting": kit.surface("Painting", picture=picture(textures.painting)),
        "lattice": kit.surface("Lattice", picture=picture(textures.lattice), cutout=True),
        "glass": kit.tinted("Stained glass", picture(textures.stained_glass)),
        "ceiling": kit.matte("Ceiling", (0.75, 0.74, 0.71)),
        "soot": kit.matte("Dark ceiling", (0.22, 0.21, 0.22)),
        "trim": kit.surface("Painted trim", (0.72, 0.70, 0.65), roughness=0.5),
        "door": kit.surface("Painted door", (0.10, 0.26, 0.24), roughness=0.5),
        "steel": kit.surface("Steel", (0.60, 0.60, 0.62), roughness=0.35, metallic=1.0),
        "marble": kit.surface("Marble", (0.80, 0.78, 0.76), roughness=0.4),
        "ochre": kit.surface("Ochre", (0.78, 0.42, 0.10), roughness=0.6),
        "ground": kit.matte("Dry grass", (0.23, 0.24, 0.12)),
        "black": kit.matte("Sign board", (0.03, 0.03, 0.035)),
        "pink": kit.glowing("Neon pink", (1.0, 0.03, 0.28), 14.0),
        "cyan": kit.glowing("Neon cyan", (0.05, 0.65, 1.0), 8.0),
        "bulb": kit.glowing("Bulb", (1.0, 0.72, 0.42), 12.0),
    }


def build_shell(m):
    low, high = WEST - 0.2, EAST + 0.2
    kit.box("Tiled floor", (0, -0.2, -0.1), (high, DEPTH + 0.2, 0), m["tiles"], meters=1.6)
    kit.box("Plank floor", (low, -0.2, -0.1), (0, DEPTH + 0.2, 0), m["planks"], meters=1.2)
    kit.box("Light ceiling", (0, -0.2, HEIGHT), (high, DEPTH + 0.2, HEIGHT + 0.2), m["ceiling"])
    kit.box("Soot ceiling", (low, -0.2, HEIGHT), (0, DEPTH + 0.2, HEIGHT + 0.2), m["soot"])
    light, dark = m["plaster"], m["bricks"]
    height = (0, HEIGHT)
    kit.wall(
        "Partition", 0, (-0.1, 0.1), (0, DEPTH), height, [DOORWAY, OPENING], [dark, light, m["trim"]], 2.0
    )
    kit.wall("East wall", 0, (EAST, high), (0, DEPTH), height, [], [light, dark, dark], 2.0)
    kit.wall("West wall", 0, (low, WEST), (0, DEPTH), height, [], [dark, dark, dark], 2.0)
    kit.wall(
        "Window wall", 1, (DEPTH, DEPTH + 0.2), (0, high), height, WINDOWS, [light, dark, m["trim"]], 2.0
    )
    kit.wall("Back wall", 1, (-0.2, 0), (0, high), height, [], [dark, light, light], 2.0)
    kit.wall("Dark window side", 1, (DEPTH, DEPTH + 0.2), (low, 0), height, [], [dark, dark, dark], 2.0)
    kit.wall("Dark back wall", 1, (-0.2, 0), (low, 0), height, [], [dark, dark, dark], 2.0)
    ground = kit.box("Ground", (-25, -25, -0.4), (25, 25, -0.12), m["ground"])
    kit.tag(ground, surface="OCCLUDER")


def build_windows(m):
    lattice_hole, glass_hole = WINDOWS
    for number, (x0, x1, z0, z1) in enumerate(WINDOWS, 1):
        y0, y1, t = DEPTH + 0.10, DEPTH + 0.16, 0.06
        bars = [
            ((x0, y0, z0), (x0 + t, y1, z1)),
            ((x1 - t, y0, z0), (x1, y1, z1)),
            ((x0 + t, y0, z0), (x1 - t, y1, z0 + t)),
            ((x0 + t, y0, z1 - t), (x1 - t, y1, z1)),
        ]
        kit.place(f"Window frame {number}", kit.boxes(f"Window frame {number}", bars, m["trim"]))
        kit.box(
            f"Window sill {number}",
            (x0 - 0.08, DEPTH - 0.12, z0 - 0.05),
            (x1 + 0.08, DEPTH + 0.1, z0),
            m["trim"],
        )
    y = DEPTH + 0.13
    for name, hole, material in (
        ("Lattice", lattice_hole, m["lattice"]),
        ("Stained glass", (*glass_hole[:2], 1.6, glass_hole[3]), m["glass"]),
    ):
        x0, x1, z0, z1 = hole
        sheet = kit.pane(name, [(x0, y, z0), (x1, y, z0), (x1, y, z1), (x0, y, z1)], material)
        kit.tag(sheet, surface="OCCLUDER")


def build_door(m):
    y0, y1, _, top = DOORWAY
    frame = [
        ((-0.13, y0 - 0.08, 0), (0.13, y0, top + 0.08)),
        ((-0.13, y1, 0), (0.13, y1 + 0.08, top + 0.08)),
        ((-0.13, y0, top), (0.13, y1, top + 0.08)),
    ]
    kit.place("Door frame", kit.boxes("Door frame", frame, m["trim"]))
    leaf = [((-0.03, 0.0, 0.0), (0.03, y1 - y0, top))]
    for bottom, height in ((0.18, 0.75), (1.08, 0.84)):
        for y in (0.12, 0.54):
            for side in (-1, 1):
                x = sorted((side * 0.03, side * 0.042))
                leaf.append(((x[0], y, bottom), (x[1], y + 0.34, bottom + height)))
    handle = [((0.03, 0.07, 1.0), (0.08, 0.09, 1.03)), ((0.06, 0.07, 1.0), (0.08, 0.2, 1.03))]
    leaf, handle = kit.boxes("Door", leaf, m["door"]), kit.boxes("Door handle", handle, m["steel"])
    poses = []
    for name, location, turn in (("Door", (0, y0, 0), 0), ("Door open", (-0.03, y0 + 0.05, 0), 98)):
        poses.append(kit.place(name, leaf, location, turn))
        kit.attach(kit.place(name + " handle", handle, location, turn), poses[-1])
    kit.door(*poses)
    kit.text("Room sign", "ROOM 2", 0.26, m["black"], (0.12, (y0 + y1) / 2, 2.42), (90, 0, 90))


def chair_mesh(m):
    legs = [((x, y, 0), (x + 0.045, y + 0.045, 0.44)) for x in (-0.2, 0.155) for y in (-0.2, 0.155)]
    posts = [((x, 0.155, 0.48), (x + 0.045, 0.2, 0.95)) for x in (-0.2, 0.155)]
    rails = [((-0.155, 0.165, z), (0.155, 0.19, z + 0.09)) for z in (0.6, 0.82)]
    return kit.boxes(
        "Chair", [((-0.22, -0.22, 0.44), (0.22, 0.22, 0.48))] + legs + posts + rails, m["planks"], 1.5
    )


def build_sunlit_props(m):
    top = [((-0.75, -0.42, 0.71), (0.75, 0.42, 0.75))]
    legs = [((x, y, 0), (x + 0.07, y + 0.07, 0.71)) for x in (-0.7, 0.63) for y in (-0.37, 0.3)]
    table = kit.place("Table", kit.boxes("Table", top + legs, m["planks"], 1.5), (2.35, 2.1, 0.012))
    kit.tag(table, movable="TOGGLE")
    chair = chair_mesh(m)
    kit.place("Chair north", chair, (2.1, 2.72, 0.012), 8)
    kit.place("Chair south", chair, (2.7, 1.42, 0.012), 171)
    kit.place("Chair by the wall", chair, (0.42, 0.45, 0), 108)
    kit.pane(
        "Rug top", [(1.2, 1.0, 0.012), (3.5, 1.0, 0.012), (3.5, 3.2, 0.012), (1.2, 3.2, 0.012)], m["rug"]
    )
    kit.box("Rug", (1.2, 1.0, 0), (3.5, 3.2, 0.01), m["rug"])
    kit.attach(kit.sphere("Marble ball", (2.65, 2.2, 0.762 + 0.14), 0.14, m["marble"]), table)
    kit.attach(kit.sphere("Orange ball", (1.95, 1.95, 0.762 + 0.09), 0.09, m["ochre"], 12, 24), table)
    for number, x in enumerate((1.5, 3.0, 4.5), 1):
        kit.box(f"Beam {number}", (x - 0.09, 0, HEIGHT - 0.18), (x + 0.09, DEPTH, HEIGHT), m["planks"], 1.5)
    kit.box("Plinth", (0.1, 0.9, 0), (0.13, 3.67, 0.12), m["trim"])
    kit.box("Picture frame", (2.5, 0, 1.2), (3.9, 0.03, 2.2), m["black"])
    kit.pane(
        "Picture",
        [(3.84, 0.032, 1.26), (2.56, 0.032, 1.26), (2.56, 0.032, 2.14), (3.84, 0.032, 2.14)],
        m["painting"],
    )
    crate = kit.boxes("Crate", [((-0.3, -0.3, 0), (0.3, 0.3, 0.6))], m["crate"], 0.6)
    kit.place("Crate 1", crate, (0.55, 3.3, 0), 0)
    return crate


def build_dark_props(m, crate):
    for number, (location, turn) in enumerate(
        (((-4.5, 0.5, 0), 0), ((-3.8, 0.55, 0), 12), ((-4.3, 0.55, 0.6), -20)), 2
    ):
        kit.place(f"Crate {number}", crate, location, turn)
    kit.cylinder("Column", (-2.9, 3.7, 0), 0.21, HEIGHT, m["marble"])
    kit.box("Column base", (-3.2, 3.4, 0), (-2.6, 4.0, 0.16), m["marble"])
    pedestal = kit.box("Pedestal", (-1.75, 1.75, 0), (-1.25, 2.25, 0.7), m["marble"])
    kit.tag(pedestal, movable="TOGGLE")
    kit.attach(kit.sphere("Steel ball", (-1.5, 2.0, 0.96), 0.26, m["steel"]), pedestal)
    kit.box("Shelf", (-4.99, 3.6, 0.9), (-4.7, 4.9, 0.94), m["planks"], 1.5)
    for y, size in ((3.8, 0.11), (4.15, 0.08), (4.5, 0.14)):
        kit.sphere(f"Shelf ball {size}", (-4.85, y, 0.94 + size), size, m["ochre"], 12, 24)


LETTERS = {
    "A": [[(0, 0), (0.22, 0.7), (0.44, 0)], [(0.08, 0.25), (0.36, 0.25)]],
    "J": [[(0.36, 0.7), (0.36, 0.16), (0.28, 0.04), (0.16, 0), (0.05, 0.05), (0, 0.17)]],
    "R": [
        [(0, 0), (0, 0.7), (0.26, 0.7), (0.36, 0.62), (0.36, 0.45), (0.26, 0.36), (0, 0.36)],
        [(0.18, 0.36), (0.38, 0)],
    ],
}


def build_neon(m):
    """The sign AJAR on the dark room's far wall, facing +x."""
    lines, x = [], 0.0
    for letter in "AJAR":
        lines += [[(px + x, py) for px, py in line] for line in LETTERS[letter]]
        x += 0.57
    kit.box("Sign board", (WEST, 1.25, 1.45), (WEST + 0.05, 4.05, 2.65), m["black"])
    sign = kit.tubes("Neon sign", lines, 0.022, m["pink"], (WEST + 0.1, 1.57, 1.7), (90, 0, 90))
    border = [[(0, 0), (2.6, 0), (2.6, 1.0), (0, 1.0), (0, 0)]]
    frame = kit.tubes("Neon frame", border, 0.014, m["cyan"], (WEST + 0.09, 1.35, 1.55), (90, 0, 90))
    for part in (sign, frame):
        kit.tag(part, light_set="neon")


def build_lights(m):
    sun_at = tuple(20 * c for c in TOWARD_SUN)
    kit.light("Sun", "SUN", sun_at, 20.0, (1.0, 0.90, 0.74), (0, 0, 0), "PRIMARY", angle=math.radians(0.53))
    for number, y in enumerate((1.3, 3.7), 1):
        kit.box(f"Lamp housing {number}", (3.55, y - 0.3, HEIGHT - 0.06), (3.95, y + 0.3, HEIGHT), m["trim"])
        kit.light(
            f"Ceiling lamp {number}",
            "AREA",
            (3.75, y, HEIGHT - 0.065),
            22.0,
            (1.0, 0.86, 0.68),
            None,
            "STATIC",
            "ceiling",
            shape="RECTANGLE",
            size=0.36,
            size_y=0.56,
        )
    kit.light(
        "Picture spot",
        "SPOT",
        (3.2, 1.1, 2.75),
        30.0,
        (1.0, 0.85, 0.65),
        (3.2, 0.0, 1.7),
        "PRIMARY",
        spot_size=math.radians(60),
        spot_blend=0.5,
        shadow_soft_size=0.03,
    )
    kit.light(
        "Dark room spot",
        "SPOT",
        (-2.2, 1.4, 2.85),
        110.0,
        (0.75, 0.85, 1.0),
        (-1.5, 2.0, 0.9),
        "PRIMARY",
        "spot",
        spot_size=math.radians(42),
        spot_blend=0.4,
        shadow_soft_size=0.05,
    )
    kit.light(
        "Shelf lamp",
        "POINT",
        (-4.6, 4.3, 1.75),
        9.0,
        (1.0, 0.66, 0.34),
        None,
        "STATIC",
        "shelf",
        shadow_soft_size=0.045,
    )
    kit.tag(kit.sphere("Shelf bulb", (-4.6, 4.62, 1.75), 0.05, m["bulb"], 8, 16), light_set="shelf")


def build_views(scene):
    kit.camera("sunlit_room", (5.6, 0.55, 1.62), (0.0, 2.95, 1.22), 19.0)
    kit.camera("dark_room", (-0.45, 0.5, 1.6), (-4.6, 3.35, 1.3), 19.0)
    scene.camera = scene.objects["sunlit_room"]


def main():
    scene = kit.start()
    scene.name = "Two rooms"
    kit.tag(scene, preset="PREVIEW")
    kit.light_sets("ceiling", "neon", "shelf", "spot")
    m = make_materials()
    build_shell(m)
    build_windows(m)
    build_door(m)
    build_dark_props(m, build_sunlit_props(m))
    build_neon(m)
    build_lights(m)
    build_views(scene)
    kit.sky_world(kit.image("Sky", textures.sky(TOWARD_SUN), is_float=True), 3.5)
    kit.save("two_rooms.blend")


main()
