# SPDX-License-Identifier: GPL-3.0-or-later
"""Preview materials: a copy of the artist's material whose closures are replaced by
emission(albedo / pi * irradiance + emission) seen by the camera, and a diffuse closure that takes
the direct light of the lamps left on (the primary ones)."""
import math

import bpy

from ..model import LIGHTMAP_UV as UV_LAYER
from .closures import ClosureReader
from .expression import is_constant
from .groups import expand_group

PLACEMENT = "ajar_placement"  # object custom property: uv scale x, y, offset x, y
GLOW = "ajar_glow"  # object custom property: strength of its light set, red, green, blue, 1


def preview_material(original, page, placed, warnings, glow=False):
    """The preview of a material on a page. page is None (no lightmap) or a PageLight; placed says
    that objects carry a scale and offset of their own, glow that they carry a strength of their
    emission. Made once per combination."""
    key = f"{page.index if page.image else 'mean'}{'i' if placed else ''}{'' if original else 'e'}{'g' if glow else ''}"
    for material in bpy.data.materials:
        mark = material.ajar
        if mark.is_preview and mark.source == original and mark.key == key:
            return material
    material = original.copy() if original else bpy.data.materials.new("Empty")
    material.name = f"AjarPreview.{original.name if original else 'Empty'}.{key}"
    material.ajar.is_preview = True
    material.ajar.source = original
    material.ajar.key = key
    material.use_fake_user = False
    if material.asset_data:
        material.asset_clear()
    if not material.use_nodes:
        _use_plain_color(material)
    _keep_out_of_light_sampling(material)
    _rewire(material, page, placed, warnings, glow)
    return material


def _use_plain_color(material):
    """A material without nodes is diffuse in its viewport colour, for the bake and for Cycles."""
    color = tuple(material.diffuse_color)
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    diffuse = nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = color
    output = nodes.new("ShaderNodeOutputMaterial")
    material.node_tree.links.new(diffuse.outputs[0], output.inputs["Surface"])


def _keep_out_of_light_sampling(material):
    """The glow of a preview must not be sampled as a lamp: it would be lit twice."""
    cycles = getattr(material, "cycles", None)
    if cycles and "emission_sampling" in cycles.bl_rna.properties:
        cycles.emission_sampling = "NONE"
    elif cycles and "sample_as_light" in cycles.bl_rna.properties:
        cycles.sample_as_light = False


def _rewire(material, page, placed, warnings, glow):
    tree = material.node_tree
    outputs = [node for node in tree.nodes if node.bl_idname == "ShaderNodeOutputMaterial"]
    if not outputs:
        outputs = [tree.nodes.new("ShaderNodeOutputMaterial")]
    irradiance = None
    for output in outputs:
        reader = ClosureReader(tree, expand_group)
        surface = reader.read(output.inputs["Surface"])
        irradiance = irradiance or _irradiance(reader.expression, page, placed)
        original = (
            output.inputs["Surface"].links[0].from_socket if output.inputs["Surface"].is_linked else None
        )
        if glow:
            surface.emission = reader.expression.multiply(surface.emission, _strength(reader.expression))
        if original is not None and _is_opaque(surface) and not glow:
            closure = _opaque_closure(reader.expression, surface, irradiance, original)
        else:
            closure = _lit_closure(reader.expression, surface, irradiance)
        tree.links.new(closure, output.inputs["Surface"])
        if reader.unknown:
            source = material.ajar.source
            warnings.append(
                (
                    source.name,
                    "the preview shows these nodes black: " + ", ".join(sorted(set(reader.unknown))),
                )
            )


def _irradiance(expression, page, placed):
    """Irradiance of a lightmapped surface from its page, or the constant of an unmapped one."""
    tree = expression.tree
    if page.image is None and page.mean_image is None:
        return tuple(page.mean)
    if page.image is None:
        return _image(expression, page.mean_image).outputs["Color"]
    coordinates = expression.node("ShaderNodeUVMap")
    coordinates.uv_map = UV_LAYER
    uv = coordinates.outputs["UV"]
    if placed:
        uv = _place(expression, uv)
    image = _image(expression, page.image)
    tree.links.new(uv, image.inputs["Vector"])
    return image.outputs["Color"]


def _image(expression, image):
    node = expression.node("ShaderNodeTexImage")
    node.image = image
    node.interpolation = "Linear"
    node.extension = "EXTEND"
    node.name = "Ajar Lightmap"
    return node


def _strength(expression):
    """Strength of the object's light set as a colour."""
    attribute = expression.node("ShaderNodeAttribute")
    attribute.attribute_type = "OBJECT"
    attribute.attribute_name = GLOW
    return attribute.outputs["Color"]


def _place(expression, uv):
    """uv * scale + offset, from the object's placement: colour is (sx, sy, ox), alpha is oy."""
    attribute = expression.node("ShaderNodeAttribute")
    attribute.attribute_type = "OBJECT"
    attribute.attribute_name = PLACEMENT
    split = expression.node("ShaderNodeSeparateXYZ")
    expression.tree.links.new(attribute.outputs["Vector"], split.inputs[0])
    offset = expression.node("ShaderNodeCombineXYZ")
    expression.tree.links.new(split.outputs[2], offset.inputs[0])
    expression.tree.links.new(attribute.outputs["Alpha"], offset.inputs[1])
    scaled = expression.multiply(uv, attribute.outputs["Vector"])
    return expression.add(scaled, offset.outputs[0])


def _is_opaque(surface):
    return is_constant(surface.transmittance) and not any(_channels(surface.transmittance))


def _opaque_closure(expression, surface, irradiance, original):
    """As _lit_closure, but the artist's own shader takes the direct light of primary lamps, so that
    highlights are right. It emits what it emits; nothing else is seen but by the camera."""
    tree = expression.tree
    glow = expression.node("ShaderNodeEmission")
    baked = expression.multiply(expression.multiply(surface.albedo, irradiance), 1.0 / math.pi)
    expression.feed(glow.inputs["Color"], baked)
    lit = _add_shader(expression, glow.outputs[0], original)
    mix = expression.node("ShaderNodeMixShader")
    tree.links.new(expression.node("ShaderNodeLightPath").outputs["Is Camera Ray"], mix.inputs[0])
    tree.links.new(lit, mix.inputs[2])
    return mix.outputs[0]


def _lit_closure(expression, surface, irradiance):
    """Shader socket of the preview. Rays other than the camera's see black, so that Blender adds
    no bounce of its own; what is clear stays clear for shadows."""
    tree = expression.tree
    camera = expression.node("ShaderNodeLightPath").outputs["Is Camera Ray"]
    baked = expression.multiply(expression.multiply(surface.albedo, irradiance), 1.0 / math.pi)
    glow = expression.node("ShaderNodeEmission")
    expression.feed(glow.inputs["Color"], expression.add(baked, surface.emission))
    expression.feed(glow.inputs["Strength"], camera)
    diffuse = expression.node("ShaderNodeBsdfDiffuse")
    expression.feed(diffuse.inputs["Color"], expression.multiply(surface.albedo, camera))
    if surface.normal is not None:
        tree.links.new(surface.normal, diffuse.inputs["Normal"])
    closure = _add_shader(expression, glow.outputs[0], diffuse.outputs[0])
    if _is_opaque(surface):
        return closure
    clear = expression.node("ShaderNodeBsdfTransparent")
    expression.feed(clear.inputs["Color"], surface.transmittance)
    return _add_shader(expression, closure, clear.outputs[0])


def _channels(value):
    return value if isinstance(value, tuple) else (value,)


def _add_shader(expression, a, b):
    node = expression.node("ShaderNodeAddShader")
    expression.tree.links.new(a, node.inputs[0])
    expression.tree.links.new(b, node.inputs[1])
    return node.outputs[0]
