# SPDX-License-Identifier: GPL-3.0-or-later
"""The preview follows weights: sliders, drivers, keyframes, saving, undo, and back to how it was."""
import json
import os
import sys
import tempfile

import bpy
import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from support.addon import load_addon, render_pixels, write_package  # noqa: E402
from support.elements import add, collection, glow, lamp, light_set, quad, run_tests, select  # noqa: E402
from support.fake_runtime import FakeRuntime  # noqa: E402

ADDON = load_addon()
from ajar.apply import clear, ghosts, images, live, preview  # noqa: E402
from ajar.apply.uvs import write_uv_layer  # noqa: E402

FOLDER = os.environ.get("AJAR_TEST_DIR") or tempfile.mkdtemp(prefix="ajar-test-")
BASE = ((0.5, 0.5, 0.5), (2.0, 1.0, 0.5))
LAMP, DOOR, VASE = (1.0, 2.0, 4.0), (0.25, 0.0, 0.0), (0.0, -0.125, 0.0)


def show(base=BASE, **weights):
    """Pretends that the scene was baked, and turns the preview on. Returns (run time, warnings)."""
    elements = [
        ("Lamps", "light_set", 1.0, 0, LAMP),
        ("Door", "door", 0.0, 1, DOOR),
        ("Vase", "toggle", 1.0, 1, VASE),
        *weights.get("more", ()),
    ]
    package = write_package(FOLDER, base)
    path = os.path.join(package, "manifest.json")
    with open(path, encoding="utf-8") as file:
        manifest = json.load(file)
    manifest["elements"] = [{"name": e[0], "kind": e[1], "weight": e[2]} for e in elements]
    with open(path, "w", encoding="utf-8") as file:
        json.dump(manifest, file)
    live.open_package = lambda _package: FakeRuntime(base, elements)
    bpy.context.scene.ajar.last_bake = json.dumps({"package": package})
    warnings = preview.show(bpy.context)
    return FakeRuntime.opened[-1], warnings


def room():
    """A scene with a lamp in a set, a door with an open pose, and a toggle."""
    light_set("Lamps")
    lamp("L", "Lamps")
    leaf, vase = quad("Door"), quad("Vase")
    for page in range(len(BASE)):
        mapped(f"Floor {page}", page)
    quad("Handle", leaf)
    poses = collection("Poses")
    poses.hide_viewport = poses.hide_render = True
    pose = quad("Pose", collection=poses, hide_render=True)
    quad("Pose handle", pose, poses, hide_render=True)
    leaf.ajar.movable, leaf.ajar.open_pose, vase.ajar.movable = "DOOR", pose, "TOGGLE"
    bpy.context.view_layer.update()


def mapped(name, page):
    """A square that shows a page, far from the others."""
    obj = quad(name, location=(0, 0, -10 - page))
    obj.ajar.lightmap_page = page
    write_uv_layer(obj.data, numpy.array([0, 0, 1, 0, 1, 1, 0, 1], dtype=numpy.float32))
    return obj


def pixel(page):
    """Colour of a page's image."""
    return list(images.find_live(page).pixels[:3])


def check_pages(runtime):
    """The images show what the run time has."""
    for page in range(runtime.page_count()):
        assert numpy.allclose(pixel(page), runtime.color(page)), (page, pixel(page), runtime.color(page))


def is_ghost(name):
    """Whether the preview hides an object; its rays and flags agree with that."""
    obj = bpy.data.objects[name]
    rays = {getattr(obj, ray) for ray in ghosts._RAYS}
    assert len(rays) == 1 and rays == {obj.ajar.saved_rays < 0}, name
    clear_slots = {bool(s.material and s.material.name == ghosts._HIDDEN) for s in obj.material_slots}
    assert clear_slots == {obj.ajar.saved_rays >= 0}, name
    return obj.ajar.saved_rays >= 0


def state():
    """Everything of the artist's that the preview may not change."""
    objects = {}
    for obj in bpy.data.objects:
        rays = [getattr(obj, ray) for ray in ghosts._RAYS]
        slots = [(s.link, s.material and s.material.name) for s in obj.material_slots]
        keys = sorted(set(obj.keys()) - {"ajar"})
        held = sorted(c.name for c in obj.users_collection)
        data = obj.data and obj.data.name
        eye = obj.hide_get()
        flags = (obj.hide_viewport, obj.hide_render, eye, obj.instance_type)
        objects[obj.name] = [rays, slots, keys, held, data, flags]
    lights = {l.name: (l.energy, list(l.color)) for l in bpy.data.lights}
    names = [
        sorted(b.name for b in getattr(bpy.data, k)) for k in ("collections", "materials", "lights", "worlds")
    ]
    return json.dumps([objects, lights, names], sort_keys=True)


def handlers():
    """How many handlers watch the scene."""
    groups = (
        bpy.app.handlers.depsgraph_update_post,
        bpy.app.handlers.frame_change_post,
        bpy.app.handlers.save_pre,
    )
    return [len([h for h in group if h.__module__ == live.__name__]) for group in groups]


# ---- weights ----------------------------------------------------------------------------------


def test_starts_at_the_weights_of_the_scene():
    room()
    bpy.context.scene.ajar.light_sets["Lamps"].weight = 0.25
    bpy.data.objects["Door"].ajar.openness = 1.0
    runtime, warnings = show()
    assert not warnings, warnings
    check_pages(runtime)
    assert numpy.allclose(pixel(0), [0.5 + 0.25 * x for x in LAMP])
    mean = numpy.mean([runtime.color(0), runtime.color(1)], axis=0)
    assert numpy.allclose(pixel(images.MEAN), mean)
    assert is_ghost("Door") and is_ghost("Handle") and not is_ghost("Pose") and not is_ghost("Vase")


def test_sliders_update_only_their_pages():
    room()
    runtime, _ = show()
    entry = bpy.context.scene.ajar.light_sets["Lamps"]
    entry.weight = 0.5
    assert runtime.updates[-1] == [0]
    check_pages(runtime)
    entry.color = (1.0, 0.0, 0.5)
    assert numpy.allclose(pixel(0), [1.0, 0.5, 1.5])
    bpy.data.objects["Door"].ajar.openness = 0.75
    assert runtime.updates[-1] == [1]
    bpy.data.objects["Vase"].ajar.presence = 0.0
    check_pages(runtime)
    count = len(runtime.updates)
    bpy.context.view_layer.update()
    entry.weight = 0.5
    assert len(runtime.updates) == count, "nothing changed"


def test_doors_and_toggles_come_and_go():
    room()
    show()
    stage = ("Pose", "Pose handle")
    assert not is_ghost("Door") and not is_ghost("Vase") and all(map(is_ghost, stage))
    assert all(
        bpy.data.objects[n].visible_get() for n in ("Door", "Vase", *stage)
    ), "in the graph all the time"
    bpy.data.objects["Door"].ajar.openness = 0.5
    assert is_ghost("Door") and is_ghost("Handle") and not any(map(is_ghost, stage))
    bpy.data.objects["Vase"].ajar.presence = 0.49
    assert is_ghost("Vase")
    bpy.data.objects["Vase"].ajar.presence = 0.5
    bpy.data.objects["Door"].ajar.openness = 0.49
    assert not is_ghost("Vase") and not is_ghost("Door") and all(map(is_ghost, stage))


def test_keyframes_and_drivers():
    room()
    scene, door, vase = bpy.context.scene, bpy.data.objects["Door"], bpy.data.objects["Vase"]
    for frame, value in ((1, 0.0), (11, 1.0)):
        scene.ajar.light_sets[0].weight = value
        scene.keyframe_insert("ajar.light_sets[0].weight", frame=frame)
        door.ajar.openness = value
        door.keyframe_insert("ajar.openness", frame=frame)
    variable = vase.driver_add("ajar.presence").driver
    variable.expression = "1 - frame / 20"
    runtime, _ = show()
    for frame, opened in ((11, True), (1, False), (6, None), (20, True)):
        scene.frame_set(frame)
        weights = [e.weight for e in runtime.elements()]
        assert numpy.allclose(weights[1], door.ajar.openness) and numpy.allclose(weights[2], 1 - frame / 20)
        check_pages(runtime)
        if opened is not None:
            assert is_ghost("Door") == opened and is_ghost("Vase") == (frame > 10), frame


# ---- lights -----------------------------------------------------------------------------------


def test_primary_lamps_dim_with_their_set():
    room()
    shared = bpy.data.lights.new("Shared", "SPOT")
    shared.energy, shared.color = 40.0, (1.0, 0.5, 0.25)
    for name, tag in (("P1", "Lamps"), ("P2", "")):
        add(name, shared).ajar.light_set = tag
    before = state()
    show()
    entry = bpy.context.scene.ajar.light_sets["Lamps"]
    entry.weight, entry.color = 0.5, (0.0, 1.0, 1.0)
    lit, other = bpy.data.objects["P1"].data, bpy.data.objects["P2"].data
    assert lit.energy == 20.0 and list(lit.color) == [0.0, 0.5, 0.25]
    assert other.energy == 40.0 and bpy.data.objects["L"].hide_render
    preview.hide()
    entry.weight, entry.color = 1.0, (1, 1, 1)
    assert state() == before


def test_edits_of_a_dimmed_lamp_are_kept():
    room()
    lamp("P", "Lamps").ajar.light_role = "PRIMARY"
    bpy.context.scene.ajar.light_sets["Lamps"].weight = 0.5
    own = bpy.data.objects["P"].data
    own.energy = 10.0
    show()
    data = bpy.data.objects["P"].data
    assert data != own and data.energy == 5.0
    data.energy, data.shadow_soft_size = 20.0, 0.75
    bpy.context.scene.ajar.light_sets["Lamps"].weight = 0.25
    assert data.energy == 10.0
    preview.hide()
    assert bpy.data.objects["P"].data == own and own.energy == 40.0 and own.shadow_soft_size == 0.75


def test_glow_of_a_set():
    """A glowing mesh dims with its set; one outside of it does not."""
    light_set("Lamps")
    for x, tag in ((0, "Lamps"), (2, "")):
        sign = glow(quad(f"Sign {x}", location=(x, 0, 0)))
        sign.ajar.light_set = tag
        sign.data.materials[0].node_tree.nodes["Emission"].inputs["Color"].default_value = (
            1.0,
            0.5,
            0.25,
            1.0,
        )
    camera = add("Camera", bpy.data.cameras.new("Camera"), location=(1.5, 0.5, 5))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 3.0
    bpy.context.scene.camera = camera
    show()
    for weight, color in ((1.0, (1, 1, 1)), (0.25, (1.0, 0.0, 2.0))):
        entry = bpy.context.scene.ajar.light_sets["Lamps"]
        entry.weight, entry.color = weight, color
        pixels = render_pixels(FOLDER, (48, 16), 4)
        want = weight * numpy.array(color) * (1.0, 0.5, 0.25)
        assert numpy.allclose(pixels[8, 8, :3], want, atol=0.02), (pixels[8, 8], want)
        assert numpy.allclose(pixels[8, 40, :3], (1.0, 0.5, 0.25), atol=0.02), pixels[8, 40]


def test_render_shows_the_state():
    """A lightmapped floor, a toggle in front of it: pixels by closed form at two states."""
    room()
    for name in ("Door", "Handle", "Pose", "Pose handle"):
        bpy.data.objects[name].location.x = 50.0
    vase = bpy.data.objects["Vase"]
    camera = add("Camera", bpy.data.cameras.new("Camera"), location=(0.5, 0.5, 5))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 0.5
    bpy.context.scene.camera = camera
    runtime, _ = show()
    bpy.context.scene.ajar.light_sets["Lamps"].weight = 0.5
    mean = numpy.mean([runtime.color(0), runtime.color(1)], axis=0)
    found = render_pixels(FOLDER, (8, 8), 4)[4, 4, :3]
    assert numpy.allclose(found, 0.8 * mean / numpy.pi, rtol=0.01), (found, mean)
    vase.ajar.presence = 0.0
    found = render_pixels(FOLDER, (8, 8), 4)[4, 4, :3]
    assert numpy.allclose(found, 0.8 * numpy.array(runtime.color(0)) / numpy.pi, rtol=0.01), found


def test_rendered_animation_follows_keyframes():
    """Each frame of a rendered animation has the weights of its own time."""
    room()
    scene, vase, runtime = bpy.context.scene, bpy.data.objects["Vase"], None
    vase.location.z = -5.0
    for frame, weight, presence in ((1, 0.0, 1.0), (2, 1.0, 0.0)):
        scene.ajar.light_sets[0].weight, vase.ajar.presence = weight, presence
        scene.keyframe_insert("ajar.light_sets[0].weight", frame=frame)
        vase.keyframe_insert("ajar.presence", frame=frame)
    camera = add("Camera", bpy.data.cameras.new("Camera"), location=(0.5, 0.5, -1))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 0.5
    scene.camera, scene.frame_start, scene.frame_end = camera, 1, 2
    runtime, _ = show()
    render_pixels(FOLDER, (8, 8), 4)
    scene.frame_set(1)
    scene.render.filepath = os.path.join(FOLDER, "frame_")
    bpy.ops.render.render(animation=True)
    found = []
    for frame in (1, 2):
        image = bpy.data.images.load(os.path.join(FOLDER, f"frame_{frame:04d}.exr"))
        found.append(numpy.array(image.pixels).reshape(8, 8, 4)[4, 4, :3] * numpy.pi / 0.8)
    first = numpy.array(BASE[0]), numpy.array(BASE[1]) + VASE
    assert numpy.allclose(found[0], numpy.mean(first, axis=0), rtol=0.02), found
    assert numpy.allclose(found[1], numpy.array(BASE[0]) + LAMP, rtol=0.02), found


# ---- back, files, undo ------------------------------------------------------------------------


def test_off_restores_everything():
    room()
    pose = bpy.data.objects["Pose"]
    bpy.data.collections["Poses"].hide_viewport = False
    bpy.context.view_layer.update()
    pose.hide_set(True)
    bpy.data.objects["Vase"].visible_shadow = False
    prefab = bpy.data.collections.new("Prop")
    quad("Seat", collection=prefab)
    chair = add("Chair", instance_type="COLLECTION", instance_collection=prefab)
    chair.ajar.movable = "TOGGLE"
    lamp("P", "Lamps").ajar.light_role = "PRIMARY"
    before = state()
    runtime, _ = show(more=[("Chair", "toggle", 1.0, 0, (0, 0, 0))])
    assert handlers() == [1, 1, 1] and pose.visible_get()
    for obj in bpy.data.objects:
        obj.ajar.openness, obj.ajar.presence = 1.0, 0.0
    assert chair.instance_type == "NONE" and is_ghost("Vase")
    preview.hide()
    for obj in bpy.data.objects:
        obj.ajar.openness, obj.ajar.presence = 0.0, 1.0
    assert handlers() == [0, 0, 0] and runtime.closed
    assert state() == before, f"{state()}\n{before}"
    assert not any(i.ajar.live_page != images.NOT_LIVE for i in bpy.data.images)
    show()
    clear.clear(bpy.context.scene)
    assert (
        state() == before and handlers() == [0, 0, 0] and not bpy.context.scene.ajar.light_sets[0].baked_name
    )


def reopen(path):
    """Saves and opens the file again."""
    bpy.ops.wm.save_as_mainfile(filepath=path, check_existing=False)
    bpy.ops.wm.open_mainfile(filepath=path)


def test_saved_file_goes_on_following():
    room()
    before = state()
    runtime, _ = show()
    bpy.context.scene.ajar.light_sets["Lamps"].weight = 0.5
    bpy.data.objects["Door"].ajar.openness = 1.0
    reopen(os.path.join(FOLDER, "live.blend"))
    assert runtime.closed and FakeRuntime.opened[-1] is not runtime and handlers() == [1, 1, 1]
    runtime = FakeRuntime.opened[-1]
    check_pages(runtime)
    bpy.context.scene.ajar.light_sets["Lamps"].weight = 0.125
    check_pages(runtime)
    bpy.data.objects["Door"].ajar.openness = 0.0
    assert not is_ghost("Door") and is_ghost("Pose")
    preview.hide()
    bpy.context.scene.ajar.light_sets["Lamps"].weight = 1.0
    assert state() == before


def test_saved_file_shows_its_state_without_the_run_time():
    room()
    runtime, _ = show()
    bpy.context.scene.ajar.light_sets["Lamps"].weight = 3.0

    def missing(_package):
        raise ValueError("the run-time library is not installed")

    live.open_package = missing
    reopen(os.path.join(FOLDER, "static.blend"))
    assert numpy.allclose(pixel(0), runtime.color(0), rtol=1e-3), "what was saved"
    assert handlers() == [0, 0, 0] and "not installed" in live.problem
    bpy.context.scene.ajar.light_sets["Lamps"].weight = 0.0
    preview.hide()
    assert not live.problem and not bpy.data.objects["Door"].ajar.preview_slots


def test_base_images_without_the_run_time():
    room()
    show()

    def missing(_package):
        raise ValueError("gone")

    live.open_package = missing
    warnings = preview.show(bpy.context)
    assert len(warnings) == 1 and warnings[0][0] == "package" and "gone" in warnings[0][1], warnings
    shown = [i for i in bpy.data.images if i.ajar.is_page]
    assert len(shown) == 2 and all(i.ajar.live_page == images.NOT_LIVE for i in shown)


def test_package_without_elements_needs_no_run_time():
    room()
    package = write_package(FOLDER, BASE)
    bpy.context.scene.ajar.last_bake = json.dumps({"package": package})
    assert preview.show(bpy.context) == [] and handlers() == [0, 0, 0]


def test_renamed_and_lost_elements():
    room()
    show()
    preview.hide()
    bpy.context.scene.ajar.light_sets["Lamps"].name = "Ceiling"
    bpy.data.objects["Door"].name = "Gate"
    bpy.data.objects["Vase"].ajar.movable = "FIXED"
    runtime, warnings = show()
    assert [culprit for culprit, _ in warnings] == ["Vase"], warnings
    bpy.context.scene.ajar.light_sets["Ceiling"].weight = 0.5
    bpy.data.objects["Gate"].ajar.openness = 1.0
    assert [e.weight for e in runtime.elements()] == [0.5, 1.0, 1.0]


def test_undo():
    """The user may undo a slider, and turning the preview on."""
    room()
    bpy.ops.ed.undo_push(message="start")
    runtime, _ = show()
    bpy.ops.ed.undo_push(message="preview")
    bpy.context.scene.ajar.light_sets["Lamps"].weight = 0.5
    bpy.data.objects["Door"].ajar.openness = 1.0
    bpy.ops.ed.undo_push(message="slider")
    bpy.ops.ed.undo()
    assert bpy.context.scene.ajar.light_sets["Lamps"].weight == 1.0
    check_pages(FakeRuntime.opened[-1])
    assert not is_ghost("Door") and is_ghost("Pose")
    bpy.ops.ed.undo()
    assert not bpy.context.scene.ajar.preview and handlers() == [0, 0, 0]
    bpy.ops.ed.redo()
    assert bpy.context.scene.ajar.preview and handlers() == [1, 1, 1]
    check_pages(FakeRuntime.opened[-1])


run_tests(globals(), ADDON, sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else ())
