# SPDX-License-Identifier: GPL-3.0-or-later
"""Scene changes that the comparisons need: add-on set-up, plain materials, roles, switched-off light."""
import argparse
import importlib
import os
import sys

import bpy

REPOSITORY = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))


def parse_arguments(parser):
    """Arguments behind '--' of a script that Blender runs."""
    own = sys.argv[sys.argv.index('--') + 1 :] if '--' in sys.argv else []
    try:
        return parser.parse_args(own)
    except SystemExit as error:
        sys.stdout.flush()
        os._exit(error.code or 0)


def new_parser(text):
    """Parser without Blender's name in its usage."""
    return argparse.ArgumentParser(prog="script.py --", description=text)


def register_addon():
    """Register the add-on of this repository, unless it is there already."""
    if hasattr(bpy.types.Scene, "ajar"):
        return
    sys.path.insert(0, REPOSITORY)
    importlib.import_module("blender_addon").register()


def restore_original():
    """Turn the preview off, so that every material, lamp and world is the artist's own."""
    register_addon()
    if bpy.context.scene.ajar.preview:
        bpy.ops.ajar.preview_toggle()


def set_light_roles(role):
    """Give every lamp the same role."""
    register_addon()
    for obj in bpy.data.objects:
        if obj.type == 'LIGHT':
            obj.ajar.light_role = role


def lamps(roles=None):
    """Lamp objects of the scene, of the named roles only if given."""
    found = [obj for obj in bpy.context.scene.objects if obj.type == 'LIGHT']
    return [obj for obj in found if roles is None or obj.ajar.light_role in roles]


def used_materials():
    """Node materials of the file, each once."""
    return [material for material in bpy.data.materials if material.use_nodes and material.node_tree]


def find_output(tree):
    """The material output that Cycles uses, or None."""
    return tree.get_output_node('CYCLES')


def make_plain_diffuse(material):
    """Replace every Principled node by Diffuse of its base colour, keeping alpha and emission."""
    tree = material.node_tree
    for node in [n for n in tree.nodes if n.bl_idname == 'ShaderNodeBsdfPrincipled']:
        _replace_principled(tree, node)


def _replace_principled(tree, node):
    shader = tree.nodes.new('ShaderNodeBsdfDiffuse')
    _move_input(tree, node.inputs['Base Color'], shader.inputs['Color'])
    result = shader.outputs[0]
    if _is_used(node.inputs['Emission']) and _is_used(node.inputs['Emission Strength']):
        emission, add = tree.nodes.new('ShaderNodeEmission'), tree.nodes.new('ShaderNodeAddShader')
        _move_input(tree, node.inputs['Emission'], emission.inputs['Color'])
        _move_input(tree, node.inputs['Emission Strength'], emission.inputs['Strength'])
        tree.links.new(result, add.inputs[0])
        tree.links.new(emission.outputs[0], add.inputs[1])
        result = add.outputs[0]
    alpha = node.inputs['Alpha']
    if alpha.is_linked or alpha.default_value < 1.0:
        clear, mix = tree.nodes.new('ShaderNodeBsdfTransparent'), tree.nodes.new('ShaderNodeMixShader')
        _move_input(tree, alpha, mix.inputs['Fac'])
        tree.links.new(clear.outputs[0], mix.inputs[1])
        tree.links.new(result, mix.inputs[2])
        result = mix.outputs[0]
    for link in list(node.outputs[0].links):
        tree.links.new(result, link.to_socket)
    tree.nodes.remove(node)


def _is_used(socket):
    if socket.is_linked:
        return True
    value = socket.default_value
    return any(v > 0 for v in value[:3]) if hasattr(value, '__len__') else value > 0


def _move_input(tree, source, target):
    target.default_value = source.default_value
    if source.is_linked:
        tree.links.new(source.links[0].from_socket, target)


def switch_off_emission():
    """Set the emission of every material and the world to nothing."""
    for material in used_materials():
        for node in material.node_tree.nodes:
            if node.bl_idname == 'ShaderNodeEmission':
                _zero_input(material.node_tree, node.inputs['Strength'])
            elif node.bl_idname == 'ShaderNodeBsdfPrincipled':
                _zero_input(material.node_tree, node.inputs['Emission Strength'])
    bpy.context.scene.world = None


def _zero_input(tree, socket):
    for link in list(socket.links):
        tree.links.remove(link)
    socket.default_value = 0.0


def make_camera_white(material):
    """Shade first hits (and so bakes) as plain white diffuse and all later ones as before: a bake
    then sees the irradiance whatever the material's own colour, gloss or alpha."""
    tree = material.node_tree
    output = find_output(tree)
    if output is None:
        output = tree.nodes.new('ShaderNodeOutputMaterial')
    path, mix = tree.nodes.new('ShaderNodeLightPath'), tree.nodes.new('ShaderNodeMixShader')
    white = tree.nodes.new('ShaderNodeBsdfDiffuse')
    white.inputs['Color'].default_value = (1, 1, 1, 1)
    surface = output.inputs['Surface']
    if surface.is_linked:
        tree.links.new(surface.links[0].from_socket, mix.inputs[1])
    tree.links.new(path.outputs['Is Camera Ray'], mix.inputs['Fac'])
    tree.links.new(white.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], surface)
