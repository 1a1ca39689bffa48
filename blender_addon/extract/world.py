# SPDX-License-Identifier: GPL-3.0-or-later
"""The sky: a constant, an HDRI as it is, or a panorama that Cycles renders of any world."""

import math
import os
import tempfile
from contextlib import ExitStack, contextmanager

import bpy

from .compat import ajar, has, rec709
from .evaluate import Evaluator
from .images import MissingImage, load_image
from .tree import active_output, find_input, resolve
from .values import IDENTITY, Inexact, Sampler

SKY_WIDTH = 1024  # texels; height is half
DETAILED_WIDTH = 2048  # for images and sun discs
SKY_SAMPLES = 16


def extract_sky(scene, store, warnings):
    """Snapshot dict of the scene's world."""
    world = scene.world
    if world is None or ajar(world, "sky_role") == "OFF":
        return {"type": "none"}
    if not world.use_nodes or world.node_tree is None:
        return _constant(rec709(world.color))
    output = active_output(world.node_tree, "ShaderNodeOutputWorld")
    source = resolve((), find_input(output, "Surface")) if output is not None else None
    if source is None or source.node is None:
        return {"type": "none"}
    return _simple(source, store, lambda text: warnings.add(world.name, text)) or _rendered(
        scene, world, store, warnings
    )


def _constant(color):
    return {"type": "constant", "color": list(color)} if any(color) else {"type": "none"}


def _equirect(store, key, color=(1.0, 1.0, 1.0)):
    sampler = Sampler(None, IDENTITY, "repeat", False)
    return {"type": "equirect", "color": list(color), "texture": store.index(key, sampler)}


def _simple(source, store, warn):
    """A constant, or an environment image times a constant; None for anything else."""
    if source.node.bl_idname != "ShaderNodeBackground":
        return None
    evaluator = Evaluator(store, warn)
    try:
        strength = evaluator.number(source.scope, source.node, "Strength", default=1.0)
        image = _environment(source)
        if image is not None:
            key = store.put(("sky", image.name_full), load_image(image, False, DETAILED_WIDTH))
            return _equirect(store, key, (strength,) * 3)
        color = evaluator.color(source.scope, source.node, "Color")
    except MissingImage as reason:
        warn(f"sky image: {reason}; there is no sky light")
        return {"type": "none"}
    except Inexact:
        return None
    return _constant(tuple(strength * v for v in color.constant)) if color.is_constant else None


def _environment(source):
    """Image of an Environment Texture that is used as it is, or None."""
    origin = resolve(source.scope, find_input(source.node, "Color"))
    node = origin.node
    if node is None or node.bl_idname != "ShaderNodeTexEnvironment" or node.projection != "EQUIRECTANGULAR":
        return None
    coordinates = resolve(origin.scope, node.inputs["Vector"])
    plain = coordinates.node is None or (
        coordinates.node.bl_idname == "ShaderNodeTexCoord" and coordinates.socket.name == "Generated"
    )
    if node.image is None and plain:
        raise MissingImage("no image is chosen")
    return node.image if plain else None


def _rendered(scene, world, store, warnings):
    """Panorama of a world by Cycles; its mean is at hand if Cycles is missing: none, with a warning."""
    detailed = any(
        n.bl_idname in {"ShaderNodeTexSky", "ShaderNodeTexEnvironment"} for n in _all_nodes(world.node_tree)
    )
    try:
        texels = render_panorama(world, DETAILED_WIDTH if detailed else SKY_WIDTH, scene.frame_current)
    except (RuntimeError, TypeError, MissingImage) as error:
        warnings.add(world.name, f"the sky could not be rendered by Cycles ({error}): there is no sky light")
        return {"type": "none"}
    return _equirect(store, store.put(("sky", world.name_full), texels))


def _all_nodes(tree):
    for node in tree.nodes:
        yield node
        if getattr(node, "node_tree", None) is not None:
            yield from _all_nodes(node.node_tree)


def render_panorama(world, width, frame=1):
    """Texels of (width / 2, width, 4) f32 linear: the world in Blender's equirectangular mapping.

    Renders a temporary scene that is removed again. Raises RuntimeError or TypeError without Cycles.
    """
    with ExitStack() as stack:
        stack.enter_context(_no_new_render_result())
        folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="ajar_sky_"))
        scene = stack.enter_context(_temporary(bpy.data.scenes, bpy.data.scenes.new("AjarSky")))
        copy = stack.enter_context(_temporary(bpy.data.worlds, world.copy()))
        camera = stack.enter_context(_temporary(bpy.data.cameras, bpy.data.cameras.new("AjarSky")))
        viewer = stack.enter_context(_temporary(bpy.data.objects, bpy.data.objects.new("AjarSky", camera)))
        _hide_camera_branch(copy)
        scene.world, scene.camera = copy, viewer
        scene.collection.objects.link(viewer)
        _panoramic(camera, viewer)
        path = os.path.join(folder, "sky.exr")
        _set_up(scene, width, path, frame)
        bpy.ops.render.render(write_still=True, scene=scene.name)
        image = stack.enter_context(_temporary(bpy.data.images, bpy.data.images.load(path)))
        texels = load_image(image, False, width)
        texels.name, texels.data[..., 3] = world.name, 1.0
        return texels


@contextmanager
def _temporary(collection, item):
    """Removes a data-block at the end, with do_unlink."""
    try:
        yield item
    finally:
        collection.remove(item)


@contextmanager
def _no_new_render_result():
    """Rendering adds the image "Render Result"; removes it again if the file had none."""
    before = {image.name_full for image in bpy.data.images}
    try:
        yield
    finally:
        for image in list(bpy.data.images):
            if image.type == "RENDER_RESULT" and image.name_full not in before:
                image.user_clear()  # its only user is the flag that keeps it in saved files
                bpy.data.images.remove(image)


def _hide_camera_branch(world):
    """Light that reaches surfaces is not what the camera sees: cuts 'Is Camera Ray' to 0."""
    tree = world.node_tree
    for node in tree.nodes:
        if node.bl_idname != "ShaderNodeLightPath":
            continue
        for name, value in (("Is Camera Ray", 0.0), ("Is Diffuse Ray", 1.0)):
            constant = tree.nodes.new("ShaderNodeValue")
            constant.outputs[0].default_value = value
            for link in list(node.outputs[name].links):
                tree.links.new(constant.outputs[0], link.to_socket)


def _panoramic(camera, viewer):
    """The image's centre looks along +X, as u = 0.5 of Blender's mapping does."""
    camera.type = "PANO"
    owner = camera if has(camera, "panorama_type") else camera.cycles
    owner.panorama_type = "EQUIRECTANGULAR"
    for name, value in (
        ("latitude_min", -math.pi / 2),
        ("latitude_max", math.pi / 2),
        ("longitude_min", -math.pi),
        ("longitude_max", math.pi),
    ):
        setattr(owner, name, value)
    viewer.rotation_euler = (math.pi / 2, 0.0, -math.pi / 2)


def _set_up(scene, width, path, frame):
    render = scene.render
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, width // 2, 100
    render.film_transparent = False
    render.use_file_extension, render.filepath = False, path
    render.use_compositing = render.use_sequencer = False
    settings = render.image_settings
    if has(settings, "media_type"):
        settings.media_type = "IMAGE"
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGB", "32"
    scene.frame_set(frame)
    cycles = scene.cycles
    for name, value in (
        ("samples", SKY_SAMPLES),
        ("use_denoising", False),
        ("use_adaptive_sampling", False),
        ("device", "CPU"),
        ("pixel_filter_type", "BOX"),
        ("filter_width", 1.0),
        ("film_exposure", 1.0),
        ("sample_clamp_direct", 0.0),
        ("max_bounces", 0),
    ):
        if has(cycles, name):
            setattr(cycles, name, value)
