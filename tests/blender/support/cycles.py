# SPDX-License-Identifier: GPL-3.0-or-later
"""Set Cycles up as an unbiased reference and bake irradiance with it."""
import math
import bpy
import numpy as np


def clear_file():
    """Start from a file without any data."""
    bpy.ops.wm.read_factory_settings(use_empty=True)


def setup(samples, bounces=0, seed=0, threads=0):
    """Fixed sample count, no clamp, no light threshold, no denoiser, no caustic tricks."""
    scene = bpy.context.scene
    scene.render.engine = 'CYCLES'
    scene.render.threads_mode = 'FIXED' if threads else 'AUTO'
    if threads:
        scene.render.threads = threads
    cycles = scene.cycles
    cycles.device = 'CPU'
    cycles.samples = samples
    cycles.seed = seed
    cycles.use_animated_seed = False
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.light_sampling_threshold = 0.0
    cycles.sample_clamp_direct = 0.0
    cycles.sample_clamp_indirect = 0.0
    cycles.blur_glossy = 0.0
    cycles.time_limit = 0.0
    cycles.max_bounces = bounces
    cycles.diffuse_bounces = bounces
    cycles.glossy_bounces = bounces
    cycles.transmission_bounces = bounces
    cycles.volume_bounces = 0
    cycles.transparent_max_bounces = 64
    cycles.min_light_bounces = bounces
    cycles.min_transparent_bounces = 64
    cycles.use_fast_gi = False


def float_image(name, width, height):
    """New black linear float image."""
    image = bpy.data.images.new(name, width, height, alpha=True, float_buffer=True, is_data=True)
    image.colorspace_settings.name = 'Non-Color'
    return image


def read_image(image):
    """(height, width, 4) float32 array, bottom row first."""
    pixels = np.empty(image.size[0] * image.size[1] * 4, np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(image.size[1], image.size[0], 4)


def diffuse_material(name, color=(0.8, 0.8, 0.8), target=None):
    """Plain diffuse material; `target` becomes its active (bake) image."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    output = tree.nodes.new('ShaderNodeOutputMaterial')
    bsdf = tree.nodes.new('ShaderNodeBsdfDiffuse')
    bsdf.inputs['Color'].default_value = (*color, 1.0)
    tree.links.new(bsdf.outputs[0], output.inputs['Surface'])
    if target is not None:
        set_bake_target(material, target)
    return material


def set_bake_target(material, image):
    """Add an image node and make it the one that baking writes to."""
    node = material.node_tree.nodes.new('ShaderNodeTexImage')
    node.image = image
    material.node_tree.nodes.active = node
    return node


def select_only(objects):
    """Select exactly `objects`; the first becomes active."""
    for obj in bpy.context.view_layer.objects:
        obj.select_set(False)
    for obj in objects:
        obj.select_set(True)
    bpy.context.view_layer.objects.active = objects[0]


def bake_irradiance(objects, passes=('DIRECT', 'INDIRECT'), layer="AjarLightmap"):
    """Bake into the active images. Cycles stores E / pi: callers multiply by pi."""
    select_only(objects)
    bpy.ops.object.bake(
        type='DIFFUSE',
        pass_filter=set(passes),
        margin=0,
        use_clear=True,
        target='IMAGE_TEXTURES',
        uv_layer=layer,
    )


def irradiance(image):
    """Irradiance in W/m^2 of a baked image."""
    return read_image(image)[..., :3].astype(np.float64) * math.pi
