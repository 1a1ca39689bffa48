# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators, panels and pre-flight findings of light sets, doors and toggles."""
import os
import sys
from types import SimpleNamespace

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from support.addon import load_addon  # noqa: E402
from support.elements import add, collection, glow, lamp, light_set, quad, run_tests, select  # noqa: E402

ADDON = load_addon()
from ajar import checks, checks_elements, panels  # noqa: E402
from ajar.apply import record  # noqa: E402

ICONS = bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items.keys()


# ---- operators --------------------------------------------------------------------------------


def sets():
    """Names of the scene's light sets."""
    return [entry.name for entry in bpy.context.scene.ajar.light_sets]


def test_add_from_selection():
    a, sign, wall = lamp("Lamp A"), glow(quad("Sign")), quad("Wall")
    select(wall, sign, a)
    bpy.ops.ajar.light_set_add(from_selection=True, name="Bar")
    assert sets() == ["Bar"] and a.ajar.light_set == sign.ajar.light_set == "Bar" and not wall.ajar.light_set
    bpy.ops.ajar.light_set_add(from_selection=True)
    assert len(sets()) == 2 and sets()[1] in {"Lamp A", "Sign"} and a.ajar.light_set == sets()[1]
    select(wall)
    try:
        bpy.ops.ajar.light_set_add(from_selection=True)
    except RuntimeError as error:
        assert "emissive" in str(error)
    else:
        raise AssertionError("a set of a wall")
    assert len(sets()) == 2


def test_one_set_per_light():
    lamps = [lamp(f"L{i}") for i in range(3)]
    light_set("L1")
    assert not bpy.ops.ajar.light_set_per_light.poll()
    select(*lamps)
    bpy.ops.ajar.light_set_per_light()
    assert sets() == ["L1", "L0", "L1.001", "L2"]
    assert [obj.ajar.light_set for obj in lamps] == ["L0", "L1.001", "L2"]


def test_import_light_groups():
    assert not bpy.ops.ajar.light_set_import.poll()
    for name, group in (("A", "Key"), ("B", "Key"), ("C", "Fill"), ("D", "Key"), ("E", "")):
        lamp(name).lightgroup = group
    quad("Wall").lightgroup = "Fill"
    light_set("Own")
    bpy.data.objects["D"].ajar.light_set = "Own"
    bpy.ops.ajar.light_set_import()
    assert sorted(sets()) == ["Fill", "Key", "Own"]
    tags = {obj.name: obj.ajar.light_set for obj in bpy.data.objects}
    assert tags == {"A": "Key", "B": "Key", "C": "Fill", "D": "Own", "E": "", "Wall": ""}, tags


def test_renaming_a_set_keeps_its_lights():
    first, second = light_set("One"), light_set("Two")
    obj, held = lamp("L", "One"), collection("Ceiling")
    held.ajar.light_set = "One"
    hidden = bpy.data.collections.new("Prefab")
    inside = lamp("Inside", "One", collection=hidden)
    add("Instance", instance_type="COLLECTION", instance_collection=hidden)
    first.name = "Renamed"
    assert obj.ajar.light_set == held.ajar.light_set == inside.ajar.light_set == "Renamed"
    second.name = "Renamed"
    assert sets() == ["Renamed", "Renamed.001"] and obj.ajar.light_set == "Renamed"
    bpy.context.scene.ajar.light_set_index = 0
    bpy.ops.ajar.light_set_remove()
    assert sets() == ["Renamed.001"] and obj.ajar.light_set == held.ajar.light_set == ""


def test_marks():
    leaf, pose = quad("Leaf"), quad("Pose")
    knob, handle = quad("Knob", pose), quad("Handle", leaf)
    select(handle, knob, pose, leaf)
    bpy.ops.ajar.door_mark()
    assert leaf.ajar.movable == "DOOR" and leaf.ajar.open_pose == pose and pose.hide_render
    chair, table = quad("Chair"), add("Table")
    seat = quad("Seat", chair)
    select(seat, chair, table)
    bpy.ops.ajar.toggle_mark()
    assert (chair.ajar.movable, table.ajar.movable, seat.ajar.movable) == ("TOGGLE", "TOGGLE", "FIXED")
    bpy.ops.ajar.toggle_mark(clear=True)
    assert chair.ajar.movable == table.ajar.movable == "FIXED"
    select()
    assert not bpy.ops.ajar.toggle_mark.poll() and not bpy.ops.ajar.door_mark.poll()


# ---- panels -----------------------------------------------------------------------------------


class Probe:
    """A layout that draws nothing and refuses properties, operators, menus and icons that are not."""

    def __init__(self):
        self.drawn = set()

    def _container(self, **_options):
        return self

    row = column = box = split = _container

    def prop(self, owner, name, icon="NONE", **_options):
        assert name in owner.bl_rna.properties and icon in ICONS, name
        self.drawn.add(name)

    def prop_search(self, owner, name, source, names):
        assert names in source.bl_rna.properties
        self.prop(owner, name)

    def operator(self, name, icon="NONE", **_options):
        assert icon in ICONS, icon
        self.drawn.add(name)
        rna = getattr(bpy.ops.ajar, name.split(".")[1]).get_rna_type()
        return Options(rna.properties.keys())

    def menu(self, name, **_options):
        assert hasattr(bpy.types, name), name

    def template_list(self, name, _key, owner, items, active_owner, active, **_options):
        assert hasattr(bpy.types, name) and items in owner.bl_rna.properties
        assert active in active_owner.bl_rna.properties
        self.drawn.add(items)

    def label(self, text="", icon="NONE"):
        assert text and icon in ICONS, icon
        self.drawn.add(text)

    def separator(self):
        """Takes space."""


class Options:
    """Properties of a drawn operator; only those that exist can be set."""

    def __init__(self, names):
        object.__setattr__(self, "_names", set(names))

    def __setattr__(self, name, _value):
        assert name in self._names, name


def draw(cls, obj=None, held=None):
    """What a panel or menu draws for an object or collection."""
    scene, real = bpy.context.scene, bpy.context
    context = SimpleNamespace(
        scene=scene,
        object=obj,
        collection=held,
        world=scene.world,
        window_manager=real.window_manager,
        preferences=real.preferences,
        region=SimpleNamespace(width=300),
        space_data=SimpleNamespace(shading=SimpleNamespace(type="SOLID")),
    )
    probe = Probe()
    if hasattr(cls, "poll") and not cls.poll(context):
        return None
    cls.draw(SimpleNamespace(layout=probe, split_layout=lambda: probe), context)
    return probe.drawn


def panel(name):
    """A registered panel class of the add-on."""
    return next(cls for cls in panels.CLASSES if cls.__name__ == name)


def test_every_panel_draws():
    scene, obj, held = bpy.context.scene, quad("Leaf"), collection("Held")
    scene.world = bpy.data.worlds.new("Sky")
    light_set("Lamps")
    owners = [
        obj,
        lamp("Lamp"),
        add("Empty"),
        add("Other", instance_type="COLLECTION", instance_collection=held),
    ]
    for movable in ("FIXED", "DOOR", "TOGGLE"):
        obj.ajar.movable = held.ajar.movable = movable
        for cls in panels.CLASSES:
            if hasattr(cls, "draw"):
                assert any(draw(cls, owner, held) for owner in owners), cls.__name__
    item = Probe()
    bpy.types.AJAR_UL_light_sets.draw_item(
        None, bpy.context, item, None, scene.ajar.light_sets[0], 0, None, ""
    )
    assert item.drawn == {"name", "color", "weight"}


def test_last_bake_says_what_it_knows():
    record.write_record(
        bpy.context.scene,
        {
            "preset": "preview",
            "seconds": 61.0,
            "time_limited": True,
            "time_shares": [["doors", 0.31], ["sky", 0.2]],
            "error": {
                "unknown": "few bright samples",
                "estimated_rms": 0.04,
                "p95": 0.09,
                "spread": 0.4,
                "target": 0.03,
                "share_reached": 0.5,
                "next_step": {"noise": 0.02, "seconds": 240.0},
            },
            "self_check": {"ratio": 0.99, "ratio_error": 0.01},
            "warnings": [["Lamp", "gives no light"]],
        },
    )
    drawn = " ".join(draw(panel("AJAR_PT_sidebar_last")))
    for said in (
        "time limit",
        "unknown, few bright samples",
        "± 40%",
        "50% of texels",
        "4 min 0 s",
        "99.0%",
        "Lamp: gives no light",
        "sky 20%",
    ):
        assert said in drawn, (said, drawn)


def test_last_bake_says_why_it_was_not_checked():
    why = {"self_check": {"not_checked": "the disk is full"}}
    record.write_record(bpy.context.scene, {"preset": "draft", "seconds": 1.0, **why})
    assert "Not checked by brute force: the disk is full" in " ".join(draw(panel("AJAR_PT_sidebar_last")))


def test_what_looks_flipped_is_selected_baked_behind_or_flipped():
    rug, wall, shelf, fine = quad("Rug"), quad("Wall"), quad("Shelf"), quad("Fine")
    whole = "looks flipped, 100 % of its surface: dark. Flip its normals (Mesh > Normals > Flip), or set Bake side to Back"
    part = "looks flipped, 40 % of its surface: dark. Flip the faces that show red"
    more = "1 more objects look flipped, in part or whole: Shelf. Flip their normals"
    record.write_record(
        bpy.context.scene,
        {"preset": "draft", "seconds": 1.0, "warnings": [["Rug", whole], ["Wall", part], ["Scene", more]]},
    )
    assert checks.flipped_objects(bpy.context.scene) == {rug: True, wall: False, shelf: False}
    assert "ajar.flipped" in draw(panel("AJAR_PT_sidebar_last"))
    bpy.ops.ajar.flipped(action="SELECT")
    assert [obj.select_get() for obj in (rug, wall, shelf, fine)] == [True, True, True, False]
    before = [tuple(obj.data.polygons[0].normal) for obj in (rug, wall)]
    bpy.ops.ajar.flipped(action="FLIP")
    after = [tuple(obj.data.polygons[0].normal) for obj in (rug, wall)]
    assert after[0] == tuple(-c for c in before[0]) and after[1] == before[1], (before, after)
    bpy.ops.ajar.flipped(action="BACK")
    assert (rug.ajar.bake_side, wall.ajar.bake_side) == ("BACK", "FRONT")
    assert rug not in checks.flipped_objects(bpy.context.scene)


def test_panels_show_what_counts():
    obj, held = quad("Leaf", collection=collection("Held")), bpy.data.collections["Held"]
    assert "openness" not in draw(panel("AJAR_PT_object"), obj)
    obj.ajar.movable = "DOOR"
    assert draw(panel("AJAR_PT_object"), obj) >= {"openness", "open_pose", "bounce_when_closed", "combine"}
    knob = quad("Knob", obj)
    assert "openness" in draw(panel("AJAR_PT_sidebar_movables"), knob)
    assert any("Moves with Leaf" in text for text in draw(panel("AJAR_PT_object"), knob))
    obj.ajar.movable, held.ajar.movable = "FIXED", "TOGGLE"
    assert "presence" in draw(panel("AJAR_PT_sidebar_movables"), knob)
    assert "presence" in draw(panel("AJAR_PT_collection"), None, held)
    assert draw(panel("AJAR_PT_collection"), None, bpy.context.scene.collection) is None


# ---- findings ---------------------------------------------------------------------------------


def found(culprit, text):
    """Whether a finding about culprit says text."""
    findings = checks.check_scene(bpy.context, output=False)
    assert all(f.remedy for f in findings)
    return any(f.culprit == culprit and text in f.text for f in findings)


def test_findings_about_sets():
    light_set("Lit")
    light_set("Dark")
    lamp("L", "Lit")
    lamp("Lost", "Typo")
    wall = quad("Wall")
    wall.ajar.light_set = "Dark"
    assert found("Dark", "without lights") and found("Lost", "Typo") and found("Wall", "gives no light")
    assert not found("Lit", "without lights") and not found("L", "light set")
    glow(wall)
    assert not found("Dark", "without") and not found("Wall", "gives no light")
    wall.hide_render = True
    assert found("Dark", "without")
    checks_elements.MAX_ELEMENTS, limit = 1, checks_elements.MAX_ELEMENTS
    assert found("", "more than 1")
    checks_elements.MAX_ELEMENTS = limit
    assert not found("", "more than")


def test_findings_about_doors():
    door, pose = quad("Door"), quad("Pose")
    door.ajar.movable, door.ajar.open_pose = "DOOR", pose
    assert found("Pose", "renders too")
    attic = collection("Attic poses")
    bpy.context.scene.collection.objects.unlink(pose)
    attic.objects.link(pose)
    assert found("Pose", "renders too")
    attic.hide_render = True
    assert not found("Pose", "") and not found("Door", "")
    attic.hide_render, pose.hide_render = False, True
    assert not found("Pose", "") and not found("Door", "")
    pose.ajar.surface = "IGNORE"
    assert found("Pose", "Ignore")
    pose.ajar.surface, pose.ajar.movable = "OCCLUDER", "TOGGLE"
    assert found("Pose", "marked movable itself")
    pose.ajar.movable = "FIXED"
    second = quad("Second")
    second.ajar.movable, second.ajar.open_pose = "DOOR", pose
    assert found("Second", "belongs to Door")
    second.ajar.open_pose = second
    assert found("Second", "its own open pose")
    second.ajar.surface = "IGNORE"
    assert found("Second", "Ignore")
    attic.objects.unlink(pose)
    assert found("Door", "deleted")
    bpy.data.scenes.new("Attic").collection.objects.link(pose)
    assert found("Door", "Attic")
    door.hide_render = True
    assert found("Door", "without geometry")
    empty = add("Empty")
    empty.ajar.movable = "TOGGLE"
    assert found("Empty", "without geometry")
    quad("Part", empty)
    assert not found("Empty", "without geometry")


run_tests(globals(), ADDON, sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else ())
