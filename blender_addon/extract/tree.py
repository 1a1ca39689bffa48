# SPDX-License-Identifier: GPL-3.0-or-later
"""Walks node trees: links through reroutes, groups and muted nodes to where a value comes from."""

from dataclasses import dataclass

_LEGACY_SURFACES = {"ALL": 1, "CYCLES": 2}  # later is preferred


@dataclass(frozen=True)
class Source:
    """Where a socket's value comes from.

    scope  the group nodes entered, outermost first
    node   the node, or None: the default_value of socket applies
    socket output socket of node, or the unlinked input socket
    types  socket types passed on the way from the consumer, for implicit conversions
    """

    scope: tuple
    node: object
    socket: object
    types: tuple


def resolve(scope, socket):
    """Source of an input socket seen inside scope."""
    types = [socket.type]
    for _ in range(1000):  # more hops mean a cycle
        link = next((l for l in socket.links if l.is_valid and not l.is_muted), None)
        if link is None:
            return Source(scope, None, socket, tuple(types))
        node, output = link.from_node, link.from_socket
        step = _through(scope, node, output)
        if step is None:
            return Source(scope, node, output, tuple(types))
        scope, following = step
        if following is None:  # a muted node or empty group: as if nothing were linked
            return Source(scope, None, socket, tuple(types))
        socket = following
        types.append(socket.type)
    return Source(scope, None, socket, tuple(types))


def _through(scope, node, output):
    """(scope, input socket) behind a node that only passes values on; None for a real node."""
    if node.mute:
        passed = next((l.from_socket for l in node.internal_links if _same(l.to_socket, output)), None)
        return scope, passed
    if node.bl_idname == "NodeReroute":
        return scope, node.inputs[0]
    if node.bl_idname == "NodeGroupInput":
        if not scope:
            return scope, None
        return scope[:-1], by_identifier(scope[-1].inputs, output.identifier)
    if getattr(node, "node_tree", None) is not None and node.type == "GROUP":
        inner = group_output(node.node_tree)
        return scope + (node,), inner and by_identifier(inner.inputs, output.identifier)
    return None


def _same(a, b):
    return a.identifier == b.identifier and a.is_output == b.is_output


def by_identifier(sockets, identifier):
    """The socket with this identifier, or None."""
    return next((s for s in sockets if s.identifier == identifier), None)


def group_output(tree):
    """The active Group Output node of a group, or None."""
    nodes = [n for n in tree.nodes if n.bl_idname == "NodeGroupOutput"]
    return next((n for n in nodes if n.is_active_output), nodes[0] if nodes else None)


def active_output(tree, kind):
    """The output node (bl_idname kind) that Cycles renders, or None."""
    best, rank = None, 0
    for node in tree.nodes:
        if node.bl_idname != kind or node.mute:
            continue
        value = _LEGACY_SURFACES.get(getattr(node, "target", "ALL"), 0) * 2 + bool(node.is_active_output)
        if value > rank and getattr(node, "target", "ALL") in _LEGACY_SURFACES:
            best, rank = node, value
    return best


def find_input(node, *names):
    """The first enabled input socket with one of the names (they differ between versions)."""
    for name in names:
        for socket in node.inputs:
            if socket.name == name and socket.enabled:
                return socket
    return None
