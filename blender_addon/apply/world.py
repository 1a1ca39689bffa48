# SPDX-License-Identifier: GPL-3.0-or-later
"""A copy of the world that the camera sees but that lights nothing: its light is in the bake."""


def show_camera_only(scene):
    """Puts the camera-only copy in place of the scene's world and remembers the original."""
    original = scene.world
    if original is None or original.ajar.is_preview:
        return
    world = original.copy()
    world.name = "AjarPreview." + original.name
    world.ajar.is_preview = True
    scene.ajar.preview_world = original
    scene.world = world
    if not world.use_nodes:
        _use_plain_color(world)
    for output in [node for node in world.node_tree.nodes if node.bl_idname == "ShaderNodeOutputWorld"]:
        _hide_from_light(world.node_tree, output)
    cycles = getattr(world, "cycles", None)
    if cycles and "sampling_method" in cycles.bl_rna.properties:
        cycles.sampling_method = "NONE"


def restore(scene, remove):
    """Puts the artist's world back. remove(world) deletes the copy."""
    world = scene.world
    if world is not None and world.ajar.is_preview:
        scene.world = scene.ajar.preview_world
        remove(world)
    scene.ajar.preview_world = None


def _use_plain_color(world):
    color = tuple(world.color)
    world.use_nodes = True
    for node in world.node_tree.nodes:
        if node.bl_idname == "ShaderNodeBackground":
            node.inputs["Color"].default_value = (*color, 1.0)
            node.inputs["Strength"].default_value = 1.0


def _hide_from_light(tree, output):
    socket = output.inputs["Surface"]
    if not socket.is_linked:
        return
    source = socket.links[0].from_socket
    camera = tree.nodes.new("ShaderNodeLightPath").outputs["Is Camera Ray"]
    mix = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(camera, mix.inputs[0])
    tree.links.new(source, mix.inputs[2])
    tree.links.new(mix.outputs[0], socket)
