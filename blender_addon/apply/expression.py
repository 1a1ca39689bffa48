# SPDX-License-Identifier: GPL-3.0-or-later
"""Colour arithmetic in a node tree, folded in Python where both sides are constant.

A value is a float, a 3-tuple, or an output socket. Only Math and Vector Math nodes are made: they
exist under these names in every supported Blender and clamp nothing.
"""

ZERO = (0.0, 0.0, 0.0)
ONE = (1.0, 1.0, 1.0)
_PLAIN = {
    "MULTIPLY": lambda a, b: a * b,
    "ADD": lambda a, b: a + b,
    "SUBTRACT": lambda a, b: a - b,
    "DIVIDE": lambda a, b: a / b if b else 0.0,
    "MINIMUM": min,
    "MAXIMUM": max,
}


def is_constant(value):
    """True for a float or a 3-tuple, False for a socket."""
    return isinstance(value, (float, int, tuple))


def as_color(value):
    """A constant as a 3-tuple."""
    return value if isinstance(value, tuple) else (float(value),) * 3


class Expression:
    """Builds value nodes in one node tree."""

    def __init__(self, tree):
        self.tree = tree
        self._count = 0

    def node(self, kind):
        """A new node, placed in a grid left of the output so that the tree can be read."""
        node = self.tree.nodes.new(kind)
        node.location = (400 + 180 * (self._count % 8), -600 - 160 * (self._count // 8))
        node.hide = True
        node["ajar"] = True
        self._count += 1
        return node

    def feed(self, socket, value):
        """Links or sets an input socket."""
        if not is_constant(value):
            self.tree.links.new(value, socket)
        elif socket.type == "VALUE":
            socket.default_value = value[0] if isinstance(value, tuple) else float(value)
        elif socket.type == "RGBA":
            socket.default_value = (*as_color(value), 1.0)
        else:
            socket.default_value = as_color(value)

    def _apply(self, operation, a, b):
        if is_constant(a) and is_constant(b):
            plain = _PLAIN[operation]
            if isinstance(a, tuple) or isinstance(b, tuple):
                return tuple(plain(x, y) for x, y in zip(as_color(a), as_color(b)))
            return plain(a, b)
        node = self.node("ShaderNodeVectorMath")
        node.operation = operation
        self.feed(node.inputs[0], a)
        self.feed(node.inputs[1], b)
        return node.outputs[0]

    def multiply(self, a, b):
        """a * b, channel by channel."""
        for x, y in ((a, b), (b, a)):
            if is_constant(x) and as_color(x) == ZERO:
                return ZERO
            if is_constant(x) and as_color(x) == ONE:
                return y
        return self._apply("MULTIPLY", a, b)

    def add(self, a, b):
        """a + b, channel by channel."""
        for x, y in ((a, b), (b, a)):
            if is_constant(x) and as_color(x) == ZERO:
                return y
        return self._apply("ADD", a, b)

    def one_minus(self, a):
        """1 - a, channel by channel."""
        return self._apply("SUBTRACT", ONE if isinstance(a, tuple) or not is_constant(a) else 1.0, a)

    def divide(self, a, b):
        """a / b, channel by channel; 0 where b is 0."""
        return self._apply("DIVIDE", a, b)

    def minimum(self, a, b):
        """The smaller of a and b, channel by channel."""
        return self._apply("MINIMUM", a, b)

    def mix(self, factor, a, b):
        """a * (1 - factor) + b * factor."""
        if is_constant(factor):
            return self.add(self.multiply(a, self.one_minus(factor)), self.multiply(b, factor))
        if is_constant(a) and is_constant(b) and as_color(a) == as_color(b):
            return a
        return self.add(self.multiply(a, self.one_minus(factor)), self.multiply(b, factor))

    def polynomial(self, coefficients, x):
        """Horner's rule, highest power first."""
        value = coefficients[0]
        for coefficient in coefficients[1:]:
            value = self.add(self.multiply(value, x), coefficient)
        return value

    def scalar(self, value):
        """A colour socket reduced to one number the way Blender does it (luminance)."""
        if is_constant(value) or value.type == "VALUE":
            return value
        node = self.node("ShaderNodeMath")
        node.operation = "ADD"
        node.inputs[1].default_value = 0.0
        self.tree.links.new(value, node.inputs[0])
        return node.outputs[0]

    def gray(self, value):
        """Average of the channels of a value, as a number."""
        if is_constant(value):
            return sum(as_color(value)) / 3.0
        node = self.node("ShaderNodeVectorMath")
        node.operation = "DOT_PRODUCT"
        self.feed(node.inputs[0], value)
        node.inputs[1].default_value = (1 / 3, 1 / 3, 1 / 3)
        return node.outputs["Value"]
