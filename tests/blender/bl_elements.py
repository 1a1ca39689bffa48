# SPDX-License-Identifier: GPL-3.0-or-later
"""Light sets, doors and toggles: from tags on objects and collections to the snapshot."""
import importlib
import json
import os
import sys
import tempfile

import bpy
import jsonschema

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from support.addon import ROOT, load_addon  # noqa: E402
from support.elements import add, collection, glow, lamp, light_set, quad, run_tests  # noqa: E402

ADDON = load_addon()
snapshot = importlib.import_module("ajar.extract.snapshot")
layout_module = importlib.import_module("ajar.extract.layout")
settings = importlib.import_module("ajar.settings")
model = importlib.import_module("ajar.model")


class Shot:
    """The snapshot of the open scene, checked against its schema."""

    def __init__(self):
        with tempfile.TemporaryDirectory() as folder:
            wanted = settings.engine_settings(bpy.context.scene)
            self.result = snapshot.write_snapshot(bpy.context, folder, wanted)
            with open(os.path.join(folder, "snapshot.json"), encoding="utf-8") as file:
                self.data = json.load(file)
        with open(os.path.join(ROOT, "schemas", "snapshot.schema.json"), encoding="utf-8") as file:
            jsonschema.validate(self.data, json.load(file))
        self.elements = self.data["elements"]

    def names(self):
        """[(kind, name)] of the elements."""
        return [(e["kind"], e["name"]) for e in self.elements]

    def element(self, name):
        """The one element of a name."""
        (found,) = [e for e in self.elements if e["name"] == name]
        return found

    def part(self, name):
        """(element name or None, open pose) of an instance."""
        record = next(i for i in self.data["instances"] if i["name"] == name)
        index = record.get("element")
        return (None if index is None else self.elements[index]["name"]), record.get("open_pose", False)

    def light_set(self, name):
        """Name of the light set of a lamp or instance, or None."""
        record = next(r for r in self.data["lights"] + self.data["instances"] if r["name"] == name)
        index = record.get("light_set")
        return None if index is None else self.elements[index]["name"]

    def has(self, name):
        """Whether an instance was extracted."""
        return any(i["name"] == name for i in self.data["instances"])

    def warned(self, culprit, part):
        """Whether a warning about culprit says part."""
        return any(c == culprit and part in t for c, t in self.result.warnings)


# ---- light sets -------------------------------------------------------------------------------


def test_light_sets():
    for name, weight, combine in (("B", 0.5, False), ("A", 2.0, True), ("Empty", 1.0, True)):
        light_set(name, weight, combine)
    lamp("L1", "A")
    lamp("L2", "B")
    lamp("L3")
    lamp("L4", "Typo")
    lamp("Off", "Empty").ajar.light_role = "OFF"
    glow(quad("Sign")).ajar.light_set = "B"
    quad("Dull").ajar.light_set = "A"
    shot = Shot()
    assert shot.names() == [("light_set", "B"), ("light_set", "A")], "the order of the scene's list"
    assert shot.element("B") == {"name": "B", "kind": "light_set", "weight": 0.5, "combine": False}
    assert [shot.light_set(n) for n in ("L1", "L2", "L3", "L4")] == ["A", "B", None, None]
    assert shot.light_set("Sign") == "B" and shot.light_set("Dull") is None
    assert (
        shot.warned("Empty", "without lights")
        and shot.warned("L4", "'Typo'")
        and shot.warned("Dull", "glows")
    )


def test_light_sets_of_collections_and_instancers():
    for name in ("Ceiling", "Desk", "First"):
        light_set(name)
    outer = collection("Outer")
    outer.ajar.light_set = "Ceiling"
    inner = collection("Inner", outer)
    lamp("Deep", collection=inner)
    lamp("Own", "Desk", collection=inner)
    quad("Housing", collection=inner)
    prefab = bpy.data.collections.new("Lamp prefab")
    lamp("Bulb", "Desk", collection=prefab)
    for name, tag in (("Lamp 1", "First"), ("Lamp 2", "")):
        add(name, instance_type="COLLECTION", instance_collection=prefab).ajar.light_set = tag
    shot = Shot()
    assert shot.light_set("Deep") == "Ceiling" and shot.light_set("Own") == "Desk"
    assert shot.light_set("Lamp 1/Bulb.0") == "First" and shot.light_set("Lamp 2/Bulb.0") == "Desk"
    assert not shot.result.warnings, shot.result.warnings


# ---- doors ------------------------------------------------------------------------------------


def test_door_with_children():
    leaf = quad("Leaf")
    leaf.ajar.movable, leaf.ajar.openness = "DOOR", 0.25
    leaf.ajar.bounce_when_closed = leaf.ajar.combine = False
    quad("Hinge", add("Pivot", parent=leaf))
    quad("Wall")
    shot = Shot()
    assert shot.elements == [
        {"name": "Leaf", "kind": "door", "weight": 0.25, "combine": False, "bounce": False}
    ]
    assert shot.part("Leaf") == shot.part("Hinge") == ("Leaf", False) and shot.part("Wall") == (None, False)


def test_hidden_open_pose_is_extracted():
    """Also from a collection that neither renders nor shows, with its parts, and lit by texels."""
    leaf = quad("Leaf")
    poses = collection("Poses")
    poses.hide_render = poses.hide_viewport = True
    pose = quad("Pose", collection=poses, hide_render=True, hide_viewport=True)
    quad("Knob", pose, poses, hide_render=True)
    quad("Cutter", pose, poses, hide_render=True, display_type="WIRE")
    quad("Stranger", collection=poses)
    leaf.ajar.movable, leaf.ajar.open_pose = "DOOR", pose
    shot = Shot()
    assert shot.names() == [("door", "Leaf")] and shot.part("Leaf") == ("Leaf", False)
    assert shot.part("Pose") == shot.part("Knob") == ("Leaf", True)
    assert not shot.has("Stranger") and not shot.has("Cutter") and not shot.result.warnings
    assert poses.hide_viewport and pose.hide_viewport and pose.hide_render, "the scene changed"
    for obj in bpy.data.objects:
        obj.ajar.surface = "AUTO"
    with tempfile.TemporaryDirectory() as folder:
        mapping = layout_module.write_layout_request(bpy.context, folder, model.layout_settings())
    assert [name for name, _ in mapping.meshes] == ["Knob", "Leaf", "Pose"], mapping.meshes


def test_open_pose_below_the_leaf():
    """The pose wins for what hangs on it, whichever of the two is the parent."""
    leaf = quad("Leaf")
    pose = quad("Pose", leaf)
    quad("Pose handle", pose)
    quad("Handle", leaf)
    leaf.ajar.movable, leaf.ajar.open_pose = "DOOR", pose
    shot = Shot()
    assert shot.part("Handle") == ("Leaf", False) and shot.part("Pose handle") == ("Leaf", True)


def test_a_part_hidden_in_a_shown_pose_stays_hidden():
    leaf, pose = quad("Leaf"), quad("Pose")
    quad("Spare", pose, hide_render=True)
    leaf.ajar.movable, leaf.ajar.open_pose = "DOOR", pose
    shot = Shot()
    assert shot.part("Pose") == ("Leaf", True) and not shot.has("Spare")


def test_collection_is_one_door():
    door = collection("Gate")
    quad("Left", collection=door)
    quad("Right", collection=collection("Right half", door))
    quad("Bell", bpy.data.objects["Left"])
    pose = add("Swung")
    quad("Left open", pose, hide_render=True)
    pose.hide_render = True
    door.ajar.movable, door.ajar.openness, door.ajar.open_pose = "DOOR", 0.5, pose
    door.ajar.bounce_when_closed = False
    shot = Shot()
    assert shot.elements == [
        {"name": "Gate", "kind": "door", "weight": 0.5, "combine": True, "bounce": False}
    ]
    assert {shot.part(n) for n in ("Left", "Right", "Bell")} == {("Gate", False)}
    assert shot.part("Left open") == ("Gate", True)


def test_doors_of_a_prefab_are_one_each():
    prefab = bpy.data.collections.new("Door prefab")
    leaf = quad("Leaf", collection=prefab)
    pose = quad("Pose", collection=prefab, hide_render=True)
    leaf.ajar.movable, leaf.ajar.open_pose = "DOOR", pose
    quad("Frame", collection=prefab)
    wing = bpy.data.collections.new("Wing")
    for name in ("W1", "W2"):
        add(name, collection=wing, instance_type="COLLECTION", instance_collection=prefab)
    add("D1", instance_type="COLLECTION", instance_collection=prefab)
    add("West", instance_type="COLLECTION", instance_collection=wing)
    shot = Shot()
    assert len(shot.names()) == 3 and ("door", "D1/Leaf") in shot.names(), shot.names()
    assert shot.part("D1/Leaf.0") == ("D1/Leaf", False)
    opened = [i["name"] for i in shot.data["instances"] if i.get("open_pose")]
    assert len(opened) == 3 and shot.part(opened[0])[0] == "D1/Leaf", opened
    assert not any("element" in i for i in shot.data["instances"] if "Frame" in i["name"])


def test_door_warnings():
    bare = add("Bare")
    bare.ajar.movable = "DOOR"
    ghost = quad("Ghost", hide_render=True)
    ghost.ajar.movable = "TOGGLE"
    lost = quad("Lost pose")
    bpy.context.scene.collection.objects.unlink(lost)
    bpy.data.scenes.new("Other").collection.objects.link(lost)
    pose = quad("Pose")
    for name, target in (("D1", lost), ("D2", pose), ("D3", pose)):
        door = quad(name)
        door.ajar.movable, door.ajar.open_pose = "DOOR", target
    shot = Shot()
    assert shot.warned("Bare", "without geometry") and shot.warned("Ghost", "without geometry")
    assert shot.warned("D1", "'Lost pose'") and shot.warned("D3", "'D2'")
    assert shot.part("Pose") == ("D2", True) and not shot.has("Lost pose")
    assert shot.names() == [("door", n) for n in ("D1", "D2", "D3")]


# ---- toggles ----------------------------------------------------------------------------------


def test_toggles_and_nesting():
    cupboard = quad("Cupboard")
    cupboard.ajar.movable, cupboard.ajar.presence = "TOGGLE", 0.75
    flap = quad("Flap", cupboard)
    flap.ajar.movable = "DOOR"
    quad("Shelf", cupboard)
    lamp("Inside", parent=cupboard)
    props = collection("Cupboard")
    props.ajar.movable = "TOGGLE"
    quad("Vase", collection=props)
    shot = Shot()
    assert shot.names() == [("door", "Flap"), ("toggle", "Cupboard"), ("toggle", "Cupboard (collection)")]
    assert shot.element("Cupboard") == {"name": "Cupboard", "kind": "toggle", "weight": 0.75, "combine": True}
    assert shot.part("Shelf") == ("Cupboard", False) and shot.part("Vase") == ("Cupboard (collection)", False)
    assert shot.warned("Flap", "toggle 'Cupboard'") and shot.warned("Inside", "light set")


def test_names_are_unique():
    """Games look elements up by name, whatever their kind."""
    light_set("Lamp")
    lamp("Bulb", "Lamp")
    stand, held = quad("Lamp"), collection("Lamp")
    stand.ajar.movable = held.ajar.movable = "TOGGLE"
    quad("Cloth", collection=held)
    names = [name for _kind, name in Shot().names()]
    assert sorted(names) == ["Lamp", "Lamp (collection)", "Lamp (toggle)"], names


def test_toggle_of_an_instancer():
    prefab = bpy.data.collections.new("Prop")
    quad("Seat", collection=prefab)
    for name in ("Chair 1", "Chair 2"):
        add(name, instance_type="COLLECTION", instance_collection=prefab).ajar.movable = "TOGGLE"
    shot = Shot()
    assert shot.names() == [("toggle", "Chair 1"), ("toggle", "Chair 2")]
    assert shot.part("Chair 2/Seat.0") == ("Chair 2", False)


# ---- settings ---------------------------------------------------------------------------------


def test_settings():
    bpy.context.scene.ajar.combinations, bpy.context.scene.ajar.term_threshold = "ALL", 0.25
    found = Shot().data["settings"]
    assert found["combinations"] == "ALL" and found["term_threshold"] == 0.25


run_tests(globals(), ADDON, sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else ())
