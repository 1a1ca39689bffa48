# SPDX-License-Identifier: GPL-3.0-or-later
"""Node groups that output closures: a private copy of the group gets colour outputs instead."""
from .closures import ClosureReader, Surface

_CHANNELS = ("Albedo", "Emission", "Transmittance")


def expand_group(reader, node, source):
    """Surface of a group node's closure output; points the node at a tagged copy of its group."""
    tree = node.node_tree.copy()
    tree.name = "AjarPreview." + node.node_tree.name
    tree["ajar_preview"] = True
    output = _group_output(tree)
    index = next(i for i, socket in enumerate(node.outputs) if socket == source)
    inner = ClosureReader(tree, expand_group)
    surface = inner.read(output.inputs[index]) if output else Surface()
    reader.unknown += inner.unknown
    node.node_tree = tree
    values = (surface.albedo, surface.emission, surface.transmittance)
    names = [f"Ajar {channel} {index}" for channel in _CHANNELS]
    for name, value in zip(names, values):
        _new_output(tree, name)
        inner.expression.feed(output.inputs[name], value)
    albedo, emission, transmittance = (node.outputs[name] for name in names)
    return Surface(albedo, emission, transmittance)


def _group_output(tree):
    outputs = [node for node in tree.nodes if node.bl_idname == "NodeGroupOutput"]
    active = [node for node in outputs if node.is_active_output]
    return (active or outputs or [None])[0]


def _new_output(tree, name):
    if "interface" in tree.bl_rna.properties:
        tree.interface.new_socket(name=name, in_out="OUTPUT", socket_type="NodeSocketColor")
    else:
        tree.outputs.new("NodeSocketColor", name)
